#include <nlohmann/json.hpp>
#include <softkin/model/fingerprint.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/report_head.hpp>

namespace softkin::runs {

namespace {

Json elastic_json(const ElasticLaw& e) {
  switch (e.law) {
    case Law::mooney_rivlin:
      return {{"c10_MPa", e.c10}, {"c01_MPa", e.c01}, {"bulk_modulus_MPa", e.bulk}};
    case Law::yeoh:
      return {{"c10_MPa", e.c10}, {"c20_MPa", e.c20}, {"c30_MPa", e.c30}, {"bulk_modulus_MPa", e.bulk}};
    case Law::st_venant_kirchhoff:
    case Law::corotational:
    case Law::neo_hookean:
      break;
  }
  return {{"mu_MPa", e.mu}, {"lambda_MPa", e.lambda}};
}

Json materials_json(const Model& model) {
  Json materials = Json::array();
  for (const Material& material : model.materials) {
    Json json = {{"region", material.region}};
    if (model.formulation == Formulation::physical) {
      json["law"] = law_name(material.elastic.law);
      json.update(elastic_json(material.elastic));
      json["density_kg_m3"] = material.density;
    } else {
      json["shape_ratio"] = material.shape_ratio;
      json["weight"] = material.weight;
    }
    materials.push_back(json);
  }
  return materials;
}

Json actuators_json(const Model& model) {
  Json actuators = Json::object();
  for (const Actuator& actuator : model.actuators) {
    const std::string unit = command_unit(actuator);
    actuators[actuator.name] = {{"kind", kind_name(actuator)},
                                {"control", control_name(actuator)},
                                {"unit", unit.empty() ? "ratio to rest" : unit},
                                {"range", {actuator.low, actuator.high}}};
    if (actuator.curve)
      actuators[actuator.name]["curve"] = {{"file", actuator.curve->file}, {"branch", branch_name(actuator.branch)}};
  }
  return actuators;
}

Json units_json(const Model& model) {
  const bool physical = model.formulation == Formulation::physical;
  return {{"markers", "mm"},
          {"requested", "the unit of each actuator"},
          {"achieved", "ratio to rest"},
          {"strain", "stretch minus 1"},
          {"energy", physical ? "mJ" : "mm^5"},
          {"residual", physical ? "N" : "mm^4"}};
}

Json solver_json(const StaticsOptions& options) {
  Json json = {{"name", name_of(options.solver)},
               {"tolerance_mm", options.step_tolerance_mm},
               {"max_iterations", options.max_iterations}};
  if (options.solver == Solver::local_global) json["anderson"] = options.anderson;
  return json;
}

Json head_json(const Model& model, const std::string& scene, const StaticsOptions& options) {
  return {{"softkin", SOFTKIN_VERSION},
          {"scene", scene},
          {"robot_fingerprint", fingerprint_of(model)},
          {"formulation", formulation_name(model.formulation)},
          {"materials", materials_json(model)},
          {"actuators", actuators_json(model)},
          {"solver", solver_json(options)},
          {"units", units_json(model)},
          {"mesh",
           {{"order", model.edge_nodes.empty() ? 1 : 2},
            {"vertices", model.rest.rows()},
            {"tetrahedra", model.tetrahedra.size()},
            {"prisms", model.prisms.size()}}},
          {"notes", model.notes}};
}

}  // namespace

std::string report_head(const Model& model, const std::string& scene, const StaticsOptions& options) {
  return line_of(head_json(model, scene, options));
}

std::string follow_head(const Model& model, const std::string& scene, const TrajectoryOptions& options) {
  Json head = head_json(model, scene, options.inverse.statics);
  head["follow"] = {{"method", name_of(options.inverse.method)},
                    {"tolerance_mm", options.inverse.tolerance_mm},
                    {"max_iterations", options.inverse.max_iterations}};
  return line_of(head);
}

std::string walk_head(const Model& model, const std::string& scene, const StaticsOptions& options,
                      const std::string& gait, std::size_t cycles, const Vec3& direction) {
  Json head = head_json(model, scene, options);
  head["walk"] = {{"gait", gait}, {"cycles", cycles}, {"direction", {direction[0], direction[1], direction[2]}}};
  Json& feet = head["feet"] = Json::array();
  for (std::size_t i = 0; i < model.feet.size(); ++i)
    feet.push_back({{"marker", foot_name(model, i)},
                    {"forward_N", model.feet[i].forward},
                    {"backward_N", model.feet[i].backward}});
  return line_of(head);
}

}  // namespace softkin::runs
