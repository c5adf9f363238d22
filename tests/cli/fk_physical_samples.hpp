#pragma once

#include <nlohmann/json.hpp>

#include "fk_samples.hpp"

namespace softkin::testing {

/// What fk --json prints of the folder's scene.
inline nlohmann::json report_of(const BlockFolder& folder, std::vector<std::string> options) {
  options.emplace_back("--json");
  const ProgramResult result = run_fk(folder.scene, options);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return nlohmann::json::parse(result.output);
}

inline nlohmann::json step_of(const BlockFolder& folder, const std::vector<std::string>& options) {
  return report_of(folder, options)["steps"][0];
}

/// Without the time that it took.
inline nlohmann::json timeless(nlohmann::json step) {
  step.erase("seconds");
  return step;
}

inline void expect_same_markers(const nlohmann::json& a, const nlohmann::json& b, double tolerance) {
  ASSERT_EQ(a["markers"].size(), b["markers"].size());
  for (const auto& [name, point] : a["markers"].items())
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(point[axis].get<double>(), b["markers"][name][axis].get<double>(), tolerance) << name;
}

inline std::string text(double value) {
  return nlohmann::json(value).dump();
}

}  // namespace softkin::testing
