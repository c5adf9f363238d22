#include "fk_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t longest_name = 24;
constexpr int ratio_decimals = 4;

std::string fixed(double value, int decimals) {
  char text[400];
  const bool zero = std::abs(value) < 0.5 * std::pow(10, -decimals);  // never "-0.000"
  std::snprintf(text, sizeof text, "%.*f", decimals, zero ? 0.0 : value);
  return text;
}

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
  return fixed(100 * share.get<double>(), 1) + " %";
}

const char* kind_of(const Actuator& actuator) {
  return actuator.kind == ActuatorKind::cable ? "cable" : actuator.kind == ActuatorKind::dea ? "dea" : "pneumatic";
}

const char* unit_of(const Actuator& actuator) {
  return actuator.kind == ActuatorKind::cable ? "mm" : actuator.kind == ActuatorKind::dea ? "mm^2" : "mm^3";
}

}  // namespace

StepTable::StepTable(const Model& model, std::size_t steps) : model_(model) {
  decimals_ = std::clamp(5 - static_cast<int>(std::floor(std::log10(model.diagonal_mm))), 1, 9);
  const double farthest = model.rest.cwiseAbs().maxCoeff() + model.diagonal_mm;
  length_width_ = std::max(length_width_, fixed(-farthest, decimals_).size());
  add("step", std::to_string(steps).size());
  for (const Actuator& actuator : model.actuators) {
    const std::size_t width = fixed(actuator.high, ratio_decimals).size();
    add(short_name(actuator.name) + " [-]", width);
    add("achieved [-]", width);
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
  for (const Actuator& actuator : model_.actuators)
    for (const char* key : {"requested", "achieved"})
      cells.push_back(fixed(json.at("actuators").at(actuator.name).at(key).get<double>(), ratio_decimals));
  for (const Marker& marker : model_.markers) {
    std::string point;
    for (const auto& x : json.at("markers").at(marker.name))
      point += (point.empty() ? "" : " ") + right(fixed(x.get<double>(), decimals_), length_width_);
    cells.push_back(point);
  }
  cells.push_back(std::to_string(json.at("iterations").get<int>()));
  cells.push_back(fixed(json.at("seconds").get<double>(), 2));
  cells.push_back(json.at("status").get<std::string>());
  return line(cells);
}

std::string summary(const Model& model) {
  std::string text = grouped(static_cast<std::size_t>(model.rest.rows())) + " vertices";
  if (!model.tetrahedra.empty()) text += ", " + grouped(model.tetrahedra.size()) + " tetrahedra";
  if (!model.prisms.empty()) text += ", " + grouped(model.prisms.size()) + " prisms";
  for (const Actuator& a : model.actuators)
    text += "\nactuator " + a.name + ": " + kind_of(a) + ", " + number(a.rest_measure) + " " + unit_of(a) +
            " at rest, ratio " + number(a.low) + " to " + number(a.high) + " [-]";
  for (const std::string& note : model.notes) text += "\nnote: " + note;
  return text;
}

std::string findings(const nlohmann::ordered_json& step) {
  const auto& strain = step.at("strain");
  std::string text;
  if (!strain.at("volume_shares").empty())
    text += "principal strain of the body: " + percent(strain.at("least")) + " to " + percent(strain.at("greatest")) +
            ", 95 % of the volume within " + percent(strain.at("magnitude_percentile_95")) + "\n";
  for (const auto& beyond : strain.at("beyond_linear_range"))
    text += percent(beyond.at("volume_share")) + " of region '" + beyond.at("region").get<std::string>() +
            "' is strained beyond its linear range of " + percent(beyond.at("linear_range")) + "\n";
  if (const auto inverted = step.at("inverted_elements").get<std::size_t>(); inverted > 0)
    text += "warning: " + counted(inverted, "element") + (inverted == 1 ? " is" : " are") + " inverted\n";
  const auto& moved = step.at("step_mm");
  const auto& error = step.at("estimated_error_mm");
  if (moved.is_null() || error.is_null()) return text + "warning: the iteration diverged";
  return text + "last step of the iteration " + number(moved.get<double>(), 2) +
         " mm; estimated distance from the equilibrium " + number(error.get<double>(), 2) + " mm";
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
