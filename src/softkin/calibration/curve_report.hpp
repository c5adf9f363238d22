#pragma once

#include <softkin/calibration/curve_fit.hpp>
#include <softkin/calibration/dielectric.hpp>
#include <softkin/calibration/pressure_check.hpp>
#include <softkin/calibration/syringe.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// A curve with what it was fitted to. samples and quality are empty for a computed curve.
struct FittedCurve {
  ActuatorCurve curve;
  BranchQuality loading{}, unloading{};
  std::vector<CurveSample> samples{};
};

/// fit_curve's branches as an actuator's curve. name: its file, for messages. Throws as fit_curve does.
[[nodiscard]] FittedCurve fitted_curve(const std::string& name, CurveInput input, double atmosphere_kPa,
                                       std::vector<CurveSample> samples);

/// "loading: 3 sweeps, 120 rows, 15 points, ...", a line for each branch.
[[nodiscard]] std::string quality_text(const FittedCurve& fitted);

/// Ratios of both branches at even inputs, with their spread, and the width of the hysteresis.
[[nodiscard]] Table ratio_table(const ActuatorCurve& curve);
/// Inputs of both branches at even ratios.
[[nodiscard]] Table input_table(const ActuatorCurve& curve);
/// Both as text.
[[nodiscard]] std::string curve_text(const ActuatorCurve& curve);

/// Samples and both branches.
[[nodiscard]] Plot curve_plot(const FittedCurve& fitted, const std::string& title);

/// The rows of syringe tests after Eq. (19).
[[nodiscard]] Table syringe_table(const SyringeSetup& setup, const std::vector<SyringeSample>& samples);

/// What is told of a comparison: pressures, misfits, what to write into the scene. spec: of the scene compared with.
[[nodiscard]] std::string comparison_text(const PressureComparison& comparison, const ActuatorCurve& curve,
                                          const RobotSpec& spec);

/// The results as JSON. tests: their files. comparison, computed: none where null
[[nodiscard]] std::string pressure_json(const std::vector<std::string>& tests, const SyringeSetup& setup,
                                        const FittedCurve& fitted, const PressureComparison* comparison);
[[nodiscard]] std::string dea_json(const std::vector<std::string>& tests, const FittedCurve& fitted,
                                   const DielectricCurve* computed);

}  // namespace softkin::calibration
