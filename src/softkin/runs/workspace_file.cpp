#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/own_file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/kinematics/nearest.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/store.hpp>
#include <softkin/runs/workspace_file.hpp>
#include <string_view>
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

namespace fs = std::filesystem;

namespace {

/// "newton", with what is not the default: "newton, tolerance 1e-06 mm, at most 50 iterations".
std::string solver_text(const StaticsOptions& solver) {
  const StaticsOptions defaults;
  std::string text = name_of(solver.solver);
  if (solver.step_tolerance_mm != defaults.step_tolerance_mm)
    text += ", tolerance " + exact(solver.step_tolerance_mm) + " mm";
  if (solver.max_iterations != defaults.max_iterations)
    text += ", at most " + counted(static_cast<std::size_t>(solver.iteration_limit()), "iteration");
  if (solver.stable) text += ", stable";
  if (solver.anderson != defaults.anderson) text += ", anderson " + std::to_string(solver.anderson);
  if (const std::string changes = changes_text(solver.tuning); !changes.empty()) text += ", options " + changes;
  return text;
}

/// Refuses to replace a workspace that has not all its samples: hours may be in it.
void check_replaceable(const fs::path& path) {
  if (!fs::exists(path)) return;
  const std::string text = read_file(path);
  if (!text.starts_with(workspace_mark)) return;
  constexpr std::string_view key = "\n# samples: ";
  const std::size_t at = text.find(key);
  std::int64_t samples = 0;
  if (at == std::string::npos ||
      !parse_integer(std::string_view(text).substr(at + key.size(), text.find('\n', at + 1) - at - key.size()),
                     samples))
    return;
  std::int64_t rows = -1;  // the columns' line is none
  for (std::size_t line = 0; line < text.size(); line = text.find('\n', line) + 1) {
    if (text.find('\n', line) == std::string::npos) break;
    rows += text[line] != '#';
  }
  if (rows >= samples) return;
  throw InvalidInput({path.string()}, "is an unfinished workspace, " + std::to_string(rows) + " of " +
                                          std::to_string(samples) +
                                          " samples: add --resume to go on with it, or remove it");
}

}  // namespace

WorkspaceColumns workspace_columns(const Model& model) {
  WorkspaceColumns columns;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const std::string load = multiplier_key(actuator);
    columns.actuators.push_back(command_column(actuator));
    if (model.formulation != Formulation::physical || load.empty()) continue;
    columns.loads.push_back(actuator.name + "_" + load);
    columns.loaded.push_back(a);
  }
  for (const Marker& marker : model.markers)
    for (const char* axis : {"_x_mm", "_y_mm", "_z_mm"}) columns.markers.push_back(marker.name + axis);
  return columns;
}

std::string sampling_text(const Model& model, const SamplingOptions& sampling) {
  if (sampling.kind == Sampling::sobol) return "sobol";
  if (sampling.kind == Sampling::random) return "random, seed " + std::to_string(sampling.seed);
  std::string text;
  for (const Actuator& actuator : model.actuators)
    text += (text.empty() ? "grid of " : " x ") +
            std::to_string(varies(actuator) ? nearest_grid(model, sampling.samples) : 1);
  return text;
}

WorkspaceHead workspace_head(const Model& model, const SamplingOptions& sampling, const StaticsOptions& solver) {
  std::string ranges;
  for (const Actuator& actuator : model.actuators)
    ranges += (ranges.empty() ? "" : ", ") + actuator.name + " " + number(actuator.low, 17) + " to " +
              command_text(actuator, actuator.high, 17);
  return {{"softkin workspace", "format 2"},
          {"softkin", SOFTKIN_VERSION},
          {"robot", fingerprint_of(model)},
          {"solver", solver_text(solver)},
          {"ranges", ranges},
          {"sampling", sampling_text(model, sampling)},
          {"samples", std::to_string(sampling.samples)}};
}

WorkspaceFile::WorkspaceFile(fs::path path, const WorkspaceHead& head, const WorkspaceColumns& columns,
                             const WorkspacePlan& plan, bool resume)
    : path_(std::move(path)), columns_(columns), known_(plan.samples()) {
  const std::string header = workspace_header(head, columns);
  if (!resume) check_replaceable(path_);
  store_ = std::make_unique<Store>(path_, header, resume);
  take(read_workspace(path_, columns_), head, plan);
}

WorkspaceFile::~WorkspaceFile() = default;

Index WorkspaceFile::done() const {
  return store_->size();
}
bool WorkspaceFile::complete() const {
  return store_->size() == known_.size();
}
bool WorkspaceFile::was_torn() const {
  return store_->was_torn();
}

void WorkspaceFile::take(const WorkspaceTable& table, const WorkspaceHead& head, const WorkspacePlan& plan) {
  const auto cannot = [&](const std::string& why) {
    throw InvalidInput({path_.string()}, "cannot go on with this workspace: " + why);
  };
  for (std::size_t i = 0; i < head.size(); ++i) {
    const auto& [key, value] = head[i];
    const std::string found = i < table.head.size() && table.head[i].first == key ? table.head[i].second : "";
    if (found == value) continue;
    if (key == "robot") cannot("it is of another robot, or the scene or its mesh has changed");
    cannot("its " + key + " is '" + found + "', not '" + value + "'");
  }
  for (const WorkspaceSample& sample : table.samples) {
    if (sample.number >= plan.samples() || plan.actuations.row(sample.number).transpose() != sample.actuation)
      cannot("sample " + std::to_string(sample.number) + " is of another actuation");
    note(sample);
  }
}

