#pragma once

#include <set>
#include <softkin/calibration/ratio_fit.hpp>
#include <string>
#include <vector>

#include <softkin/io/output_files.hpp>

namespace softkin::cli {

/// What `softkin calibrate material` was asked for.
struct MaterialOptions {
  std::string specimens, twist, tensile;  // inputs
  std::string fragment, plot, residuals;  // outputs
  std::string formulation;                // empty: both
  std::string law;                        // empty: neo-hookean, or with --tensile the one that fits
  std::string grip = "clamped";
  std::vector<std::string> regions{"A", "B"};
  std::string region = "body";  // tensile
  calibration::SpecimenOptions specimen;
  std::optional<double> modulus_b;  // [MPa]
  std::vector<double> tried;        // R_omega A / R_omega B to look at beside the one found
  double tolerance_percent = 5;     // of the linear range
  double most_strain = 0;           // that laws are fitted to; 0: all
  bool json = false;
  std::set<std::string> given;  // options that the user gave

  [[nodiscard]] std::vector<Output> outputs() const;
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const;
  /// " (default)" where the option was not given.
  [[nodiscard]] std::string unless_given(const std::string& option) const;
};

/// Two-material specimens: E_A / E_B and R_omega. Returns the exit code.
int calibrate_specimens(const MaterialOptions& options);

/// The tensile test of one material: E, linear range, laws. Returns the exit code.
int calibrate_tensile(const MaterialOptions& options);

}  // namespace softkin::cli
