#include <nlohmann/json.hpp>
#include <softkin/runs/drive_report.hpp>

namespace softkin::runs {

namespace {

using Json = nlohmann::ordered_json;

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

std::string drive_report(const std::string& scene, const drive::Plan& plan, bool whole,
                         const drive::StreamReport* stream) {
  const drive::Machine& machine = plan.machine;
  Json json = {{"softkin", SOFTKIN_VERSION},
               {"scene", scene},
               {"commands", plan.commands.file},
               {"hardware", machine.file},
               {"defaults", machine.defaults}};
  for (std::size_t i = 0; i < machine.tendons.size(); ++i)
    json["tendons"][machine.tendons[i].name] = tendon_json(plan, i);
  for (std::size_t i = 0; i < machine.chambers.size(); ++i) {
    const drive::Chamber& chamber = machine.chambers[i];
    const auto [low, high] = drive::pressure_range(plan, i);
    json["chambers"][chamber.name] = {{"channel", chamber.channel},
                                      {"pressure_kPa", {low, high}},
                                      {"limits_kPa", {chamber.low_kpa, chamber.high_kpa}}};
  }
  json["rows"] = plan.commands.rows.size();
  if (!machine.tendons.empty()) {
    json["approach_s"] = drive::seconds_of(plan.motion.approach);
    json["motion_s"] = plan.motion.seconds;
    json["lines"] = plan.program.lines.size();
    if (whole) json["gcode"] = drive::gcode_text(machine, plan.program);
  }
  if (whole && !machine.chambers.empty()) json["schedule"] = drive::schedule_csv(plan.schedule);
  if (stream != nullptr) json["stream"] = stream_json(plan.program, *stream);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace softkin::runs
