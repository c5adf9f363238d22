#pragma once

#include <softkin/runs/findings.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// Returns the text of a finding, a line.
[[nodiscard]] std::string finding_text(const Model& model, const Finding& finding);

/// A finding as it is shown to a user.
struct FindingLine {
  std::size_t kind = 0;     // index of the alternative of Finding: lines of one kind differ in numbers and names alone
  bool is_warning = false;  // is it probably not what the user wants
  std::string text;         // one line; of a warning it begins with "warning: "
};

/// All findings of a record in their order.
///
/// stable  what a user adds to find the shape that an unstable equilibrium goes to: "--stable"
[[nodiscard]] std::vector<FindingLine> finding_lines(const Model& model, const StepRecord& record,
                                                     const std::string& stable);

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
