#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/target.hpp>
#include <softkin/drive/use.hpp>
#include <softkin/kinematics/jacobian.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/named_material.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/contacts_json.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/reports.hpp>

namespace softkin::runs {

namespace {

Json ogden_json(const ElasticLaw& e) {
  Json json = Json::object();
  for (int p = 0; p < max_ogden_terms; ++p) {
    if (e.ogden[p].alpha == 0) continue;
    json["mu" + std::to_string(p + 1) + "_MPa"] = e.ogden[p].mu;
    json["alpha" + std::to_string(p + 1)] = e.ogden[p].alpha;
  }
  json["bulk_modulus_MPa"] = e.bulk;
  return json;
}

Json elastic_json(const ElasticLaw& e) {
  switch (e.law) {
    case Law::mooney_rivlin:
      return {{"c10_MPa", e.c10}, {"c01_MPa", e.c01}, {"bulk_modulus_MPa", e.bulk}};
    case Law::yeoh:
      return {{"c10_MPa", e.c10}, {"c20_MPa", e.c20}, {"c30_MPa", e.c30}, {"bulk_modulus_MPa", e.bulk}};
    case Law::gent:
      return {{"mu_MPa", e.mu}, {"jm", e.jm}, {"bulk_modulus_MPa", e.bulk}};
    case Law::ogden:
      return ogden_json(e);
    case Law::st_venant_kirchhoff:
    case Law::corotational:
    case Law::neo_hookean:
      break;
  }
  return {{"mu_MPa", e.mu}, {"lambda_MPa", e.lambda}};
}

Json named_json(const NamedMaterial& named) {
  Json json{{"name", named.name}, {"set", named.set}, {"source", named.source}};
  for (const NamedMaterial::Set& set : named.sets) json["youngs_modulus_MPa"][set.name] = set.youngs_modulus_MPa;
  return json;
}

Json materials_json(const Model& model) {
  Json materials = Json::array();
  for (const Material& material : model.elements.materials) {
    Json json = {{"region", material.region}};
    if (model.formulation == Formulation::physical) {
      json["law"] = law_name(material.elastic.law);
      json.update(elastic_json(material.elastic));
      if (material.named) json["material"] = named_json(*material.named);
      json["density_kg_m3"] = material.density;
      for (const ViscousBranch& branch : material.viscosity)
        json["viscosity"].push_back({{"modulus_MPa", branch.modulus_MPa}, {"time_s", branch.time_s}});
      if (std::any_of(model.actuators.begin(), model.actuators.end(), under_voltage))
        json["permittivity"] = material.permittivity;
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
  const bool printed = model.weights == ElementWeights::printed;
  return {{"markers", "mm"},
          {"requested", "the unit of each actuator"},
          {"achieved", "ratio to rest"},
          {"strain", "stretch minus 1"},
          {"energy", physical  ? "mJ"
                     : printed ? "mm^5"
                               : "mm^3"},
          {"residual", physical  ? "N"
                       : printed ? "mm^4"
                                 : "mm^2"}};
}

/// What is known of the errors of a map.
Json map_json(const UsedMap& map) {
  const MapCheck& check = map.data.check;
  Json json = {{"file", map.file},
               {"equilibria", map.data.equilibria},
               {"checked", {{"points", check.points}, {"outside", check.outside}, {"seed", check.seed}}}};
  for (std::size_t q = 0; q < map.data.outputs.size(); ++q) {
    const MapOutput& output = map.data.outputs[q];
    json["largest_error"][output.name + (output.unit.empty() ? "" : "_" + output.unit)] = check.largest[q];
  }
  if (map.data.shape) json["largest_error"]["shape_mm"] = check.shape_largest_mm;
  return json;
}

Json solver_json(const StaticsOptions& options, const UsedMap* map) {
  if (map != nullptr && !map->polished) return {{"name", "map"}, {"map", map_json(*map)}};
  Json json = {{"name", name_of(options.solver)},
               {"tolerance_mm", options.step_tolerance_mm},
               {"max_iterations", options.iteration_limit()}};
  if (options.solver == Solver::local_global) json["anderson"] = options.anderson;
  if (options.as_published) json["as_published"] = true;
  if (options.stable) json["stable"] = true;
  if (options.beyond > 0) json["beyond"] = options.beyond;
  for (const OptionValue& option : changed_options(options.tuning))
    json["options"][option.group][option.field.name] = option.value;
  if (map != nullptr) json["begun_from_map"] = map_json(*map);
  return json;
}

Json head_json(const Model& model, const std::string& scene, const StaticsOptions& options,
               const UsedMap* map = nullptr) {
  Json json = {{"softkin", SOFTKIN_VERSION},
               {"instruction_set", name_of(target())},
               {"scene", scene},
               {"robot_fingerprint", fingerprint_of(model)},
               {"formulation", formulation_name(model.formulation)},
               {"materials", materials_json(model)},
               {"actuators", actuators_json(model)},
               {"solver", solver_json(options, map)},
               {"units", units_json(model)},
               {"mesh",
                {{"order", order_of(model)},
                 {"vertices", model.robot_vertices()},
                 {"tetrahedra", model.elements.tetrahedra.size()},
                 {"prisms", model.elements.prisms.size()}}},
               {"notes", model.notes},
               {"warnings", model.warnings}};
  if (model.weights != ElementWeights::printed) json["weights"] = weights_name(model.weights);
  return json;
}

/// null where a component does not count.
Json counted_json(const Vec3& vector, const std::array<bool, 3>& axes) {
  Json json = Json::array();
  for (int axis = 0; axis < 3; ++axis) json.push_back(axes[axis] ? Json(vector[axis]) : Json());
  return json;
}

Json requested_json(const Goal& goal) {
  if (const auto* position = std::get_if<PositionGoal>(&goal.what))
    return {{"kind", "target"}, {"target_mm", counted_json(position->target, position->axes)}};
  if (const auto* force = std::get_if<ForceGoal>(&goal.what))
    return {{"kind", "force"}, {"force_N", counted_json(force->force, force->axes)}, {"mm_per_N", force->mm_per_N}};
  if (const auto* plane = std::get_if<PlaneGoal>(&goal.what))
    return {{"kind", "plane"}, {"point_mm", json_of(plane->point)}, {"normal", json_of(plane->normal)}};
  const auto& direction = std::get<DirectionGoal>(goal.what);
  return {{"kind", "direction"}, {"direction", json_of(direction.direction)}, {"lever_mm", direction.lever_mm}};
}

Json goals_json(const Model& model, const std::vector<NamedGoal>& goals, const InverseResult& found,
                const InverseRecord& record) {
  Json all = Json::array();
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const Goal& goal = goals[i].goal;
    Json json = {{"of", goals[i].name}};
    json.update(requested_json(goal));
    const bool direction = std::holds_alternative<DirectionGoal>(goal.what);
    const bool force = std::holds_alternative<ForceGoal>(goal.what);
    json[force       ? "found_N"
         : direction ? "found"
                     : "found_mm"] = json_of(found_of(model, goal, found.equilibrium.state.positions, record));
    json["weight"] = goal.weight;
    json[force ? "error_N" : "error_mm"] = own_error(goal, found.errors_mm[i]);
    all.push_back(json);
  }
  return all;
}

std::string unit_of(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return unit.empty() ? "unit of ratio" : unit;
}

/// Of every marker and every pressure and tension, by the command of every actuator, each with its unit.
Json jacobian_json(const Model& model, const Points& positions, const Sensitivity& sensitivity) {
  Json json = {{"unit", Json::object()}, {"markers", Json::object()}};
  std::vector<Index> markers;
  for (std::size_t p = 0; p < model.markers.size(); ++p) markers.push_back(p);
  const Eigen::MatrixXd slopes = jacobian(model, positions, sensitivity, markers);
  for (const Actuator& actuator : model.actuators) json["unit"][actuator.name] = "mm per " + unit_of(actuator);
  for (std::size_t p = 0; p < markers.size(); ++p)
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      json["markers"][model.markers[p].name][model.actuators[a].name] = json_of(slopes.block<3, 1>(3 * p, a));
  if (model.formulation != Formulation::physical) return json;
  for (std::size_t i = 0; i < model.actuators.size(); ++i) {
    const std::string key = multiplier_key(model.actuators[i]);
    if (key.empty()) continue;
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      json[key][model.actuators[i].name][model.actuators[a].name] = sensitivity.multipliers(i, a);
  }
  return json;
}

/// Every equilibrium of the search.
Json history_json(const std::vector<InverseTrial>& history) {
  Json json = {{"error_mm", Json::array()}, {"iterations", Json::array()}};
  for (const InverseTrial& record : history) {
    json["error_mm"].push_back(known(record.error_mm));
    json["iterations"].push_back(record.iterations);
  }
  return json;
}

Json inverse_json(const Model& model, const InverseAnswer& answer) {
  const auto& [options, goals, found, record] = answer;
  const bool newton = options.method == InverseMethod::newton;
  Json json = {{"method", name_of(options.method)},
               {"tolerance_mm", options.tolerance_mm},
               {"status", name_of(found.status)},
               {"reached", found.status == InverseStatus::reached},
               {"remark", found.remark},
               {"goals", goals_json(model, goals, found, record)},
               {"at_end_of_range", Json::object()},
               {"iterations", found.iterations},
               {"equilibria", found.equilibria},
               {"seconds", found.seconds}};
  if (record.misses.mm) json["error_mm"] = *record.misses.mm;
  if (record.misses.N) json["error_N"] = *record.misses.N;
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (found.active[a] != 0) json["at_end_of_range"][model.actuators[a].name] = found.active[a] < 0 ? "low" : "high";
  if (newton && found.status != InverseStatus::reached) json["slope_mm_per_range"] = found.slope;
  if (newton && found.sensitivity.regular) {
    json["jacobian"] = jacobian_json(model, found.equilibrium.state.positions, found.sensitivity);
    if (model.contact.any()) json["jacobian"]["one_sided"] = sliding_pairs(model, record.forces.contacts);
  }
  json["history"] = history_json(found.history);
  return json;
}

Json tendon_json(const drive::Plan& plan, std::size_t index) {
  const drive::Tendon& tendon = plan.machine.tendons[index];
  const drive::TendonUse use = drive::use_of(plan, index);
  return {{"axis", std::string(1, tendon.axis)},
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

Json syringe_json(const drive::Plan& plan, std::size_t index, bool whole) {
  const drive::Syringe& syringe = plan.machine.syringes[index];
  const drive::SyringeUse use = drive::use_of_syringe(plan, index);
  Json json = {{"axis", std::string(1, syringe.axis)},
               {"chamber_mm3", syringe.air.chamber_mm3},
               {"syringe_mm3", syringe.air.syringe_mm3},
               {"dead_volume_mm3", syringe.air.tube_mm3},
               {"atmosphere_kPa", syringe.air.atmosphere_kPa},
               {"plunger_mm3_per_mm", syringe.mm3_per_mm},
               {"plunger_mm", {use.lowest_mm, use.highest_mm}},
               {"travel_limits_mm", {syringe.lowest_mm, syringe.highest_mm}},
               {"steps", {use.lowest, use.highest}},
               {"speed_mm_per_s", use.fastest_mm_per_s},
               {"max_speed_mm_per_s", syringe.max_speed_mm_per_s},
               {"max_acceleration_mm_per_s2", syringe.max_acceleration_mm_per_s2},
               {"backlash_mm", syringe.backlash_mm},
               {syringe.by_pushed_mL ? "pushed_error_mL" : "ratio_error", use.error}};
  if (!whole) return json;
  for (const drive::PlungerRow& row : drive::plunger_rows(plan, index))
    if (syringe.by_pushed_mL)
      json["rows"].push_back({{"line", row.line},
                              {"pushed_mL", row.ratio},
                              {"plunger_mm", row.plunger_mm},
                              {"volume_mm3", row.volume_mm3}});
    else
      json["rows"].push_back({{"line", row.line},
                              {"ratio", row.ratio},
                              {"pressure_kPa", row.gauge_kpa},
                              {"plunger_mm", row.plunger_mm},
                              {"volume_mm3", row.volume_mm3},
                              {"leads_to", row.reached}});
  return json;
}

Json stream_json(const drive::GcodeProgram& program, const drive::StreamReport& report) {
  Json json = {{"end", drive::name_of(report.end)},
               {"message", report.message},
               {"lines", report.lines},
               {"acknowledged", report.acknowledged},
               {"sent", report.sent},
               {"resends", report.resends},
               {"timeouts", report.timeouts},
               {"position_known", report.position_known}};
  if (report.position_known)
    for (std::size_t i = 0; i < report.position.size(); ++i)
      json["position_mm"][std::string(1, program.axes[i])] = report.position[i];
  return json;
}

}  // namespace

std::string report_head(const Model& model, const std::string& scene, const StaticsOptions& options, const UsedMap* map,
                        const UsedStart* start) {
  Json head = head_json(model, scene, options, map);
  if (start != nullptr) head["start"] = {{"file", start->file}, {"shape_fingerprint", start->fingerprint}};
  return line_of(head);
}

std::string follow_head(const Model& model, const std::string& scene, const TrajectoryOptions& options,
                        const UsedMap* map) {
  Json head = head_json(model, scene, options.inverse.statics, map);
  head["follow"] = {{"method", options.method()},
                    {"tolerance_mm", options.inverse.tolerance_mm},
                    {"max_iterations", options.inverse.max_iterations}};
  return line_of(head);
}

std::string walk_head(const Model& model, const std::string& scene, const StaticsOptions& options,
                      const std::string& gait, std::size_t cycles, const Vec3& direction) {
  Json head = head_json(model, scene, options);
  head["walk"] = {{"gait", gait}, {"cycles", cycles}, {"direction", json_of(direction)}};
  Json& feet = head["feet"] = Json::array();
  for (std::size_t i = 0; i < model.feet.size(); ++i)
    feet.push_back({{"marker", foot_name(model, i)},
                    {"forward_N", model.feet[i].forward},
                    {"backward_N", model.feet[i].backward}});
  return line_of(head);
}

RecordLog step_report(const Model& model, const std::string& scene, const std::filesystem::path& file,
                      const StaticsOptions& options, const StepRecord& record) {
  RecordLog log(model, {file}, report_head(model, scene, options), {});
  log.add(line_of(to_json(model, record)), record.seconds);
  return log;
}

Vec3 found_of(const Model& model, const Goal& goal, const Points& positions, const StepRecord& record) {
  if (const auto* force = std::get_if<ForceGoal>(&goal.what))
    return exerted_force(*force, record.forces.reactions, record.forces.contacts);
  const auto at = [&](Index marker) { return model.markers[marker].at(positions); };
  if (const auto* position = std::get_if<PositionGoal>(&goal.what)) return at(position->marker);
  if (const auto* plane = std::get_if<PlaneGoal>(&goal.what)) return at(plane->marker);
  const auto& direction = std::get<DirectionGoal>(goal.what);
  return (at(direction.to) - at(direction.from)).stableNormalized();
}

InverseRecord inverse_record(const Model& model, const std::vector<Goal>& goals, const InverseResult& found,
                             const ElementDeformation& deformation) {
  InverseRecord record;
  static_cast<StepRecord&>(record) = step_record(model, found.equilibrium, deformation);
  record.self_overlap = OverlapSearch(model).in(found.equilibrium.state.positions);
  record.seconds = found.seconds;
  record.misses = misses_of(goals, found);
  return record;
}

RecordLog inverse_report(const Model& model, const std::string& scene, const std::filesystem::path& file,
                         const InverseAnswer& answer, const UsedMap* map) {
  const InverseRecord& record = answer.record;
  Json head = Json::parse(report_head(model, scene, answer.options.statics, map));
  head["ik"] = inverse_json(model, answer);
  Json step = to_json(model, record);
  if (record.misses.mm) step["error_mm"] = *record.misses.mm;
  if (record.misses.N) step["error_N"] = *record.misses.N;
  RecordLog log(model, {file}, line_of(head), {});
  log.add(line_of(step), record.seconds);
  return log;
}

std::string drive_report(const std::string& scene, const drive::Plan& plan, bool whole,
                         const drive::StreamReport* stream, const UsedMap* map) {
  const drive::Machine& machine = plan.machine;
  Json json = {{"softkin", SOFTKIN_VERSION},
               {"scene", scene},
               {"commands", plan.commands.file},
               {"hardware", machine.file},
               {"defaults", machine.defaults}};
  if (map != nullptr) json["pressures_by_map"] = map_json(*map);
  for (std::size_t i = 0; i < machine.tendons.size(); ++i)
    json["tendons"][machine.tendons[i].name] = tendon_json(plan, i);
  for (std::size_t i = 0; i < machine.syringes.size(); ++i)
    json["syringes"][machine.syringes[i].name] = syringe_json(plan, i, whole);
  for (std::size_t i = 0; i < machine.chambers.size(); ++i) {
    const drive::Chamber& chamber = machine.chambers[i];
    const auto [low, high] = drive::pressure_range(plan, i);
    json["chambers"][chamber.name] = {{"channel", chamber.channel},
                                      {"pressure_kPa", {low, high}},
                                      {"limits_kPa", {chamber.low_kpa, chamber.high_kpa}}};
  }
  json["rows"] = plan.commands.rows.size();
  if (plan.has_motors()) {
    json["approach_s"] = drive::seconds_of(plan.motion.approach);
    json["motion_s"] = plan.motion.seconds;
    json["lines"] = plan.program.lines.size();
    if (whole) json["gcode"] = drive::gcode_text(machine, plan.program);
  }
  if (whole && !machine.chambers.empty()) json["schedule"] = drive::schedule_csv(plan.schedule);
  if (stream != nullptr) json["stream"] = stream_json(plan.program, *stream);
  return json_text(json) + "\n";
}

}  // namespace softkin::runs
