#pragma once

#include <softkin/runs/findings.hpp>
#include <string>

namespace softkin::runs {

/// What is told of a finding, a line.
[[nodiscard]] std::string finding_text(const Model& model, const Finding& finding);

/// "0.31 mm at (1.20, 0.00, 3.00) mm" of the deepest point of an overlap.
[[nodiscard]] std::string depth_text(double deepest_mm, const Vec3& where);

/// Why parts of the robot can be in each other.
[[nodiscard]] std::string overlap_cause(const Model& model);

/// The records of a run whose shapes pass through themselves.
class OverlapTally {
 public:
  explicit OverlapTally(const Model& model) : model_(model) {}

  void add(std::size_t number, const StepRecord& record);

  /// "warning: the shape passes through itself in steps 3 to 5, the deepest ..."; "" where none does. what: "step"
  [[nodiscard]] std::string text(const std::string& what) const;

 private:
  const Model& model_;
  std::vector<std::size_t> numbers_;
  SelfOverlap deepest_;
  std::size_t at_ = 0;
};

}  // namespace softkin::runs
