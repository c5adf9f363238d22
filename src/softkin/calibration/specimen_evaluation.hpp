#pragma once

#include <array>
#include <functional>
#include <optional>
#include <softkin/calibration/ratio_fit.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// The options of an evaluation of specimens of two materials.
struct SpecimenTask {
  std::string file, twist_file;     // of the specimens, for messages
  std::vector<std::string> set_up;  // assumptions of the simulations, a line each, for the report
  SpecimenOptions options;
  bool physical = true, target_shape = true;     // formulations to fit
  std::vector<double> tried;                     // target-shape: R_omega A / R_omega B to simulate besides the fit
  std::optional<double> modulus_b;               // [MPa], where no force was measured
  std::array<std::string, 2> regions{"A", "B"};  // of the scene
};

/// What the simulations take as given, for set_up. remark: on the option of that name of `softkin calibrate material`,
/// such as " (default)"
[[nodiscard]] std::vector<std::string> set_up_lines(
    const SpecimenTask& task, const std::function<std::string(const std::string& option)>& remark);

/// The tests simulated with one formulation, at the ratio that fits best or at one given.
struct SimulatedTests {
  std::string name;             // "physical", "target-shape", "R_A / R_B 2"
  std::optional<RatioFit> fit;  // none: the ratio was given
  double ratio = 1;
  std::vector<SpecimenResponse> stretched, twisted;  // twisted: empty where no ratio fits

  [[nodiscard]] bool is(Formulation formulation) const { return fit && fit->formulation == formulation; }
};

struct SpecimenResults {
  std::vector<StretchedSpecimen> specimens;
  std::vector<TwistedSpecimen> twists;
  RatioEstimate rod;  // Eq. (16)
  std::optional<Moduli> rod_moduli;
  std::vector<SimulatedTests> simulated;  // physical, target-shape, then the ratios to look at
  bool interrupted = false;               // in the last simulation; then no other result may be read

  /// Returns the fit of a formulation; null where it was not requested.
  [[nodiscard]] const RatioFit* fit(Formulation formulation) const;
};

/// throws  InvalidInput where a modulus is given in addition to measured forces
void check_modulus_b(const SpecimenTask& task, const std::vector<StretchedSpecimen>& specimens);
/// What is probably not meant: areas of the file that are not the simulated one; empty: nothing.
[[nodiscard]] std::string doubt_about_areas(const SpecimenTask& task, const std::vector<StretchedSpecimen>& specimens);

/// Returns one line with all inputs of the tests of a task, for TestLog.
[[nodiscard]] std::string tests_set_up(const SpecimenTask& task, const std::vector<StretchedSpecimen>& specimens,
                                       const std::vector<TwistedSpecimen>& twists);
/// How many tests TestLog keeps of a task that is done, if all of them converge.
[[nodiscard]] std::size_t number_of_tests(const SpecimenTask& task, std::size_t specimens, std::size_t twists);

/// Fits the ratios by simulated tests. progress: receives the current simulation, and its completed fraction.
/// throws  InvalidInput as fit_ratio does
[[nodiscard]] SpecimenResults evaluate(const SpecimenTask& task, std::vector<StretchedSpecimen> specimens,
                                       std::vector<TwistedSpecimen> twists,
                                       const std::function<void(const std::string&, double)>& progress = {});

/// The first simulation that is not converged, in words; empty: all are.
[[nodiscard]] std::string failure(const SpecimenTask& task, const SpecimenResults& results);

}  // namespace softkin::calibration
