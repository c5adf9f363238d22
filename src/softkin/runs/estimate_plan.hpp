#pragma once

#include <softkin/kinematics/reading_plan.hpp>
#include <softkin/runs/estimate_report.hpp>

namespace softkin::runs {

/// Where a marker may be stuck on: vertices of the surface that are not inside a chamber, ascending.
[[nodiscard]] std::vector<Index> marker_vertices(const Model& model);

/// Plans the further readings that would improve the estimates of a table's rows most. Rows are added one by one.
class EstimatePlanner {
 public:
  /// poses must outlive the object. deviations: of each kind of reading; 0: none of the kind is looked at
  EstimatePlanner(const Model& model, const MeasuredPoses& poses, const std::array<double, readings>& deviations,
                  int count);
  /// Adds a row; one that is not converged does not count.
  void add(const Estimate& reported);
  /// Returns at most the requested number; fewer or none where no reading would improve anything, or no row converged.
  [[nodiscard]] std::vector<PlannedReading> plan() const;

 private:
  const Model& model_;
  PlanOptions options_;
  std::vector<PlanBasis> rows_;
};

/// Each reading with the deviations that would remain, next to the present ones.
[[nodiscard]] std::string plan_text(const EstimateReport& report);

}  // namespace softkin::runs
