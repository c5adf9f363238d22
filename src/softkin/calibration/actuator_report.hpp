#pragma once

#include <optional>
#include <softkin/calibration/actuator_curves.hpp>
#include <softkin/calibration/actuator_samples.hpp>
#include <softkin/calibration/dielectric_elastomer.hpp>
#include <softkin/calibration/pressure_check.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/model/measurements.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// A curve with what it was fitted to. samples and quality are empty for a computed curve.
struct FittedCurve {
  ActuatorCurve curve;
  BranchQuality loading{}, unloading{};
  std::vector<CurveSample> samples{};
};

/// "loading: 3 sweeps, 120 rows, 15 points, ...", a line for each branch.
[[nodiscard]] std::string quality_text(const FittedCurve& fitted);

[[nodiscard]] std::string curve_text(const ActuatorCurve& curve);

/// Samples and both branches.
[[nodiscard]] Plot curve_plot(const FittedCurve& fitted, const std::string& title);

/// The rows of syringe tests after Eq. (19).
[[nodiscard]] Table syringe_table(const SyringeSetup& setup, const std::vector<SyringeSample>& samples);

/// Returns the report of a comparison: pressures, misfits, changes of the scene. spec: of the scene compared with.
[[nodiscard]] std::string comparison_text(const PressureComparison& comparison, const ActuatorCurve& curve,
                                          const RobotSpec& spec);

/// The results as JSON. tests: their files. comparison, computed: none where null
[[nodiscard]] std::string pressure_json(const std::vector<std::string>& tests, const SyringeSetup& setup,
                                        const FittedCurve& fitted, const PressureComparison* comparison);
[[nodiscard]] std::string dea_json(const std::vector<std::string>& tests, const FittedCurve& fitted,
                                   const DielectricCurve* computed);

/// Syringe tests of a chamber.
struct SyringeTask {
  std::vector<std::string> tests;      // CSV
  std::optional<PressureScale> scale;  // of a column p_kpa
  SyringeSetup setup;
};

struct SyringeResults {
  FittedCurve fitted;
  std::string head;  // what was read, in words
  std::vector<SyringeSample> samples;
};

/// Reads the tests and fits their curve. name: of the curve's file, for messages.
/// throws  InvalidInput as read_syringe_runs, chamber_ratios and fit_curve do
[[nodiscard]] SyringeResults evaluate(const SyringeTask& task, const std::string& name);

/// A dielectric elastomer: its tests, or what it is made of.
struct DeaTask {
  std::vector<std::string> tests;  // CSV
  std::string law;                 // in place of tests: "neo-hookean" or "gent"
  std::string loading;             // "uniaxial", "constrained", or that of the default, "equal-biaxial"
  std::optional<double> permittivity, thickness_mm, shear_modulus_MPa, prestretch, prestretch_across, stretch_limit,
      breakdown_kV_mm;
};

struct DeaResults {
  FittedCurve fitted;
  std::string head;                           // what was read or computed, in words
  std::optional<DielectricCurve> computed{};  // none: measured
};

/// Reads the tests and fits their curve, or computes it.
/// throws  InvalidInput naming the option that is missing, and as read_voltage_runs, fit_curve and dielectric_curve do
[[nodiscard]] DeaResults evaluate(const DeaTask& task, const std::string& name);

}  // namespace softkin::calibration
