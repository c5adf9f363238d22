#include <nlohmann/json.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/contacts_json.hpp>
#include <softkin/runs/physical_json.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/reinforcement_json.hpp>
#include <stdexcept>

namespace softkin::runs {

namespace {

/// visit(key, extreme) of each.
template <class Extremes, class Visit>
void each_extreme(Extremes& stress, const Visit& visit) {
  visit("von_mises_MPa", stress.von_mises);
  visit("principal_max_MPa", stress.greatest);
  visit("principal_min_MPa", stress.least);
}

Json stress_json(const StressExtremes& stress) {
  Json json;
  each_extreme(stress, [&json](const char* key, const StressExtremes::Extreme& extreme) {
    json[key] = {{"value", known(extreme.value)}, {"at_mm", json_of(extreme.at)}, {"region", extreme.region}};
  });
  return json;
}

StressExtremes stress_of(const Json& json) {
  StressExtremes stress;
  each_extreme(stress, [&json](const char* key, StressExtremes::Extreme& extreme) {
    const Json& of = json.at(key);
    extreme = {number_or_nan(of.at("value")), point_of(of.at("at_mm")), of.at("region").get<std::string>()};
  });
  return stress;
}

Json reaction_json(const Model& model, const Support& support, const Reaction& reaction) {
  Json json = {{"support", support.name},
               {"force_N", json_of(reaction.force)},
               {"moment_N_mm", json_of(reaction.moment)},
               {"center_mm", json_of(reaction.center)}};
  for (const ChamberForce& chamber : reaction.chambers)
    json["chambers"].push_back({{"actuator", model.actuators[chamber.actuator].name},
                                {"air_force_N", json_of(chamber.force)},
                                {"air_moment_N_mm", json_of(chamber.moment)}});
  return json;
}

Reaction reaction_of(const Model& model, const Json& json) {
  Reaction reaction{point_of(json.at("force_N")), point_of(json.at("moment_N_mm")), point_of(json.at("center_mm")), {}};
  if (!json.contains("chambers")) return reaction;
  for (const Json& each : json.at("chambers")) {
    const std::optional<Index> actuator = find_actuator(model, each.at("actuator").get<std::string>());
    if (!actuator) throw std::out_of_range("no such actuator");
    reaction.chambers.push_back({*actuator, point_of(each.at("air_force_N")), point_of(each.at("air_moment_N_mm"))});
  }
  return reaction;
}

Json magnetic_json(const MagneticLoad& load) {
  return {{"force_N", json_of(load.force)}, {"moment_N_mm", json_of(load.moment)}, {"center_mm", json_of(load.center)}};
}

Json worst_json(const WorstPlace& worst) {
  return {{"kind", worst.prism ? "prism" : "tetrahedron"},
          {"element", worst.element},
          {"region", worst.region},
          {"at_mm", json_of(worst.at)},
          {"strain", known(worst.strain)},
          {"volume_ratio", known(worst.volume_ratio)},
          {"beside", worst.beside}};
}

WorstPlace worst_of(const Json& json) {
  WorstPlace worst;
  worst.prism = json.at("kind").get<std::string>() == "prism";
  worst.element = json.at("element").get<Index>();
  worst.region = json.at("region").get<std::string>();
  worst.at = point_of(json.at("at_mm"));
  worst.strain = number_or_nan(json.at("strain"));
  worst.volume_ratio = number_or_nan(json.at("volume_ratio"));
  worst.beside = json.at("beside").get<std::string>();
  return worst;
}

/// The results of the physical formulation on forces and stability.
template <class Report, class Visit>
void forces(Report& physical, const Visit& visit) {
  visit("residual_N", physical.residual_N);
  visit("pull_N", physical.pull_N);
  visit("unstable_modes", physical.unstable_modes);
  visit("buckled", physical.buckled);
  visit("buckled_mm", physical.buckled_mm);
  visit("snapped_mm", physical.snapped_mm);
  visit("snapped_from", physical.snapped_from);
  visit("unstable_from", physical.unstable_from);
}

Json branch_json(const Model& model, const LoadBranch& branch) {
  const Actuator& actuator = model.actuators[branch.actuator];
  Json json = {{"actuator", actuator.name}, {"ratio", Json::array()}, {multiplier_key(actuator), Json::array()}};
  for (const LoadBranch::Point& point : branch.points) {
    json["ratio"].push_back(known(point.measure));
    json[multiplier_key(actuator)].push_back(known(point.load));
  }
  return json;
}

LoadBranch branch_of(const Model& model, const Json& json) {
  LoadBranch branch;
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (model.actuators[a].name == json.at("actuator").get<std::string>()) branch.actuator = a;
  if (branch.actuator < 0) throw std::out_of_range("no such actuator");
  const Json& loads = json.at(multiplier_key(model.actuators[branch.actuator]));
  for (std::size_t i = 0; i < loads.size(); ++i)
    branch.points.push_back({number_or_nan(json.at("ratio").at(i)), number_or_nan(loads.at(i))});
  return branch;
}

}  // namespace

Json physical_json(const Model& model, const StepRecord& record) {
  Json json = {{"shape_load_share", record.shape_load_fraction}};
  forces(record.physical, [&json](const char* key, const auto& value) { write_number(value, json[key]); });
  json["stress"] = record.forces.stress ? stress_json(*record.forces.stress) : Json();
  if (!record.physical.branch.points.empty()) json["branch"] = branch_json(model, record.physical.branch);
  json["limit"] = record.worst ? worst_json(*record.worst) : Json();
  json["reactions"] = Json::array();
  for (std::size_t s = 0; s < record.forces.reactions.size(); ++s)
    json["reactions"].push_back(reaction_json(model, model.held.supports[s], record.forces.reactions[s]));
  if (model.magnetism) json["magnetic"] = record.forces.magnetic ? magnetic_json(*record.forces.magnetic) : Json();
  if (!record.forces.fibres.empty()) json["fibres"] = fibres_json(model, record.forces.fibres);
  if (!record.forces.layers.empty()) json["layers"] = layers_json(model, record.forces.layers);
  if (model.contact.any()) json["contacts"] = contacts_json(model, record.forces.contacts);
  if (model.contact.has_friction()) json["friction_change"] = known(record.physical.friction_change);
  if (!record.anchors.empty()) json["anchors"] = anchors_json(record.anchors);
  if (!record.eyelets.empty()) json["eyelets_mm"] = record.eyelets;
  return json;
}

void read_physical(const Model& model, const Json& json, StepRecord& record) {
  record.shape_load_fraction = json.at("shape_load_share").get<double>();
  forces(record.physical, [&json](const char* key, auto& value) { read_number(json.at(key), value); });
  if (const Json& stress = json.at("stress"); !stress.is_null()) record.forces.stress = stress_of(stress);
  if (json.contains("branch")) record.physical.branch = branch_of(model, json.at("branch"));
  if (const Json& worst = json.at("limit"); !worst.is_null()) record.worst = worst_of(worst);
  for (const Json& each : json.at("reactions")) record.forces.reactions.push_back(reaction_of(model, each));
  if (model.magnetism)
    if (const Json& load = json.at("magnetic"); !load.is_null())
      record.forces.magnetic = {point_of(load.at("force_N")), point_of(load.at("moment_N_mm")),
                                point_of(load.at("center_mm"))};
  if (json.contains("fibres")) record.forces.fibres = fibres_of(json.at("fibres"));
  if (json.contains("layers")) record.forces.layers = layers_of(json.at("layers"));
  if (json.contains("eyelets_mm")) record.eyelets = json.at("eyelets_mm").get<std::vector<double>>();
  if (!model.contact.any()) return;
  if (const Json& contacts = json.at("contacts"); !contacts.is_null())
    record.forces.contacts = contacts_of(model, contacts);
  if (model.contact.has_friction()) record.physical.friction_change = number_or_nan(json.at("friction_change"));
  if (json.contains("anchors")) record.anchors = anchors_of(model, json.at("anchors"));
}

}  // namespace softkin::runs
