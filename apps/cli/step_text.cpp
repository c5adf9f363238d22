#include "step_text.hpp"

#include <algorithm>
#include <cmath>

#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/findings.hpp>
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

std::string percent(double share) {
  return decimal(100 * share, 1) + " %";
}

/// "pressure [kPa]" or "tension [N]" where the robot answers with one, else "".
std::string load_header(const Model& model, const Actuator& actuator) {
  if (model.formulation != Formulation::physical || actuator.kind == ActuatorKind::dea) return "";
  return actuator.kind == ActuatorKind::cable ? "tension [N]" : "pressure [kPa]";
}

std::string fixed_or_unknown(double value) {
  return std::isfinite(value) ? decimal(value, value_decimals) : "unknown";
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
std::string reached_text(const Model& model, const StepRecord& step) {
  std::string text;
  for (const auto& [a, reached, asked] : runs::shortfalls(model, step)) {
    const Actuator& actuator = model.actuators[static_cast<std::size_t>(a)];
    text += (text.empty() ? "" : ", ") + actuator.name + " reached " + command_text(actuator, reached) + " of " +
            command_text(actuator, asked);
  }
  if (!text.empty()) return text;
  return percent(step.reached.value_or(0)) + " of the loads and displacements were reached";
}

std::string finding_text(const runs::Finding& finding) {
  using Kind = runs::Finding::Kind;
  const std::vector<double>& v = finding.values;
  switch (finding.kind) {
    case Kind::strain:
      return "principal strain of the body: " + percent(v[0]) + " to " + percent(v[1]) +
             ", 95 % of the volume within " + percent(v[2]);
    case Kind::beyond_linear_range:
      return percent(v[0]) + " of region '" + finding.name + "' is strained beyond its linear range of " +
             percent(v[1]);
    case Kind::inverted:
      return "warning: " + counted(static_cast<std::size_t>(v[0]), "element") + (v[0] == 1 ? " is" : " are") +
             " inverted";
    case Kind::slack:
      return "cable '" + finding.name + "' is slack: its path is " + number(v[0], 5) +
             " of its length at rest, the cable " + number(v[1], 5);
    case Kind::accuracy:
      return "last step of the iteration " + number(v[0], 2) + " mm; estimated distance from the equilibrium " +
             number(v[1], 2) + " mm";
    case Kind::diverged:
      break;
  }
  return "warning: the iteration diverged";
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

std::string StepTable::row(std::size_t number_of_step, const StepRecord& step) const {
  std::vector<std::string> cells{std::to_string(number_of_step)};
  for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
    const Actuator& actuator = model_.actuators[a];
    const ActuatorRecord& record = step.actuators[a];
    cells.push_back(fixed_or_unknown(record.requested));
    cells.push_back(fixed_or_unknown(record.achieved));
    if (!load_header(model_, actuator).empty())
      cells.push_back(record.slack ? "slack" : fixed_or_unknown(record.multiplier));
    if (actuator.curve) cells.push_back(record.by_curve ? fixed_or_unknown(*record.by_curve) : "outside");
  }
  for (const Vec3& marker : step.markers) {
    std::string point;
    for (const double x : marker) point += (point.empty() ? "" : " ") + right(decimal(x, decimals_), length_width_);
    cells.push_back(point);
  }
  cells.push_back(std::to_string(step.iterations));
  cells.push_back(decimal(step.seconds, 2));
  cells.emplace_back(name_of(step.status));
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

std::string findings_text(const Model& model, const StepRecord& step) {
  std::string text;
  for (const runs::Finding& finding : runs::findings(model, step))
    text += (text.empty() ? "" : "\n") + finding_text(finding);
  return text;
}

std::string shortfall_text(const Model& model, const StepRecord& step) {
  if (model.formulation == Formulation::physical)
    return reached_text(model, step) + ": " + step.remark + "; the shape is the last good one";
  return (step.remark.empty() ? "" : step.remark + ", and ") + "the shape is that after " +
         counted(static_cast<std::size_t>(step.iterations), "iteration") + ", not an equilibrium";
}

}  // namespace softkin::cli
