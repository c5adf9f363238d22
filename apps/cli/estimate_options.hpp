#pragma once

#include <softkin/kinematics/estimator.hpp>

#include "solve_options.hpp"

namespace softkin::cli {

/// The unknowns to estimate and the accuracy of the readings: options of every command that estimates.
struct EstimateOptions {
  std::vector<std::string> unknowns;
  std::array<std::optional<double>, readings> deviations{};  // in the order of Reading
  double fade_s = 0;
  bool keep_all = false;

  /// throws  InvalidInput naming the option
  [[nodiscard]] std::vector<EstimatedUnknown> requested_unknowns() const;
  /// 0: not given
  [[nodiscard]] std::array<double, readings> requested_deviations() const;
  [[nodiscard]] EstimatorOptions how(const StaticsOptions& statics) const;
};

/// The options that give deviations, in the order of Reading.
[[nodiscard]] std::array<std::string, readings> deviation_names();

CLI::Option* add_unknowns(CLI::App& command, EstimateOptions& options);
/// unsaid: what they are where they are not given, of commands that do without
void add_deviations(CLI::App& command, std::array<std::optional<double>, readings>& deviations,
                    const std::string& unsaid = "");
/// --fade and --keep-all. then: what readings do where it is given
void add_fade(CLI::App& command, EstimateOptions& options, const std::string& then);

}  // namespace softkin::cli
