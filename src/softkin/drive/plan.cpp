#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/drive/plan.hpp>

namespace softkin::drive {

Plan make_plan(const Model& model, const HardwareSpec& hardware, Commands commands, bool return_home) {
  Plan plan;
  plan.commands = std::move(commands);
  plan.machine = assemble(model, hardware, plan.commands);
  plan.schedule = plan_pressures(plan.machine, plan.commands);
  if (plan.machine.tendons.empty()) return plan;
  plan.motion = plan_motion(plan.machine, plan.commands, return_home);
  plan.program = make_gcode(plan.machine, plan.motion);
  return plan;
}

TendonUse use_of(const Plan& plan, std::size_t index) {
  const Tendon& tendon = plan.machine.tendons[index];
  TendonUse use;
  use.shortest_mm = tendon.longest_mm;
  for (const CommandRow& row : plan.commands.rows) {
    const double length = row.actuation[tendon.actuator] * tendon.rest_length_mm;
    use.shortest_mm = std::min(use.shortest_mm, length);
    use.longest_mm = std::max(use.longest_mm, length);
  }
  const auto cable_mm = [&](std::int64_t steps) {
    return static_cast<double>(std::abs(steps)) / (tendon.steps_per_mm * tendon.axis_mm_per_cable_mm);
  };
  std::int64_t here = 0;
  for (const auto* moves : {&plan.motion.approach, &plan.motion.moves, &plan.motion.back})
    for (const Move& move : *moves) {
      use.fastest_mm_per_s = std::max(use.fastest_mm_per_s, cable_mm(move.target[index] - here) / move.seconds);
      here = move.target[index];
      use.lowest = std::min(use.lowest, here);
      use.highest = std::max(use.highest, here);
    }
  if (tendon.drum_radius_mm)
    use.turns = cable_mm(std::max(std::abs(use.lowest), std::abs(use.highest))) /
                (2 * std::numbers::pi * *tendon.drum_radius_mm);
  return use;
}

std::pair<double, double> pressure_range(const Plan& plan, std::size_t chamber) {
  const auto [low, high] =
      std::minmax_element(plan.schedule.rows.begin(), plan.schedule.rows.end(),
                          [chamber](const auto& a, const auto& b) { return a.kpa[chamber] < b.kpa[chamber]; });
  return {low->kpa[chamber], high->kpa[chamber]};
}

double seconds_of(const std::vector<Move>& moves) {
  double seconds = 0;
  for (const Move& move : moves) seconds += move.seconds;
  return seconds;
}

}  // namespace softkin::drive
