#include "drive_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

struct TendonUse {
  double shortest_mm = 0, longest_mm = 0;  // cable
  double fastest_mm_per_s = 0;             // motor [mm of cable]
  std::int64_t lowest = 0, highest = 0;    // steps from home
};

TendonUse use_of(const DrivePlan& plan, std::size_t index) {
  const drive::Tendon& tendon = plan.machine.tendons[index];
  TendonUse use;
  use.shortest_mm = tendon.longest_mm;
  for (const drive::CommandRow& row : plan.commands.rows) {
    const double length = row.actuation[tendon.actuator] * tendon.rest_length_mm;
    use.shortest_mm = std::min(use.shortest_mm, length);
    use.longest_mm = std::max(use.longest_mm, length);
  }
  std::int64_t here = 0;
  for (const auto* moves : {&plan.motion.approach, &plan.motion.moves, &plan.motion.back})
    for (const drive::Move& move : *moves) {
      const double cable = static_cast<double>(std::abs(move.target[index] - here)) /
                           (tendon.steps_per_mm * tendon.axis_mm_per_cable_mm);
      use.fastest_mm_per_s = std::max(use.fastest_mm_per_s, cable / move.seconds);
      here = move.target[index];
      use.lowest = std::min(use.lowest, here);
      use.highest = std::max(use.highest, here);
    }
  return use;
}

/// The drum's turns from home, at the end farther from it; "-" without a drum.
std::string turns(const drive::Tendon& tendon, const TendonUse& use) {
  if (!tendon.drum_radius_mm) return "-";
  const double cable = static_cast<double>(std::max(std::abs(use.lowest), std::abs(use.highest))) /
                       (tendon.steps_per_mm * tendon.axis_mm_per_cable_mm);
  return decimal(cable / (2 * std::numbers::pi * *tendon.drum_radius_mm), 2);
}

std::string tendon_table(const DrivePlan& plan) {
  std::vector<std::vector<std::string>> rows{{"tendon", "axis", "length [mm]", "limits [mm]", "steps from home",
                                              "drum turns", "speed [mm/s]", "limit [mm/s]"}};
  for (std::size_t i = 0; i < plan.machine.tendons.size(); ++i) {
    const drive::Tendon& tendon = plan.machine.tendons[i];
    const TendonUse use = use_of(plan, i);
    rows.push_back({printable(tendon.name), std::string(1, tendon.axis),
                    decimal(use.shortest_mm, 2) + " to " + decimal(use.longest_mm, 2),
                    decimal(tendon.shortest_mm, 2) + " to " + decimal(tendon.longest_mm, 2),
                    std::to_string(use.lowest) + " to " + std::to_string(use.highest), turns(tendon, use),
                    decimal(use.fastest_mm_per_s, 2), decimal(tendon.max_speed_mm_per_s, 2)});
  }
  return joined(aligned(rows, "llrrrrrr"), "");
}

std::pair<double, double> pressure_range(const drive::PressureSchedule& schedule, std::size_t channel) {
  const auto [low, high] =
      std::minmax_element(schedule.rows.begin(), schedule.rows.end(),
                          [channel](const auto& a, const auto& b) { return a.kpa[channel] < b.kpa[channel]; });
  return {low->kpa[channel], high->kpa[channel]};
}

std::string chamber_table(const DrivePlan& plan) {
  std::vector<std::vector<std::string>> rows{{"chamber", "channel", "pressure [kPa]", "limits [kPa]"}};
  for (std::size_t i = 0; i < plan.machine.chambers.size(); ++i) {
    const drive::Chamber& chamber = plan.machine.chambers[i];
    const auto [low, high] = pressure_range(plan.schedule, i);
    rows.push_back({printable(chamber.name), printable(chamber.channel), decimal(low, 2) + " to " + decimal(high, 2),
                    decimal(chamber.low_kpa, 2) + " to " + decimal(chamber.high_kpa, 2)});
  }
  return joined(aligned(rows, "llrr"), "");
}

double seconds_of(const std::vector<drive::Move>& moves) {
  double seconds = 0;
  for (const drive::Move& move : moves) seconds += move.seconds;
  return seconds;
}

std::string times_text(const DrivePlan& plan) {
  std::string text = counted(plan.commands.rows.size(), "row");
  if (plan.motion.timed)
    text += ", " + number(*plan.commands.rows.back().time_s - *plan.commands.rows.front().time_s, 6) + " s";
  else if (!plan.machine.tendons.empty())
    text += " without times: " + number(plan.motion.seconds, 4) + " s at the approach speed of " +
            number(plan.machine.approach_speed_mm_per_s) + " mm/s";
  if (plan.machine.tendons.empty()) return text;
  text += ", after an approach of " + number(seconds_of(plan.motion.approach), 4) + " s from home";
  if (!plan.motion.back.empty()) text += "; the way back home takes " + number(seconds_of(plan.motion.back), 4) + " s";
  return text + "; " + counted(plan.program.lines.size(), "line") + " of G-code";
}

}  // namespace

std::string plan_text(const DrivePlan& plan) {
  std::string text = "hardware: " + plan.machine.file + "\n";
  for (const std::string& line : plan.machine.defaults) text += "default: " + printable(line) + "\n";
  if (!plan.machine.tendons.empty()) text += tendon_table(plan);
  if (!plan.machine.chambers.empty()) text += chamber_table(plan);
  return text + times_text(plan) + "\n";
}

nlohmann::ordered_json plan_json(const DrivePlan& plan) {
  nlohmann::ordered_json json = {{"hardware", plan.machine.file}, {"defaults", plan.machine.defaults}};
  for (std::size_t i = 0; i < plan.machine.tendons.size(); ++i) {
    const drive::Tendon& tendon = plan.machine.tendons[i];
    const TendonUse use = use_of(plan, i);
    json["tendons"][tendon.name] = {{"axis", std::string(1, tendon.axis)},
                                    {"rest_length_mm", tendon.rest_length_mm},
                                    {"length_mm", {use.shortest_mm, use.longest_mm}},
                                    {"length_limits_mm", {tendon.shortest_mm, tendon.longest_mm}},
                                    {"steps", {use.lowest, use.highest}},
                                    {"speed_mm_per_s", use.fastest_mm_per_s},
                                    {"max_speed_mm_per_s", tendon.max_speed_mm_per_s},
                                    {"max_acceleration_mm_per_s2", tendon.max_acceleration_mm_per_s2},
                                    {"slack_offset_mm", tendon.slack_offset_mm},
                                    {"backlash_mm", tendon.backlash_mm}};
  }
  for (std::size_t i = 0; i < plan.machine.chambers.size(); ++i) {
    const drive::Chamber& chamber = plan.machine.chambers[i];
    const auto [low, high] = pressure_range(plan.schedule, i);
    json["chambers"][chamber.name] = {{"channel", chamber.channel},
                                      {"pressure_kPa", {low, high}},
                                      {"limits_kPa", {chamber.low_kpa, chamber.high_kpa}}};
  }
  json["rows"] = plan.commands.rows.size();
  if (!plan.machine.tendons.empty()) {
    json["approach_s"] = seconds_of(plan.motion.approach);
    json["motion_s"] = plan.motion.seconds;
    json["lines"] = plan.program.lines.size();
  }
  return json;
}

}  // namespace softkin::cli
