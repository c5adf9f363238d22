#include "workspace_outputs.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/stl.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/workspace_table.hpp>

#include "mesh_text.hpp"
#include "terminal.hpp"
#include "workspace_columns.hpp"

namespace softkin::cli {

namespace {

/// What a hull is called, and its measure.
std::string hull_text(const Hull& hull) {
  const std::string thick = number(hull.extents[0], 4) + " x " + number(hull.extents[1], 4) + " x " +
                            number(hull.extents[2], 2) + " mm along its principal axes";
  switch (hull.shape) {
    case HullShape::solid:
      return number(hull.volume, 6) + " mm^3, " + thick;
    case HullShape::flat:
      return "flat, without a volume: " + number(hull.area, 6) + " mm^2, " + thick;
    case HullShape::line:
      return "none: the positions are on a line of " + number(hull.extents[0], 6) + " mm";
    case HullShape::point:
      break;
  }
  return "none: the marker does not move";
}

const char* hull_name(HullShape shape) {
  constexpr std::array<const char*, 4> names{"solid", "flat", "line", "point"};
  return names[static_cast<std::size_t>(shape)];
}

bool has_triangles(const Hull& hull) {
  return !hull.triangles.empty();
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

WorkspaceReach::WorkspaceReach(const Model& model, std::vector<WorkspaceSample> samples,
                               const WorkspaceOptions& options)
    : model_(model), options_(options) {
  for (WorkspaceSample& sample : samples)
    if (sample.status == Status::converged) samples_.push_back(std::move(sample));
  const Index marker = shown_marker(model, options.marker);
  marker_ = model.markers[static_cast<std::size_t>(marker)].name;
  positions_.resize(static_cast<Index>(samples_.size()), 3);
  for (std::size_t i = 0; i < samples_.size(); ++i)
    positions_.row(static_cast<Index>(i)) = samples_[i].markers.row(marker);
}

void WorkspaceReach::write() {
  if (samples_.empty()) return;
  if (!options_.cloud.empty()) write_cloud();
  if (!options_.hull.empty()) write_hull();
  if (!options_.plot.empty()) write_plot();
}

void WorkspaceReach::write_cloud() const {
  const WorkspaceColumns columns = workspace_columns(model_);
  VtuContent content;
  content.points = positions_;
  content.cloud = true;
  const auto add = [&](const std::string& name, const auto& value) {
    Field field{name, 1, {}};
    for (const WorkspaceSample& sample : samples_) field.values.push_back(value(sample));
    content.point_fields.push_back(std::move(field));
  };
  add("sample", [](const WorkspaceSample& sample) { return sample.number; });
  for (std::size_t a = 0; a < columns.actuators.size(); ++a)
    add(columns.actuators[a], [a](const WorkspaceSample& s) { return s.actuation[static_cast<Index>(a)]; });
  for (std::size_t i = 0; i < columns.loads.size(); ++i)
    add(columns.loads[i], [a = columns.loaded[i]](const WorkspaceSample& s) { return s.multipliers[a]; });
  add("iterations", [](const WorkspaceSample& sample) { return sample.iterations; });
  write_vtu(options_.cloud, content);
}

void WorkspaceReach::write_hull() {
  hull_ = convex_hull(positions_);
  if (!has_triangles(hull_)) return;
  if (lower_extension(options_.hull) == ".stl") return write_stl(options_.hull, hull_.vertices, hull_.triangles);
  VtuContent content;
  content.points = hull_.vertices;
  content.triangles = hull_.triangles;
  write_vtu(options_.hull, content);
}

void WorkspaceReach::write_plot() const {
  Plot plot;
  plot.title = "Reach of " + marker_ + ": " + counted(samples_.size(), "sample");
  std::vector<PlotPanel> row;
  for (const auto& [across, up] : views_of(positions_)) {
    PlotPanel panel;
    panel.x.label = std::string(axis_names[across]) + " [mm]";
    panel.y.label = std::string(axis_names[up]) + " [mm]";
    panel.equal = true;
    PlotSeries series;
    series.line = false;
    series.mark_radius = samples_.size() > 1000 ? 1 : 2;
    for (Index i = 0; i < positions_.rows(); ++i) {
      series.x.push_back(positions_(i, across));
      series.y.push_back(positions_(i, up));
    }
    panel.series.push_back(std::move(series));
    row.push_back(std::move(panel));
  }
  plot.panel_height = row.size() == 1 ? 500 : 260;
  plot.rows.push_back(std::move(row));
  write_svg(options_.plot, plot);
}

std::string WorkspaceReach::text() const {
  std::string text;
  if (samples_.empty()) {
    text = "no sample has an equilibrium: nothing to show";
  } else {
    text = marker_ + " reaches";
    for (int axis = 0; axis < 3; ++axis)
      text += std::string(axis > 0 ? ", " : " ") + axis_names[axis] + " " +
              decimal(positions_.col(axis).minCoeff(), 2) + " to " + decimal(positions_.col(axis).maxCoeff(), 2);
    text += " mm";
    if (!options_.hull.empty()) text += "\nconvex hull of the reach: " + hull_text(hull_);
  }
  text += "\nsamples: " + options_.output;
  if (samples_.empty()) return text;
  if (!options_.cloud.empty()) text += "\ncloud: " + options_.cloud + " (open it in ParaView)";
  if (!options_.hull.empty() && has_triangles(hull_)) text += "\nhull: " + options_.hull;
  if (!options_.plot.empty()) text += "\nplot: " + options_.plot;
  return text;
}

void WorkspaceReach::add_to(nlohmann::ordered_json& json) const {
  json["marker"] = marker_;
  if (samples_.empty()) return;
  for (int axis = 0; axis < 3; ++axis)
    json["reach_mm"][std::string(axis_names[axis])] = {positions_.col(axis).minCoeff(),
                                                       positions_.col(axis).maxCoeff()};
  if (options_.hull.empty()) return;
  json["hull"] = {{"shape", hull_name(hull_.shape)},
                  {"volume_mm3", hull_.volume},
                  {"area_mm2", hull_.area},
                  {"extents_mm", {hull_.extents[0], hull_.extents[1], hull_.extents[2]}}};
}

}  // namespace softkin::cli
