#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/shortfall_text.hpp>

namespace softkin::runs {

std::string reached_text(const Model& model, const StepRecord& step) {
  std::string text;
  for (const auto& [a, reached, asked] : shortfalls(model, step)) {
    const Actuator& actuator = model.actuators[static_cast<std::size_t>(a)];
    text += (text.empty() ? "" : ", ") + actuator.name + " reached " + command_text(actuator, reached) + " of " +
            command_text(actuator, asked);
  }
  if (!text.empty()) return text;
  return decimal(100 * step.reached_share.value_or(0), 1) + " % of the loads and displacements were reached";
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

std::string shortfall_text(const Model& model, const InverseResult& found) {
  const std::string off = number(found.errors_mm.maxCoeff(), 4) + " mm off";
  if (found.status == InverseStatus::unreachable)
    return "not reached: " + off + " at the nearest point; " + found.remark + ends_text(model, found);
  if (found.status == InverseStatus::interrupted) return "interrupted: the best so far is " + off;
  return "not converged: " + found.remark + "; the best is " + off + ends_text(model, found);
}

}  // namespace softkin::runs
