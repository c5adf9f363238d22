#include "walk_steps.hpp"

#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>

#include "fk_units.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

const std::string sliding_names[] = {"none", "rear", "front", "both"};  // of Sliding
constexpr double same_stride_mm = 1e-4;
constexpr int length_decimals = 4, force_decimals = 6;

bool has_friction(const Model& model) {
  return model.formulation == Formulation::physical;
}

void check_closed(const Model& model, const std::string& file, const std::vector<Step>& gait) {
  if (gait.size() < 2) throw InvalidInput({file}, "a gait needs two rows or more, not " + std::to_string(gait.size()));
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const auto value = [&](const Step& step) { return step.actuation[static_cast<Index>(a)]; };
    const double first = value(gait.front()), last = value(gait.back());
    if (std::abs(first - last) > 1e-9 * std::max(1.0, std::abs(first)))
      throw InvalidInput({file, gait.back().line}, "a gait ends where it begins, but " + model.actuators[a].name +
                                                       " ends at " + command_text(model.actuators[a], last) +
                                                       " and begins at " + command_text(model.actuators[a], first));
  }
}

}  // namespace

std::vector<GaitStep> repeated(const Model& model, const std::string& file, const std::vector<Step>& gait,
                               std::size_t cycles) {
  check_closed(model, file, gait);
  const bool timed = gait.front().time.has_value();
  const double period = timed ? *gait.back().time - *gait.front().time : 0;
  std::vector<GaitStep> steps{{gait.front(), 0}};
  for (std::size_t cycle = 1; cycle <= cycles; ++cycle)
    for (std::size_t row = 1; row < gait.size(); ++row) {
      steps.push_back({gait[row], cycle});
      if (timed) *steps.back().asked.time += static_cast<double>(cycle - 1) * period;
    }
  return steps;
}

const std::string& foot_name(const Model& model, std::size_t foot) {
  return model.markers[static_cast<std::size_t>(model.feet[foot].marker)].name;
}

std::string sliding_text(const Model& model, Sliding sliding) {
  switch (sliding) {
    case Sliding::none:
      return "-";
    case Sliding::rear:
      return foot_name(model, 0);
    case Sliding::front:
      return foot_name(model, 1);
    case Sliding::both:
      break;
  }
  return foot_name(model, 0) + " and " + foot_name(model, 1);
}

Report::Json walk_json(const Model& model, const GaitStep& gait, const WalkStep& walk,
                       const ElementDeformation& deformation) {
  Report::Json step = step_json(model, walk.equilibrium, deformation);
  if (gait.asked.time) step["time_s"] = *gait.asked.time;
  Report::Json& json = step["walk"];
  json = {{"cycle", gait.cycle}, {"sliding", sliding_names[static_cast<std::size_t>(walk.sliding)]}};
  if (has_friction(model)) json["friction_N"] = walk.friction_N;
  json["feet_mm"] = {{foot_name(model, 0), walk.rear_mm}, {foot_name(model, 1), walk.front_mm}};
  json["travel_mm"] = walk.travel_mm;
  json["shift_mm"] = walk.shift_mm;
  json["equilibria"] = walk.equilibria;
  return step;
}

WalkStep walked(const Model& model, const Report::Json& step) {
  const Report::Json& json = step.at("walk");
  WalkStep walk;
  const auto name = std::find(std::begin(sliding_names), std::end(sliding_names), json.at("sliding"));
  walk.sliding = static_cast<Sliding>(name - std::begin(sliding_names));
  if (has_friction(model)) walk.friction_N = json.at("friction_N").get<double>();
  walk.rear_mm = json.at("feet_mm").at(foot_name(model, 0)).get<double>();
  walk.front_mm = json.at("feet_mm").at(foot_name(model, 1)).get<double>();
  walk.travel_mm = json.at("travel_mm").get<double>();
  walk.shift_mm = json.at("shift_mm").get<double>();
  walk.equilibria = json.at("equilibria").get<int>();
  return walk;
}

std::string walk_csv(const Model& model, const std::vector<WalkedStep>& steps) {
  const bool timed = steps.front().gait.asked.time.has_value();
  std::string text = timed ? "cycle,t_s" : "cycle";
  for (const Actuator& actuator : model.actuators) {
    const std::string unit = command_unit(actuator);
    text += "," + actuator.name + (unit.empty() ? "" : "_" + unit);
  }
  text += "," + foot_name(model, 0) + "_mm," + foot_name(model, 1) + "_mm,travel_mm";
  text += has_friction(model) ? ",friction_N,sliding\n" : ",sliding\n";
  for (const WalkedStep& step : steps) {
    const WalkStep& walk = step.walk;
    text += std::to_string(step.gait.cycle);
    if (timed) text += "," + exact(*step.gait.asked.time);
    for (const double value : step.gait.asked.actuation) text += "," + exact(value);
    for (const double place : {walk.rear_mm, walk.front_mm, walk.travel_mm}) text += "," + exact(place);
    if (has_friction(model)) text += "," + exact(walk.friction_N);
    text += "," + sliding_text(model, walk.sliding) + "\n";
  }
  return text;
}

std::vector<double> strides(const std::vector<WalkedStep>& steps, std::size_t cycles) {
  std::vector<double> lengths;
  double before = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::size_t cycle = steps[i].gait.cycle;
    const bool ends = i + 1 < steps.size() ? steps[i + 1].gait.cycle > cycle : cycle == cycles;
    if (!ends || cycle == 0) continue;
    lengths.push_back(steps[i].walk.travel_mm - before);
    before = steps[i].walk.travel_mm;
  }
  return lengths;
}

WalkTable::WalkTable(const Model& model) : model_(model) {
  columns_.add("cycle", 5);
  columns_.add("t [s]", 7);
  for (const Actuator& actuator : model.actuators) columns_.add_command(actuator);
  for (std::size_t foot = 0; foot < 2; ++foot) columns_.add(foot_name(model, foot) + " [mm]", 10);
  columns_.add("travel [mm]", 10);
  if (has_friction(model)) columns_.add("friction [N]", 12);
}

std::string WalkTable::row(const WalkedStep& step) const {
  const WalkStep& walk = step.walk;
  std::vector<std::string> cells{std::to_string(step.gait.cycle)};
  cells.push_back(step.gait.asked.time ? number(*step.gait.asked.time) : "-");
  for (const double value : step.gait.asked.actuation) cells.push_back(Columns::command(value));
  for (const double place : {walk.rear_mm, walk.front_mm, walk.travel_mm})
    cells.push_back(decimal(place, length_decimals));
  if (has_friction(model_)) cells.push_back(decimal(walk.friction_N, force_decimals));
  return columns_.row(cells) + sliding_text(model_, walk.sliding);
}

std::string stride_text(const std::vector<double>& strides) {
  const double last = strides.back();
  std::size_t settled = strides.size();  // cycles before this one have another stride
  while (settled > 0 && std::abs(strides[settled - 1] - last) <= same_stride_mm) --settled;
  std::string text = "stride: " + decimal(last, length_decimals) + " mm per cycle";
  if (settled + 1 >= strides.size()) {
    if (strides.size() > 1) text += " in the last one, which is not that of the one before: walk more --cycles";
  } else if (settled > 0) {
    text += " from cycle " + std::to_string(settled + 1) + " on";
  }
  return text;
}

}  // namespace softkin::cli
