#include "fk_table.hpp"

#include <algorithm>
#include <cmath>

#include "curve_settings.hpp"
#include "fk_units.hpp"
#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t longest_name = 24;
constexpr std::size_t load_width = 12;
constexpr int value_decimals = 4;  // of ratios and loads

std::string right(const std::string& text, std::size_t width) {
  const std::size_t shown = characters(text);
  return std::string(shown < width ? width - shown : 0, ' ') + text;
}

/// Where bytes of text hold so many characters.
std::size_t offset_of(const std::string& text, std::size_t character) {
  std::size_t at = 0;
  while (at < text.size() && characters(text.substr(0, at + 1)) <= character) ++at;
  return at;
}

/// A long name keeps its beginning and its end, which often is a number.
std::string short_name(const std::string& name) {
  const std::size_t length = characters(name);
  if (length <= longest_name) return name;
  const std::size_t half = longest_name / 2 - 1;
  return name.substr(0, offset_of(name, half)) + ".." + name.substr(offset_of(name, length - half));
}

std::string grouped(std::size_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

std::string percent(const nlohmann::ordered_json& share) {
  return decimal(100 * share.get<double>(), 1) + " %";
}

/// "pressure [kPa]" or "tension [N]" where the robot answers with one, else "".
std::string load_header(const Model& model, const Actuator& actuator) {
  if (model.formulation != Formulation::physical || actuator.kind == ActuatorKind::dea) return "";
  return actuator.kind == ActuatorKind::cable ? "tension [N]" : "pressure [kPa]";
}

std::string fixed_or_unknown(const nlohmann::ordered_json& value) {
  return value.is_null() ? "unknown" : decimal(value.get<double>(), value_decimals);
}

/// The materials' laws, each once.
std::string laws(const Model& model) {
  std::vector<std::string> names;
  for (const Material& material : model.materials) {
    const std::string name = law_name(material.elastic.law);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string command_range(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return std::string(command_name(actuator)) + " " + number(actuator.low) + " to " + number(actuator.high) + " " +
         (unit.empty() ? "[-]" : unit);
}

/// "air reached 1.62 of 1.8, tendon reached 2 N of 3 N".
std::string reached_text(const Model& model, const nlohmann::ordered_json& step) {
  std::string text;
  for (const Actuator& actuator : model.actuators) {
    const double asked = step.at("actuation").at(actuator.name).get<double>();
    const double reached = step.at("shape_actuation").at(actuator.name).get<double>();
    if (reached == asked) continue;
    text += (text.empty() ? "" : ", ") + actuator.name + " reached " + command_text(actuator, reached) + " of " +
            command_text(actuator, asked);
  }
  if (!text.empty()) return text;
  return percent(step.at("reached")) + " of the loads and displacements were reached";
}

const char* unit_of_measure(const Actuator& actuator) {
  return actuator.kind == ActuatorKind::cable ? "mm" : actuator.kind == ActuatorKind::dea ? "mm^2" : "mm^3";
}

}  // namespace

StepTable::StepTable(const Model& model, std::size_t steps) : model_(model) {
  decimals_ = std::clamp(5 - static_cast<int>(std::floor(std::log10(model.diagonal_mm))), 1, 9);
  const double farthest = model.rest.cwiseAbs().maxCoeff() + model.diagonal_mm;
  length_width_ = std::max(length_width_, decimal(-farthest, decimals_).size());
  add("step", std::to_string(steps).size());
  for (const Actuator& actuator : model.actuators) {
    const std::size_t width =
        std::max(decimal(actuator.high, value_decimals).size(), decimal(actuator.low, value_decimals).size());
    add(short_name(actuator.name) + " " + bracketed_unit(actuator), width);
    add("achieved [-]", width);
    if (const std::string load = load_header(model, actuator); !load.empty()) add(load, load_width);
    if (actuator.curve) add("by curve [" + std::string(unit_of_input(actuator.curve->input) + 1) + "]", load_width);
  }
  for (const Marker& marker : model.markers) add(short_name(marker.name) + " x, y, z [mm]", 3 * length_width_ + 2);
  add("iterations", 7);
  add("time [s]", 8);
}

void StepTable::add(const std::string& header, std::size_t width) {
  headers_.push_back(header);
  widths_.push_back(std::max(width, characters(header)));
}

std::string StepTable::line(const std::vector<std::string>& cells) const {
  std::string line;
  for (std::size_t i = 0; i < widths_.size(); ++i) line += right(cells[i], widths_[i]) + "  ";
  return line + cells.back();
}

std::string StepTable::header() const {
  std::vector<std::string> cells = headers_;
  cells.emplace_back("status");
  return line(cells);
}

std::string StepTable::row(std::size_t step, const nlohmann::ordered_json& json) const {
  std::vector<std::string> cells{std::to_string(step)};
  for (const Actuator& actuator : model_.actuators) {
    const auto& values = json.at("actuators").at(actuator.name);
    for (const char* key : {"requested", "achieved"}) cells.push_back(fixed_or_unknown(values.at(key)));
    if (!load_header(model_, actuator).empty())
      cells.push_back(values.value("slack", false) ? "slack" : fixed_or_unknown(values.at(multiplier_key(actuator))));
    if (actuator.curve) {
      const auto& input = values.at(curve_key(*actuator.curve));
      cells.push_back(input.is_null() ? "outside" : fixed_or_unknown(input));
    }
  }
  for (const Marker& marker : model_.markers) {
    std::string point;
    for (const auto& x : json.at("markers").at(marker.name))
      point += (point.empty() ? "" : " ") + right(decimal(x.get<double>(), decimals_), length_width_);
    cells.push_back(point);
  }
  cells.push_back(std::to_string(json.at("iterations").get<int>()));
  cells.push_back(decimal(json.at("seconds").get<double>(), 2));
  cells.push_back(json.at("status").get<std::string>());
  return line(cells);
}

std::string summary(const Model& model, const std::string& solver) {
  std::string text = grouped(static_cast<std::size_t>(model.rest.rows())) + " vertices";
  if (!model.tetrahedra.empty())
    text += ", " + grouped(model.tetrahedra.size()) + " tetrahedra of order " + (model.edge_nodes.empty() ? "1" : "2");
  if (!model.prisms.empty()) text += ", " + grouped(model.prisms.size()) + " prisms";
  text += std::string("; ") + formulation_name(model.formulation) + " formulation";
  if (model.formulation == Formulation::physical) text += " (" + laws(model) + ")";
  text += ", solver " + solver;
  for (const Actuator& a : model.actuators)
    text += "\nactuator " + a.name + ": " + kind_name(a) + ", " + number(a.rest_measure) + " " + unit_of_measure(a) +
            " at rest, " + command_range(a) + curve_text(a);
  for (const std::string& note : model.notes) text += "\nnote: " + note;
  return text;
}

std::string findings(const Model& model, const nlohmann::ordered_json& step) {
  const auto& strain = step.at("strain");
  std::string text;
  const auto say = [&text](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
  if (!strain.at("volume_shares").empty())
    say("principal strain of the body: " + percent(strain.at("least")) + " to " + percent(strain.at("greatest")) +
        ", 95 % of the volume within " + percent(strain.at("magnitude_percentile_95")));
  for (const auto& beyond : strain.at("beyond_linear_range"))
    say(percent(beyond.at("volume_share")) + " of region '" + beyond.at("region").get<std::string>() +
        "' is strained beyond its linear range of " + percent(beyond.at("linear_range")));
  if (const auto inverted = step.at("inverted_elements").get<std::size_t>(); inverted > 0)
    say("warning: " + counted(inverted, "element") + (inverted == 1 ? " is" : " are") + " inverted");
  for (const auto& [name, actuator] : step.at("actuators").items())
    if (actuator.value("slack", false))
      say("cable '" + name + "' is slack: its path is " + number(actuator.at("achieved").get<double>(), 5) +
          " of its length at rest, the cable " + number(actuator.at("requested").get<double>(), 5));
  const bool physical = model.formulation == Formulation::physical;
  if (physical && step.at("status").get<std::string>() != "converged") return text;  // of another shape
  const auto& moved = step.at("step_mm");
  const auto& error = step.at("estimated_error_mm");
  if (moved.is_null() || error.is_null())
    say("warning: the iteration diverged");
  else
    say("last step of the iteration " + number(moved.get<double>(), 2) +
        " mm; estimated distance from the equilibrium " + number(error.get<double>(), 2) + " mm");
  return text;
}

std::string shortfall(const Model& model, const nlohmann::ordered_json& step) {
  const auto remark = step.at("remark").get<std::string>();
  if (model.formulation == Formulation::physical)
    return reached_text(model, step) + ": " + remark + "; the shape is the last good one";
  return (remark.empty() ? "" : remark + ", and ") + "the shape is that after " +
         counted(step.at("iterations").get<std::size_t>(), "iteration") + ", not an equilibrium";
}

std::string list_text(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(numbers[i]);
    if (last > i) text += (last > i + 1 ? " to " : ", ") + std::to_string(numbers[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace softkin::cli
