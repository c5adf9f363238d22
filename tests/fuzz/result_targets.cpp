#include <softkin/drive/marlin_answer.hpp>
#include <softkin/io/table/measured_poses.hpp>
#include <softkin/io/table/workspace_table.hpp>
#include <softkin/runs/report_comparison.hpp>

#include "fuzz/targets.hpp"
#include "view/reading_lines.hpp"

namespace softkin::fuzz {

namespace {

/// A report beside a second one, or beside itself.
void run_report(const Input& input) {
  const std::string first = input.file("first.json").string();
  const std::string second = input.parts() > 1 ? input.file("second.json", 1).string() : first;
  const runs::ReportedPath path = runs::read_reported_path(first);
  for (const runs::ReportedStep& step : path.steps) {
    require_finite(step.elapsed, "a time is not finite");
    for (const auto& [name, value] : step.actuation) require_finite(value, "a command is not finite");
    for (const auto& [name, place] : step.markers) require(place.allFinite(), "a place is not finite");
  }
  const runs::ReportComparison comparison = runs::compare_reports({first, second}, "", {}, {});
  (void)comparison.json();
  (void)comparison.steps();
  (void)comparison.times();
  (void)comparison.plot();
}

/// A workspace is the same when it is written and read again.
void run_workspace(const Input& input) {
  static const WorkspaceColumns columns{
      {"air", "tendon_N"},
      {"tip_x_mm", "tip_y_mm", "tip_z_mm", "corner_x_mm", "corner_y_mm", "corner_z_mm"},
      {"air_pressure_kPa", "tendon_tension_N"},
      {0, 1}};
  const auto text_of = [](const std::filesystem::path& file) {
    const WorkspaceTable table = read_workspace(file, columns);
    std::string text = workspace_header(table.head, columns);
    for (const WorkspaceSample& sample : table.samples) text += workspace_row(sample, columns);
    return text;
  };
  const std::string text = text_of(input.file("workspace.csv"));
  const Input again(text, input.path(""));
  require(again.parts() > 1 || text_of(again.file("again.csv")) == text, "a written workspace reads otherwise");
}

void run_marlin(const Input& input) {
  const drive::MarlinAnswer answer = drive::parse_answer(input.part(0));
  for (const auto& [letter, place] : answer.position) require_finite(place, "a board is nowhere");
}

void require_commands(const Model& model, const Actuation& commands) {
  require(commands.size() == std::ssize(model.actuators), "other actuators");
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const double value = commands[a];
    require(value >= model.actuators[a].low && value <= model.actuators[a].high, "a command outside its range");
  }
}

void require_readings(const Eigen::VectorXd& values, std::size_t columns) {
  require(values.size() == static_cast<Index>(columns), "other columns");
  for (const double value : values)
    require(std::isnan(value) || std::abs(value) <= view::largest_reading, "a reading that is too large");
}

/// What is streamed to a server: the token, or a line of readings.
void run_reading_line(const Input& input) {
  static const view::LineColumns columns(finger(), possible_readings(finger()), {1}, false);
  if (input.parts() > 1) {
    const std::string token = view::read_token_line(input.part(1));
    require(token.size() <= view::longest_line, "a token longer than its line");
  }
  const view::ReadingsRequest line = view::read_reading_line(input.part(0), columns, 0.0);
  require_commands(finger(), line.commands);
  require_readings(line.values, columns.readings.size());
  require(!line.values.array().isNaN().all(), "no reading at all");
  require(!line.time_s || (*line.time_s > 0 && std::isfinite(*line.time_s)), "a time that does not come after");
  require(line.commands[1] == finger().rest_actuation()[1], "what is told was commanded");
}

/// Reads what a page sends to a server: each refusal has one reason. With a second part the server estimates from
/// readings.
void run_live_message(const Input& input) {
  const Model& model = finger();
  const std::size_t columns = input.parts() > 1 ? 3 : 0;
  const view::ClientMessage message = view::read_client_message(input.part(0), model, columns);
  const auto require_id = [](view::RequestId id) {
    require(id >= 1 && id <= view::RequestId{1} << 53, "a request without a number");
  };
  if (const auto* hello = std::get_if<view::Hello>(&message)) {
    require(hello->secret.size() <= view::longest_message_of(columns), "a secret longer than its message");
    require(!view::same_secret(hello->secret, hello->secret + "x"), "a longer secret is the same");
  } else if (const auto* command = std::get_if<view::CommandRequest>(&message)) {
    require_id(command->id);
    require(columns == 0, "a command where readings are told from");
    require_commands(model, command->commands);
  } else if (const auto* readings = std::get_if<view::ReadingsRequest>(&message)) {
    require_id(readings->id);
    require_commands(model, readings->commands);
    require_readings(readings->values, columns);
  } else if (const auto* target = std::get_if<view::TargetRequest>(&message)) {
    require_id(target->id);
    require(target->marker >= 0 && target->marker < std::ssize(model.markers), "no such marker");
    require(target->at.cwiseAbs().maxCoeff() <= view::farthest_target_mm(model), "a target farther than anything");
  }
}

}  // namespace

std::vector<Target> result_targets() {
  return {{"report", "reports.dict", run_report},
          {"workspace", "tables.dict", run_workspace},
          {"marlin", "marlin.dict", run_marlin},
          {"live_message", "live.dict", run_live_message},
          {"reading_line", "live.dict", run_reading_line}};
}

std::vector<Target> all_targets() {
  std::vector<Target> all;
  for (const auto& some : {mesh_targets(), scene_targets(), table_targets(), result_targets()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace softkin::fuzz
