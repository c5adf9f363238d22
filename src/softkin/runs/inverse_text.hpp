#pragma once

#include <softkin/io/table/table.hpp>
#include <softkin/runs/reports.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// Of an answer: a line for each actuator, and one for each goal.
struct InverseTables {
  Table actuators, goals;
};
[[nodiscard]] InverseTables inverse_tables(const Model& model, const std::vector<NamedGoal>& goals,
                                           const InverseResult& found, const StepRecord& step);

/// "error at most 3.2e-05 mm; 5 iterations, 6 equilibria, 0.21 s".
[[nodiscard]] std::string inverse_summary(const InverseResult& found);

}  // namespace softkin::runs
