#pragma once

#include <softkin/io/table/table.hpp>
#include <softkin/runs/reports.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// Tables of an answer: a line for each actuator, one for each goal of markers, and one for each requested force; no
/// rows where there is none.
struct InverseTables {
  Table actuators, goals, forces;
};
[[nodiscard]] InverseTables inverse_tables(const Model& model, const std::vector<NamedGoal>& goals,
                                           const InverseResult& found, const StepRecord& step);

/// "error at most 3.2e-05 mm; 5 iterations, 6 equilibria, 0.21 s".
[[nodiscard]] std::string inverse_summary(const InverseResult& found, const Misses& misses);

}  // namespace softkin::runs
