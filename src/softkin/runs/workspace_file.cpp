#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/kinematics/nearest.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/workspace_file.hpp>
#include <string_view>
#include <utility>

namespace softkin::runs {

namespace fs = std::filesystem;

namespace {

/// "newton", with what is not the default: "newton, tolerance 1e-06 mm, at most 50 iterations".
std::string solver_text(const StaticsOptions& solver) {
  const StaticsOptions defaults;
  std::string text = name_of(solver.solver);
  if (solver.step_tolerance_mm != defaults.step_tolerance_mm)
    text += ", tolerance " + exact(solver.step_tolerance_mm) + " mm";
  if (solver.max_iterations != defaults.max_iterations)
    text += ", at most " + counted(static_cast<std::size_t>(solver.max_iterations), "iteration");
  if (solver.anderson != defaults.anderson) text += ", anderson " + std::to_string(solver.anderson);
  return text;
}

/// Refuses to replace a workspace that has not all its samples: hours may be in it.
void check_replaceable(const fs::path& path) {
  if (!fs::exists(path)) return;
  const std::string text = read_file(path);
  if (!text.starts_with("# softkin workspace: ")) return;
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
    columns.loaded.push_back(static_cast<Index>(a));
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
            std::to_string(actuator.low < actuator.high ? nearest_grid(model, sampling.samples) : 1);
  return text;
}

WorkspaceHead workspace_head(const Model& model, const SamplingOptions& sampling, const StaticsOptions& solver) {
  std::string ranges;
  for (const Actuator& actuator : model.actuators)
    ranges += (ranges.empty() ? "" : ", ") + actuator.name + " " + number(actuator.low, 17) + " to " +
              command_text(actuator, actuator.high, 17);
  return {{"softkin workspace", "format 1"},
          {"softkin", SOFTKIN_VERSION},
          {"robot", fingerprint_of(model)},
          {"solver", solver_text(solver)},
          {"ranges", ranges},
          {"sampling", sampling_text(model, sampling)},
          {"samples", std::to_string(sampling.samples)}};
}

WorkspaceFile::WorkspaceFile(fs::path path, const WorkspaceHead& head, const WorkspaceColumns& columns,
                             const WorkspacePlan& plan, bool resume)
    : path_(std::move(path)), columns_(columns), known_(static_cast<std::size_t>(plan.samples())) {
  const std::string header = workspace_header(head, columns);
  if (!resume) check_replaceable(path_);
  store_.emplace(path_, header, resume);
  take(read_workspace(path_, columns_), head, plan);
}

void WorkspaceFile::take(const WorkspaceTable& table, const WorkspaceHead& head, const WorkspacePlan& plan) {
  const auto cannot = [&](const std::string& why) {
    throw InvalidInput({path_.string()}, "--resume cannot go on with this workspace: " + why);
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
    known_[static_cast<std::size_t>(sample.number)] = sample.status;
  }
}

Index WorkspaceFile::count(Status status) const {
  return static_cast<Index>(std::count(known_.begin(), known_.end(), std::optional(status)));
}

void WorkspaceFile::add(const WorkspaceSample& sample) {
  if (known(sample.number)) return;
  std::string row = workspace_row(sample, columns_);
  row.pop_back();  // the end of the line
  store_->append(row);
  known_[static_cast<std::size_t>(sample.number)] = sample.status;
}

std::vector<WorkspaceSample> WorkspaceFile::finish() {
  WorkspaceTable table = read_workspace(path_, columns_);
  std::vector<const std::string*> rows(known_.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[static_cast<std::size_t>(table.samples[i].number)] = &table.rows[i];
  std::string text = store_->head();
  for (const std::string* row : rows) text += *row;
  write_file(path_, text);
  std::sort(table.samples.begin(), table.samples.end(),
            [](const WorkspaceSample& a, const WorkspaceSample& b) { return a.number < b.number; });
  return std::move(table.samples);
}

Actuation nearest_actuation(const Model& model, const std::string& workspace, const std::vector<Goal>& goals) {
  WorkspaceTable table = read_workspace(workspace, workspace_columns(model));
  const auto robot =
      std::find_if(table.head.begin(), table.head.end(), [](const auto& entry) { return entry.first == "robot"; });
  if (robot == table.head.end() || robot->second != fingerprint_of(model))
    throw InvalidInput("--workspace " + workspace +
                       ": is of another robot, or of another formulation, or the scene or its mesh has changed");
  NearestSamples samples(model, std::move(table.samples));
  const Actuation actuation = samples.samples()[static_cast<std::size_t>(samples.find(goals).front())].actuation;
  check_actuation(model, actuation);  // the ranges may have changed
  return actuation;
}

}  // namespace softkin::runs
