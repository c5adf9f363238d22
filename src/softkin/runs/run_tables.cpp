#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/run_tables.hpp>

namespace softkin::runs {

namespace {

void add_commands(const Model& model, Table& table) {
  for (const Actuator& actuator : model.actuators) table.columns.push_back({command_column(actuator)});
}

void add_values(const Actuation& values, Row& row) {
  row.insert(row.end(), values.begin(), values.end());
}

bool has_times(const MarkerPath& path) {
  return path.waypoints.front().time.has_value();
}

}  // namespace

Table commands_table(const Model& model, const MarkerPath& path, const std::vector<WaypointRecord>& done) {
  Table table;
  if (has_times(path)) table.columns.push_back({"t_s"});
  add_commands(model, table);
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
    const std::string& name = model.markers[static_cast<std::size_t>(path.markers[m])].name;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (path.axes[m][axis]) table.columns.push_back({name + "_target_" + axis_names[axis] + "_mm"});
    for (const char* axis : axis_names) table.columns.push_back({name + "_" + axis + "_mm"});
  }
  for (const char* key : {"error_mm", "reached", "inserted", "equilibria"}) table.columns.push_back({key});
  for (std::size_t i = 0; i < done.size(); ++i) {
    Row row{static_cast<std::int64_t>(i)};
    if (done[i].time_s) row.emplace_back(*done[i].time_s);
    for (std::size_t m = 0; m < path.markers.size(); ++m) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (path.axes[m][axis]) row.emplace_back(done[i].asked.targets[m][static_cast<Index>(axis)]);
      for (const double x : done[i].markers[static_cast<std::size_t>(path.markers[m])]) row.emplace_back(x);
    }
    row.insert(row.end(), {done[i].error_mm, std::int64_t{done[i].is_reached()}, std::int64_t{done[i].asked.inserted},
                           std::int64_t{done[i].equilibria}});
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
  add_commands(model, table);
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
    const bool ends = i + 1 < steps.size() ? steps[i + 1].cycle > cycle : cycle == cycles;
    if (!ends || cycle == 0) continue;
    lengths.push_back(steps[i].walk.travel_mm - before);
    before = steps[i].walk.travel_mm;
  }
  return lengths;
}

}  // namespace softkin::runs
