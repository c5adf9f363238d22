#include "step_text.hpp"

#include <algorithm>
#include <cmath>

#include <softkin/core/text.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>

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
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const auto i = static_cast<Index>(a);
    const double asked = step.actuation[i], reached = step.shape_actuation.value_or(step.actuation)[i];
    if (reached == asked) continue;
    text += (text.empty() ? "" : ", ") + model.actuators[a].name + " reached " +
            command_text(model.actuators[a], reached) + " of " + command_text(model.actuators[a], asked);
  }
  if (!text.empty()) return text;
  return percent(step.reached.value_or(0)) + " of the loads and displacements were reached";
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
  const auto say = [&text](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
  if (!step.strain.shares.empty())
    say("principal strain of the body: " + percent(step.strain.least) + " to " + percent(step.strain.greatest) +
        ", 95 % of the volume within " + percent(step.strain.percentile_95));
  for (const auto& beyond : step.strain.beyond)
    say(percent(beyond.share) + " of region '" + beyond.region + "' is strained beyond its linear range of " +
        percent(beyond.linear_range));
  if (const std::size_t inverted = step.inverted_elements; inverted > 0)
    say("warning: " + counted(inverted, "element") + (inverted == 1 ? " is" : " are") + " inverted");
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const ActuatorRecord& actuator = step.actuators[a]; actuator.slack)
      say("cable '" + model.actuators[a].name + "' is slack: its path is " + number(actuator.achieved, 5) +
          " of its length at rest, the cable " + number(actuator.requested, 5));
  const bool physical = model.formulation == Formulation::physical;
  if (physical && step.status != Status::converged) return text;  // of another shape
  if (!std::isfinite(step.step_mm) || !std::isfinite(step.estimated_error_mm))
    say("warning: the iteration diverged");
  else
    say("last step of the iteration " + number(step.step_mm, 2) + " mm; estimated distance from the equilibrium " +
        number(step.estimated_error_mm, 2) + " mm");
  return text;
}

std::string shortfall_text(const Model& model, const StepRecord& step) {
  if (model.formulation == Formulation::physical)
    return reached_text(model, step) + ": " + step.remark + "; the shape is the last good one";
  return (step.remark.empty() ? "" : step.remark + ", and ") + "the shape is that after " +
         counted(static_cast<std::size_t>(step.iterations), "iteration") + ", not an equilibrium";
}

}  // namespace softkin::cli
