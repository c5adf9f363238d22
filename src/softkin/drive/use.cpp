#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/drive/use.hpp>
#include <tuple>

namespace softkin::drive {

namespace {

/// Adds the motion of a motor over the whole program; mm_per_turn: of the driven part.
void add_motion(const Plan& plan, std::size_t index, const Motor& motor, const std::optional<double>& mm_per_turn,
                MotorUse& use) {
  std::int64_t here = 0;
  for (const auto* moves : {&plan.motion.approach, &plan.motion.moves, &plan.motion.back})
    for (const Move& move : *moves) {
      const double path = std::abs(motor.mm(static_cast<double>(move.target[index] - here)));
      use.fastest_mm_per_s = std::max(use.fastest_mm_per_s, path / move.seconds);
      here = move.target[index];
      use.lowest = std::min(use.lowest, here);
      use.highest = std::max(use.highest, here);
    }
  const auto farthest = static_cast<double>(std::max(std::abs(use.lowest), std::abs(use.highest)));
  if (mm_per_turn) use.turns = std::abs(motor.mm(farthest)) / *mm_per_turn;
}

/// Steps of a motor after each row: of the last move that is not of a later one.
std::vector<std::int64_t> steps_after_rows(const Plan& plan, std::size_t motor) {
  std::vector<std::int64_t> steps;
  std::int64_t here = plan.motion.approach.empty() ? 0 : plan.motion.approach.back().target[motor];
  std::size_t next = 0;
  for (const CommandRow& row : plan.commands.rows) {
    for (; next < plan.motion.moves.size() && plan.motion.moves[next].line <= row.line; ++next)
      here = plan.motion.moves[next].target[motor];
    steps.push_back(here);
  }
  return steps;
}

}  // namespace

TendonUse use_of(const Plan& plan, std::size_t index) {
  const Tendon& tendon = plan.machine.tendons[index];
  TendonUse use;
  use.shortest_mm = tendon.longest_mm;
  for (const CommandRow& row : plan.commands.rows) {
    const double length = row.actuation[tendon.actuator] * tendon.rest_length_mm;
    use.shortest_mm = std::min(use.shortest_mm, length);
    use.longest_mm = std::max(use.longest_mm, length);
  }
  const auto turn = tendon.drum_radius_mm ? std::optional(2 * std::numbers::pi * *tendon.drum_radius_mm) : std::nullopt;
  add_motion(plan, index, tendon, turn, use);
  return use;
}

std::vector<PlungerRow> plunger_rows(const Plan& plan, std::size_t index) {
  const Syringe& syringe = plan.machine.syringes[index];
  const std::vector<std::int64_t> steps = steps_after_rows(plan, plan.machine.tendons.size() + index);
  std::vector<PlungerRow> rows;
  double plunger = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const CommandRow& requested = plan.commands.rows[i];
    const double motor = syringe.mm(static_cast<double>(steps[i]));
    plunger = std::clamp(plunger, motor, motor + syringe.backlash_mm);  // it is taken along at the ends of the play
    const double gauge_kpa = requested.pressures_kpa[syringe.actuator];
    const double volume = plunger * syringe.mm3_per_mm;
    rows.push_back({requested.line, requested.time_s, requested.actuation[syringe.actuator], gauge_kpa, plunger, volume,
                    syringe.by_pushed_mL ? volume / 1000 : syringe.ratio(plunger, gauge_kpa)});
  }
  return rows;
}

SyringeUse use_of_syringe(const Plan& plan, std::size_t index) {
  SyringeUse use;
  const std::vector<PlungerRow> rows = plunger_rows(plan, index);
  const auto range = [&](double PlungerRow::*value) {
    const auto [low, high] = std::minmax_element(rows.begin(), rows.end(),
                                                 [value](const auto& a, const auto& b) { return a.*value < b.*value; });
    return std::pair((*low).*value, (*high).*value);
  };
  std::tie(use.lowest_ratio, use.highest_ratio) = range(&PlungerRow::ratio);
  std::tie(use.lowest_kpa, use.highest_kpa) = range(&PlungerRow::gauge_kpa);
  std::tie(use.lowest_mm, use.highest_mm) = range(&PlungerRow::plunger_mm);
  for (const PlungerRow& row : rows) use.error = std::max(use.error, std::abs(row.reached - row.ratio));
  const Syringe& syringe = plan.machine.syringes[index];
  add_motion(plan, plan.machine.tendons.size() + index, syringe, syringe.lead_mm, use);
  return use;
}

double seconds_of(const std::vector<Move>& moves) {
  double seconds = 0;
  for (const Move& move : moves) seconds += move.seconds;
  return seconds;
}

}  // namespace softkin::drive
