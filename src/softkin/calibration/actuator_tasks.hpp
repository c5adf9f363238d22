#pragma once

#include <optional>
#include <softkin/calibration/curve_report.hpp>
#include <softkin/model/measurements.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

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
  std::optional<double> permittivity, thickness_mm, shear_modulus_MPa, prestretch, stretch_limit, breakdown_kV_mm;
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