void WorkspaceFile::note(const WorkspaceSample& sample) {
  known_[sample.number] = sample.status;
  if (sample.markers.rows() == 0) ++without_shape_;
}

Index WorkspaceFile::count(Status status) const {
  return std::count(known_.begin(), known_.end(), std::optional(status));
}

void WorkspaceFile::add(const WorkspaceSample& sample) {
  if (known(sample.number)) return;
  std::string row = workspace_row(sample, columns_);
  row.pop_back();  // the end of the line
  store_->append(row);
  note(sample);
}

std::vector<WorkspaceSample> WorkspaceFile::finish() {
  WorkspaceTable table = read_workspace(path_, columns_);
  std::vector<const std::string*> rows(known_.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[table.samples[i].number] = &table.rows[i];
  std::string text = store_->head();
  for (const std::string* row : rows) text += *row;
  write_file(path_, text);
  std::sort(table.samples.begin(), table.samples.end(),
            [](const WorkspaceSample& a, const WorkspaceSample& b) { return a.number < b.number; });
  return std::move(table.samples);
}

std::vector<WorkspaceSample> samples_of(const Model& model, const std::string& workspace) {
  WorkspaceTable table = read_workspace(workspace, workspace_columns(model));
  const auto robot =
      std::find_if(table.head.begin(), table.head.end(), [](const auto& entry) { return entry.first == "robot"; });
  if (robot == table.head.end() || robot->second != fingerprint_of(model))
    throw InvalidInput({workspace},
                       "is of another robot, or of another formulation, or the scene or its mesh has changed");
  return std::move(table.samples);
}

Actuation nearest_actuation(const Model& model, const std::string& workspace, const std::vector<Goal>& goals) {
  NearestSamples samples(model, samples_of(model, workspace));
  const Actuation actuation = samples.samples()[samples.find(goals).front()].actuation;
  check_actuation(model, actuation);  // the ranges may have changed
  return actuation;
}

Index shown_marker(const Model& model, const std::string& name) {
  if (model.markers.empty())
    throw InvalidInput("the robot has no marker, so there is no workspace to sample: add one to the scene");
  if (name.empty()) return 0;
  std::vector<std::string> names;
  for (std::size_t p = 0; p < model.markers.size(); ++p) {
    if (model.markers[p].name == name) return static_cast<Index>(p);
    names.push_back(model.markers[p].name);
  }
  throw InvalidInput("there is no marker " + excerpt(name) + suggest_name(name, names));
}

Reach reach_of(const Model& model, std::vector<WorkspaceSample> samples, const std::string& marker, bool with_hull) {
  const Index shown = shown_marker(model, marker);
  Reach reach{model.markers[shown].name, {}, {}};
  for (WorkspaceSample& sample : samples)
    if (sample.status == Status::converged) reach.samples.push_back(std::move(sample));
  reach.positions.resize(reach.samples.size(), 3);
  for (std::size_t i = 0; i < reach.samples.size(); ++i) reach.positions.row(i) = reach.samples[i].markers.row(shown);
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
    add(columns.actuators[a], [a](const WorkspaceSample& s) { return s.actuation[a]; });
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

std::string workspace_summary(const std::string& scene, const WorkspaceHead& head, const Reach& reach, Index samples,
                              const std::function<Index(Status)>& count, double seconds) {
  Json json = {{"softkin", SOFTKIN_VERSION}, {"scene", scene}};
  for (const auto& [key, value] : head)
    if (key == "robot" || key == "solver" || key == "sampling") json[key] = value;
  json["samples"] = samples;
  for (const Status status : {Status::converged, Status::limit, Status::not_converged})
    json[workspace_status(status)] = count(status);
  json["marker"] = reach.marker;
  if (!reach.samples.empty())
    for (int axis = 0; axis < 3; ++axis)
      json["reach_mm"][axis_names[axis]] = {reach.positions.col(axis).minCoeff(), reach.positions.col(axis).maxCoeff()};
  if (const auto& hull = reach.hull)
    json["hull"] = {{"shape", hull_name(hull->shape)},
                    {"volume_mm3", hull->volume},
                    {"area_mm2", hull->area},
                    {"extents_mm", json_of(hull->extents)}};
  json["seconds"] = seconds;
  return json_text(json);
}

std::string hull_text(const Hull& hull) {
  constexpr int hull_decimals = 3, measure_decimals = 2;
  const std::string thick = decimal(hull.extents[0], hull_decimals) + " x " + decimal(hull.extents[1], hull_decimals) +
                            " x " + decimal(hull.extents[2], hull_decimals) + " mm along its principal axes";
  switch (hull.shape) {
    case HullShape::solid:
      return decimal(hull.volume, measure_decimals) + " mm^3, " + thick;
    case HullShape::flat:
      return "flat, without a volume: " + decimal(hull.area, measure_decimals) + " mm^2, " + thick;
    case HullShape::line:
      return "none: the positions are on a line of " + decimal(hull.extents[0], hull_decimals) + " mm";
    case HullShape::point:
      break;
  }
  return "none: the marker does not move";
}

}  // namespace softkin::runs
