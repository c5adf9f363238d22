#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/runs/reach.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/workspace_file.hpp>
#include <utility>

namespace softkin::runs {

namespace {

const char* hull_name(HullShape shape) {
  constexpr std::array<const char*, 4> names{"solid", "flat", "line", "point"};
  return names[static_cast<std::size_t>(shape)];
}

/// The axes that a picture shows, the wider across; the three pairs, or one where the third axis shows nothing.
std::vector<std::array<int, 2>> views_of(const Points& positions) {
  const Vec3 extents = (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).transpose();
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return extents[a] > extents[b]; });
  constexpr double too_thin = 0.02;
  if (extents[order[2]] < too_thin * extents[order[0]])
    return {{std::min(order[0], order[1]), std::max(order[0], order[1])}};
  return {{0, 2}, {1, 2}, {0, 1}};
}

}  // namespace

Index shown_marker(const Model& model, const std::string& name) {
  if (model.markers.empty())
    throw InvalidInput("the robot has no marker, so there is nothing whose reach could be told: add one to the scene");
  if (name.empty()) return 0;
  std::vector<std::string> names;
  for (std::size_t p = 0; p < model.markers.size(); ++p) {
    if (model.markers[p].name == name) return static_cast<Index>(p);
    names.push_back(model.markers[p].name);
  }
  throw InvalidInput("--marker " + excerpt(name) + ": there is no such marker" + suggest_name(name, names));
}

Reach reach_of(const Model& model, std::vector<WorkspaceSample> samples, const std::string& marker, bool with_hull) {
  const Index shown = shown_marker(model, marker);
  Reach reach{model.markers[static_cast<std::size_t>(shown)].name, {}, {}};
  for (WorkspaceSample& sample : samples)
    if (sample.status == Status::converged) reach.samples.push_back(std::move(sample));
  reach.positions.resize(static_cast<Index>(reach.samples.size()), 3);
  for (std::size_t i = 0; i < reach.samples.size(); ++i)
    reach.positions.row(static_cast<Index>(i)) = reach.samples[i].markers.row(shown);
  if (with_hull && !reach.samples.empty()) reach.hull = convex_hull(reach.positions);
  return reach;
}

void write_cloud(const std::filesystem::path& path, const Model& model, const Reach& reach) {
  const WorkspaceColumns columns = workspace_columns(model);
  VtuContent content;
  content.points = reach.positions;
  content.cloud = true;
  const auto add = [&](const std::string& name, const auto& value) {
    Field field{name, 1, {}};
    for (const WorkspaceSample& sample : reach.samples) field.values.push_back(value(sample));
    content.point_fields.push_back(std::move(field));
  };
  add("sample", [](const WorkspaceSample& sample) { return sample.number; });
  for (std::size_t a = 0; a < columns.actuators.size(); ++a)
    add(columns.actuators[a], [a](const WorkspaceSample& s) { return s.actuation[static_cast<Index>(a)]; });
  for (std::size_t i = 0; i < columns.loads.size(); ++i)
    add(columns.loads[i], [a = columns.loaded[i]](const WorkspaceSample& s) { return s.multipliers[a]; });
  add("iterations", [](const WorkspaceSample& sample) { return sample.iterations; });
  write_vtu(path, content);
}

void write_hull(const std::filesystem::path& path, const Hull& hull) {
  if (lower_extension(path) == ".stl") return write_stl(path, hull.vertices, hull.triangles);
  VtuContent content;
  content.points = hull.vertices;
  content.triangles = hull.triangles;
  write_vtu(path, content);
}

Plot plot_of_reach(const Reach& reach) {
  Plot plot;
  plot.title = "Reach of " + reach.marker + ": " + counted(reach.samples.size(), "sample");
  std::vector<PlotPanel> row;
  for (const auto& [across, up] : views_of(reach.positions)) {
    PlotPanel panel;
    panel.x.label = std::string(axis_names[across]) + " [mm]";
    panel.y.label = std::string(axis_names[up]) + " [mm]";
    panel.equal = true;
    PlotSeries series;
    series.line = false;
    series.mark_radius = reach.samples.size() > 1000 ? 1 : 2;
    for (Index i = 0; i < reach.positions.rows(); ++i) {
      series.x.push_back(reach.positions(i, across));
      series.y.push_back(reach.positions(i, up));
    }
    panel.series.push_back(std::move(series));
    row.push_back(std::move(panel));
  }
  plot.panel_height = row.size() == 1 ? 500 : 260;
  plot.rows.push_back(std::move(row));
  return plot;
}

std::string workspace_summary(const std::string& scene, const WorkspaceHead& head, const Reach& reach,
                              const std::vector<std::pair<std::string, Index>>& counts, double seconds) {
  Json json = {{"softkin", SOFTKIN_VERSION}, {"scene", scene}};
  for (const auto& [key, value] : head)
    if (key == "robot" || key == "solver" || key == "sampling") json[key] = value;
  for (const auto& [key, count] : counts) json[key] = count;
  json["marker"] = reach.marker;
  if (!reach.samples.empty())
    for (int axis = 0; axis < 3; ++axis)
      json["reach_mm"][axis_names[axis]] = {reach.positions.col(axis).minCoeff(), reach.positions.col(axis).maxCoeff()};
  if (const auto& hull = reach.hull)
    json["hull"] = {{"shape", hull_name(hull->shape)},
                    {"volume_mm3", hull->volume},
                    {"area_mm2", hull->area},
                    {"extents_mm", {hull->extents[0], hull->extents[1], hull->extents[2]}}};
  json["seconds"] = seconds;
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace softkin::runs
