#pragma once

#include <softkin/kinematics/walk.hpp>
#include <string>
#include <vector>

#include "columns.hpp"
#include "fk_report.hpp"
#include "fk_steps.hpp"

namespace softkin::cli {

/// A row of the gait, on its way.
struct GaitStep {
  Step asked;             // its time goes on from cycle to cycle
  std::size_t cycle = 0;  // from 1; 0: where the robot is put down
};

/// The gait so many times. Throws InvalidInput, naming file and line, where its last row is not its first one again.
[[nodiscard]] std::vector<GaitStep> repeated(const Model& model, const std::string& file, const std::vector<Step>& gait,
                                             std::size_t cycles);

/// A step that is done, without its shape.
struct WalkedStep {
  GaitStep gait;
  WalkStep walk;  // without positions
};

/// The marker that shows where it is. foot: 0 the rear one, 1 the front one.
[[nodiscard]] const std::string& foot_name(const Model& model, std::size_t foot);

/// "foot1", "foot1 and foot2" or "-".
[[nodiscard]] std::string sliding_text(const Model& model, Sliding sliding);

/// Of the equilibrium, and below "walk" where the feet are.
[[nodiscard]] Report::Json walk_json(const Model& model, const GaitStep& gait, const WalkStep& walk,
                                     const ElementDeformation& deformation);

/// The feet of walk_json. Throws Report::Json::exception where the step is not one of it.
[[nodiscard]] WalkStep walked(const Model& model, const Report::Json& step);

[[nodiscard]] std::string walk_csv(const Model& model, const std::vector<WalkedStep>& steps);

/// The travel in each finished cycle [mm].
[[nodiscard]] std::vector<double> strides(const std::vector<WalkedStep>& steps, std::size_t cycles);

/// The steps on the terminal, a row each as they come.
class WalkTable {
 public:
  explicit WalkTable(const Model& model);

  [[nodiscard]] std::string header() const { return columns_.header() + "slides"; }
  [[nodiscard]] std::string row(const WalkedStep& step) const;

 private:
  const Model& model_;
  Columns columns_;
};

/// "stride: 5.12 mm in cycle 1, 5.03 mm in cycle 2 and each one after it; ...".
[[nodiscard]] std::string stride_text(const std::vector<double>& strides);

}  // namespace softkin::cli
