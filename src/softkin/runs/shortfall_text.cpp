#include <algorithm>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/shortfall_text.hpp>

namespace softkin::runs {

std::string reached_text(const Model& model, const StepRecord& step) {
  std::string text;
  for (const auto& [a, reached, requested] : shortfalls(model, step)) {
    const Actuator& actuator = model.actuators[a];
    text += (text.empty() ? "" : ", ") + actuator.name + " reached " + command_text(actuator, reached) + " of " +
            command_text(actuator, requested);
  }
  if (!text.empty()) return text;
  return decimal(100 * step.reached_fraction.value_or(0), 1) + " % of the loads and displacements were reached";
}

namespace {

std::string ends_text(const Model& model, const InverseResult& found) {
  std::string text;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    if (found.active[a] == 0) continue;
    const Actuator& actuator = model.actuators[a];
    const bool low = found.active[a] < 0;
    text += "; " + actuator.name + " is at the " + (low ? "low" : "high") + " end of its range, " +
            number(low ? actuator.low : actuator.high) + " " + bracketed_unit(actuator);
  }
  return text;
}

}  // namespace

double own_error(const Goal& goal, double error_mm) {
  const auto* force = std::get_if<ForceGoal>(&goal.what);
  return force != nullptr ? error_mm / force->mm_per_N : error_mm;
}

Misses misses_of(const std::vector<Goal>& goals, const InverseResult& found) {
  Misses misses;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    std::optional<double>& most = std::holds_alternative<ForceGoal>(goals[i].what) ? misses.N : misses.mm;
    most = std::max(most.value_or(0), own_error(goals[i], found.errors_mm[i]));
  }
  return misses;
}

std::string misses_text(const Misses& misses, int digits) {
  std::string text;
  if (misses.mm) text += number(*misses.mm, digits) + " mm";
  if (misses.N) text += (text.empty() ? "" : " and ") + number(*misses.N, digits) + " N";
  return text;
}

std::string shortfall_text(const Model& model, const std::vector<Goal>& goals, const InverseResult& found) {
  const std::string off = misses_text(misses_of(goals, found), 4) + " off";
  if (found.status == InverseStatus::unreachable)
    return "not reached: " + off + " at the nearest point; " + found.remark + ends_text(model, found);
  if (found.status == InverseStatus::interrupted) return "interrupted: the best so far is " + off;
  return "not converged: " + found.remark + "; the best is " + off + ends_text(model, found);
}

namespace {

/// Where a shape at a limit is deformed most, and what is there.
std::string worst_text(const WorstPlace& worst) {
  const bool crushed = worst.volume_ratio < 0.2, by_cable = worst.beside.find("cable") != std::string::npos;
  return ". Deformed most is " + std::string(worst.prism ? "prism " : "tetrahedron ") + std::to_string(worst.element) +
         " (from 0)" + (worst.region.empty() ? "" : " of region '" + worst.region + "'") + " at " +
         softkin::point_text(worst.at, 4, 1e-6) + " mm" + (worst.beside.empty() ? "" : ", next to " + worst.beside) +
         ": strain " + decimal(100 * worst.strain, 1) + " %" + ", " + decimal(100 * worst.volume_ratio, 1) + " %" +
         " of its volume" +
         (!crushed   ? ""
          : by_cable ? "; spread the cable's force over a rigid region there"
                     : "; make the mesh finer there");
}

}  // namespace

std::string shortfall_text(const Model& model, const StepRecord& step) {
  if (step.answered()) return step.remark + "; the shape is the last one";
  if (model.formulation == Formulation::physical && step.reached_fraction == 1)
    return step.remark + "; the shape is the last one";
  if (model.formulation == Formulation::physical)
    return reached_text(model, step) + ": " + step.remark + "; the shape is the last good one" +
           (step.worst ? worst_text(*step.worst) : "");
  return (step.remark.empty() ? "" : step.remark + ", and ") + "the shape is that after " +
         counted(static_cast<std::size_t>(step.iterations), "iteration") + ", not an equilibrium";
}

}  // namespace softkin::runs
