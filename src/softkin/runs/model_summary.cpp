#include <algorithm>
#include <softkin/core/text.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/model_summary.hpp>

namespace softkin::runs {

namespace {

std::string grouped(std::size_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

/// The materials' laws, each once.
std::string laws(const Model& model) {
  std::vector<std::string> names;
  for (const Material& material : model.elements.materials) {
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

const char* unit_of_measure(const Actuator& actuator) {
  return actuator.is<CableDrive>() ? "mm" : actuator.is<DeaDrive>() ? "mm^2" : "mm^3";
}

}  // namespace

std::string model_summary(const Model& model, const std::string& solver) {
  std::string text = grouped(model.robot_vertices()) + " vertices";
  if (!model.elements.tetrahedra.empty())
    text +=
        ", " + grouped(model.elements.tetrahedra.size()) + " tetrahedra of order " + std::to_string(order_of(model));
  if (!model.elements.prisms.empty()) text += ", " + grouped(model.elements.prisms.size()) + " prisms";
  if (model.elements.tetrahedra.empty() && model.elements.prisms.empty())
    text += ", layers alone, of order " + std::to_string(order_of(model));
  text += std::string("; ") + formulation_name(model.formulation) + " formulation";
  if (!model.elements.materials.empty() && model.formulation == Formulation::physical) text += " (" + laws(model) + ")";
  if (model.weights != ElementWeights::printed) text += std::string(" (weights ") + weights_name(model.weights) + ")";
  if (!solver.empty()) text += ", solver " + solver;
  for (const FreeBody& body : model.bodies)
    text += "\nbody " + body.name + ": " + number(1000 * body.mass_kg) + " g; held while " + body.name +
            "_hold is 1, free at 0; forces " + body.name + "_fx, _fy and _fz [N]";
  for (const Actuator& a : model.actuators)
    if (a.is<MotionCommand>())
      text += "\nobstacle moved by " + a.name + " [mm]";
    else if (loads_robot(a))
      text += std::string("\n") + kind_name(a) + " commanded by " + a.name + " " + bracketed_unit(a) + ", " +
              number(a.low) + " to " + number(a.high);
    else if (const auto* turn = a.as<TurnCommand>())
      text += "\nsupport '" + model.held.turns[turn->turn].support + "' turned by " + a.name + " [deg]";
  for (const Actuator& a : model.actuators)
    if (drives(a))
      text += "\nactuator " + a.name + ": " + kind_name(a) + ", " +
              (flat_at_rest(a)  ? "flat at rest, "
               : has_measure(a) ? number(a.rest_measure) + " " + unit_of_measure(a) + " at rest, "
                                : "") +
              command_range(a) + curve_text(a);
  for (const std::string& warning : model.warnings) text += "\nwarning: " + warning;
  for (const std::string& note : model.notes) text += "\nnote: " + note;
  return text;
}

}  // namespace softkin::runs
