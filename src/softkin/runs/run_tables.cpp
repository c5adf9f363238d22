#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/chamber_json.hpp>
#include <softkin/runs/run_tables.hpp>

namespace softkin::runs {

namespace {

/// Of a file.
void add_command_columns(const Model& model, Table& table) {
  for (const Actuator& actuator : model.actuators) table.columns.push_back({command_column(actuator)});
}

void add_values(const Actuation& values, Row& row) {
  row.insert(row.end(), values.begin(), values.end());
}

bool has_times(const MarkerPath& path) {
  return path.waypoints.front().time.has_value();
}

constexpr std::size_t longest_name = 24, longest_command_name = 16, load_width = 12;
constexpr int value_decimals = 4;                         // of commands, ratios and loads
constexpr int place_decimals = 4, friction_decimals = 6;  // of a walk
constexpr int turn_decimals = 2;                          // [degrees]
constexpr std::size_t turn_width = 8;

Column fixed(const std::string& title, int decimals, std::size_t width) {
  return {.title = title, .digits = decimals, .form = Column::Form::decimals, .width = width};
}

Column words(const std::string& title, std::size_t width = 0) {
  return {.title = title, .width = width};
}

Column last(const std::string& title) {
  return {.title = title, .left = true};
}

constexpr std::size_t command_width = 9;  // of what is no drive

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

/// Of a column that holds the actuator's range.
std::size_t width_of(const Actuator& actuator) {
  return std::max(decimal(actuator.high, value_decimals).size(), decimal(actuator.low, value_decimals).size());
}

/// "pressure [kPa]", "tension [N]" or "voltage [kV]" where the robot answers with one, else "".
std::string load_title(const Model& model, const Actuator& actuator) {
  return model.formulation == Formulation::physical ? multiplier_title(actuator) : "";
}

/// Of what the command comes to: "achieved [-]" of a ratio, else what the load does: "volume ratio [-]".
std::string measure_title(const Actuator& actuator) {
  if (flat_at_rest(actuator)) return "volume [mL]";
  return (answers_with_measure(actuator) ? std::string(measure_name(actuator)) + " ratio" : "achieved") + " [-]";
}

Cell turn_cell(const StepRecord& record, std::size_t marker) {
  const bool known = marker < record.marker_turns.size() && std::isfinite(record.marker_turns[marker]);
  return known ? Cell(record.marker_turns[marker]) : Cell();
}

/// Six significant digits of the robot's size [mm].
int length_decimals(const Model& model) {
  return std::clamp(5 - static_cast<int>(std::floor(std::log10(model.diagonal_mm))), 1, 9);
}

std::size_t length_width(const Model& model) {
  const double farthest = model.rest.cwiseAbs().maxCoeff() + model.diagonal_mm;
  return std::max<std::size_t>(8, decimal(-farthest, length_decimals(model)).size());
}

std::string point_text(const Vec3& point, int decimals, std::size_t width) {
  std::string text;
  for (const double x : point) {
    const std::string value = decimal(x, decimals);
    text += (text.empty() ? "" : " ") + std::string(value.size() < width ? width - value.size() : 0, ' ') + value;
  }
  return text;
}

/// The title of a command on the surroundings begins with "command", so that it differs from that of a contact force.
std::string command_title(const Actuator& actuator, const std::string& name) {
  return (drives(actuator) ? "" : "command ") + name + " " + bracketed_unit(actuator);
}

void add_commands(const Model& model, Table& table) {
  for (const Actuator& actuator : model.actuators) {
    const bool named = characters(actuator.name) <= longest_command_name;
    const std::string title = named ? command_title(actuator, actuator.name) : "command " + bracketed_unit(actuator);
    table.columns.push_back(fixed(title, value_decimals, width_of(actuator)));
  }
}

std::string line_title(const Model& model, const MarkerLine& line) {
  const auto name = [&](Index m) { return short_name(model.markers[m].name); };
  return "turn " + name(line.from) + " to " + name(line.to) + " [deg]";
}

/// The sum of the normal forces between a body and all else [N]; none: not known.
Cell contact_cell(const Model& model, const FreeBody& body, const StepRecord& record) {
  if (!record.forces.contacts) return {};
  return normal_force_on(model, body.name, *record.forces.contacts);
}

}  // namespace

Table commands_table(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done) {
  Table table;
  if (has_times(path)) table.columns.push_back({"t_s"});
  add_command_columns(model, table);
  for (const WaypointRecord& each : done) {
    Row row;
    if (each.time_s) row.emplace_back(*each.time_s);
    add_values(each.actuation, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table errors_table(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done) {
  Table table{{{"waypoint"}}};
  if (has_times(path)) table.columns.push_back({"t_s"});
  for (std::size_t m = 0; m < path.markers.size(); ++m) {
    const std::string& name = model.markers[path.markers[m]].name;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (path.axes[m][axis]) table.columns.push_back({name + "_target_" + axis_names[axis] + "_mm"});
    for (const char* axis : axis_names) table.columns.push_back({name + "_" + axis + "_mm"});
  }
  for (const char* key : {"command_change", "step_mm", "error_mm", "reached", "inserted", "equilibria"})
    table.columns.push_back({key});
  for (std::size_t i = 0; i < done.size(); ++i) {
    Row row{static_cast<std::int64_t>(i)};
    if (done[i].time_s) row.emplace_back(*done[i].time_s);
    for (std::size_t m = 0; m < path.markers.size(); ++m) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (path.axes[m][axis]) row.emplace_back(done[i].requested.targets[m][axis]);
      for (const double x : done[i].markers[path.markers[m]]) row.emplace_back(x);
    }
    row.insert(row.end(),
               {done[i].command_change, done[i].step_mm, done[i].error_mm, std::int64_t{done[i].is_reached()},
                std::int64_t{done[i].requested.inserted}, std::int64_t{done[i].equilibria}});
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string sliding_text(const Model& model, Sliding sliding) {
  switch (sliding) {
    case Sliding::none:
      return "-";
    case Sliding::rear:
      return foot_name(model, 0);
    case Sliding::front:
      return foot_name(model, 1);
    case Sliding::both:
      break;
  }
  return foot_name(model, 0) + " and " + foot_name(model, 1);
}

Table walk_table(const Model& model, const std::vector<WalkRecord>& steps) {
  const bool timed = steps.front().time_s.has_value(), physical = model.formulation == Formulation::physical;
  Table table{{{"cycle"}}};
  if (timed) table.columns.push_back({"t_s"});
  add_command_columns(model, table);
  for (std::size_t foot = 0; foot < 2; ++foot) table.columns.push_back({foot_name(model, foot) + "_mm"});
  table.columns.push_back({"travel_mm"});
  if (physical) table.columns.push_back({"friction_N"});
  table.columns.push_back({"sliding"});
  for (const WalkRecord& step : steps) {
    Row row{static_cast<std::int64_t>(step.cycle)};
    if (timed) row.emplace_back(*step.time_s);
    add_values(step.actuation, row);
    row.insert(row.end(), {step.walk.rear_mm, step.walk.front_mm, step.walk.travel_mm});
    if (physical) row.emplace_back(step.walk.friction_N);
    row.emplace_back(sliding_text(model, step.walk.sliding));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<double> strides(const std::vector<WalkRecord>& steps, std::size_t cycles) {
  std::vector<double> lengths;
  double before = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::size_t cycle = steps[i].cycle;
    const bool last = i + 1 < steps.size() ? steps[i + 1].cycle > cycle : cycle == cycles;
    if (!last || cycle == 0) continue;
    lengths.push_back(steps[i].walk.travel_mm - before);
    before = steps[i].walk.travel_mm;
  }
  return lengths;
}

Table table_of_steps(const Model& model, std::size_t steps, const std::optional<MarkerLine>& line) {
  Table table{{words("step", std::to_string(steps).size())}};
  const auto add = [&table](const Column& column) { table.columns.push_back(column); };
  for (const Actuator& actuator : model.actuators) {
    const std::size_t width = drives(actuator) ? width_of(actuator) : command_width;
    add(fixed(command_title(actuator, short_name(actuator.name)), value_decimals, width));
    if (!has_measure(actuator)) continue;
    add(fixed(measure_title(actuator), value_decimals, width));
    if (const std::string load = load_title(model, actuator); !load.empty())
      add(fixed(load, value_decimals, load_width));
    if (filling_of(actuator)) add(fixed("volume [mL]", value_decimals, load_width));
    for (const ConnectedChamber& chamber : connected_chambers(actuator))
      add(fixed(short_name(chamber.region) + " [mL]", value_decimals, load_width));
    if (actuator.curve)
      add(fixed("by curve [" + std::string(unit_of_input(actuator.curve->input) + 1) + "]", value_decimals,
                load_width));
  }
  const std::vector<bool> oriented = oriented_markers(model);
  for (std::size_t m = 0; m < model.markers.size(); ++m) {
    add(words(short_name(model.markers[m].name) + " x, y, z [mm]", 3 * length_width(model) + 2));
    if (oriented[m]) add(fixed(short_name(model.markers[m].name) + " turned [deg]", turn_decimals, turn_width));
  }
  if (line) add(fixed(line_title(model, *line), turn_decimals, turn_width));
  if (model.contact.any())
    for (const FreeBody& body : model.bodies)
      add(fixed("contact on " + short_name(body.name) + " [N]", value_decimals, load_width));
  add(words("iterations"));
  add(fixed("time [s]", 2, 8));
  add(last("status"));
  return table;
}

Row row_of(const Model& model, std::size_t step, const StepRecord& record, std::optional<double> turn) {
  Row row{static_cast<std::int64_t>(step)};
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const ActuatorRecord& of = record.actuators[a];
    row.emplace_back(of.requested);
    if (!has_measure(actuator)) continue;
    row.emplace_back(of.achieved);
    if (!load_title(model, actuator).empty()) row.push_back(of.slack ? Cell("slack") : Cell(of.multiplier));
    if (filling_of(actuator)) row.emplace_back(volume_mL(actuator, of));
    for (const double volume : of.volumes_mL) row.emplace_back(volume);
    if (actuator.curve) row.push_back(of.by_curve ? Cell(*of.by_curve) : Cell("outside"));
  }
  const std::vector<bool> oriented = oriented_markers(model);
  for (std::size_t m = 0; m < record.markers.size(); ++m) {
    row.emplace_back(point_text(record.markers[m], length_decimals(model), length_width(model)));
    if (oriented[m]) row.push_back(turn_cell(record, m));
  }
  if (turn) row.emplace_back(*turn);
  if (model.contact.any())
    for (const FreeBody& body : model.bodies) row.push_back(contact_cell(model, body, record));
  row.push_back(record.answered() ? Cell("-") : Cell(std::int64_t{record.iterations}));
  row.insert(row.end(), {record.seconds, name_of(record.status)});
  if (record.physical.unstable_modes > 0) row.back() = std::string(name_of(record.status)) + ", unstable";
  return row;
}

Table table_of_waypoints(const Model& model, std::size_t waypoints, const std::optional<MarkerLine>& line) {
  Table table{{words("waypoint", std::to_string(waypoints).size())}};
  add_commands(model, table);
  for (const Actuator& actuator : model.actuators)
    if (shows_measure(actuator))
      table.columns.push_back(
          fixed(short_name(actuator.name) + " " + measure_title(actuator), value_decimals, command_width));
  if (line) table.columns.push_back(fixed(line_title(model, *line), turn_decimals, turn_width));
  table.columns.insert(
      table.columns.end(),
      {{.title = "error [mm]", .digits = 2}, words("equilibria"), fixed("time [s]", 2, 8), last("status")});
  return table;
}

Row row_of(const Model& model, std::size_t waypoint, const WaypointRecord& record, std::optional<double> turn) {
  Row row{static_cast<std::int64_t>(waypoint)};
  add_values(record.actuation, row);
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (shows_measure(model.actuators[a])) row.emplace_back(record.actuators[a].achieved);
  if (turn) row.emplace_back(*turn);
  row.insert(row.end(), {record.error_mm, std::int64_t{record.equilibria}, record.seconds, name_of(record.end)});
  if (record.physical.unstable_modes > 0) row.back() = std::string(name_of(record.end)) + ", unstable";
  return row;
}

Table table_of_walk(const Model& model) {
  Table table{{words("cycle"), {.title = "t [s]", .width = 7}}};
  add_commands(model, table);
  const auto add = [&table](const Column& column) { table.columns.push_back(column); };
  for (std::size_t foot = 0; foot < 2; ++foot) add(fixed(foot_name(model, foot) + " [mm]", place_decimals, 10));
  add(fixed("travel [mm]", place_decimals, 10));
  if (model.formulation == Formulation::physical) add(fixed("friction [N]", friction_decimals, 12));
  add(last("slides"));
  return table;
}

Row row_of(const Model& model, const WalkRecord& record) {
  Row row{static_cast<std::int64_t>(record.cycle), record.time_s ? Cell(*record.time_s) : Cell("-")};
  add_values(record.actuation, row);
  row.insert(row.end(), {record.walk.rear_mm, record.walk.front_mm, record.walk.travel_mm});
  if (model.formulation == Formulation::physical) row.emplace_back(record.walk.friction_N);
  row.emplace_back(sliding_text(model, record.walk.sliding) + (record.physical.unstable_modes > 0 ? ", unstable" : ""));
  return row;
}

Table table_of_traces(const std::vector<std::vector<TracedStep>>& paths) {
  Table table;
  table.columns = {{.key = "shape"},          {.key = "along"},        {.key = "from"},         {.key = "to"},
                   {.key = "length"},         {.key = "predicted_mm"}, {.key = "corrected_mm"}, {.key = "iterations"},
                   {.key = "factorisations"}, {.key = "in_double"},    {.key = "projections"},  {.key = "shifts"},
                   {.key = "taken"},          {.key = "why"}};
  for (std::size_t shape = 0; shape < paths.size(); ++shape)
    for (const TracedStep& step : paths[shape])
      table.rows.push_back({std::int64_t(shape), step.along, step.from, step.to, step.length, step.predicted_mm,
                            step.corrected_mm, std::int64_t(step.iterations), std::int64_t(step.factorisations),
                            std::int64_t(step.factorisations_in_double), std::int64_t(step.projections),
                            std::int64_t(step.shifts), std::int64_t(step.taken), step.why});
  return table;
}

Table table_of_pulls() {
  Table table;
  table.columns = {{.key = "direction", .title = "pull along", .width = 18, .left = true},
                   {.key = "force_N", .title = "largest", .unit = "N", .digits = 4},
                   {.key = "moved_mm", .title = "moved", .unit = "mm", .digits = 3},
                   {.key = "normal_N", .title = "pressed", .unit = "N", .digits = 4},
                   {.key = "slipping", .title = "slips", .unit = "-", .digits = 3},
                   {.key = "end", .title = "then", .left = true}};
  return table;
}

Row row_of(const Pull& pull) {
  Row row{pull.direction.name, pull.force_N, pull.moved_mm, pull.pressed.normal_N};
  row.emplace_back(pull.pressed.slipping ? Cell(*pull.pressed.slipping) : Cell());
  row.emplace_back(what_then(pull));
  return row;
}

}  // namespace softkin::runs
