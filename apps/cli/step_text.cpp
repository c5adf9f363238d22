#include "step_text.hpp"

#include <algorithm>
#include <cmath>

#include <softkin/core/text.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/records.hpp>

namespace softkin::cli {

namespace {

std::string grouped(std::size_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

std::string percent(double share) {
  return decimal(100 * share, 1) + " %";
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
  return percent(step.reached_share.value_or(0)) + " of the loads and displacements were reached";
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
