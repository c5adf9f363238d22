#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <chrono>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/kinematics/hull.hpp>
#include <softkin/runs/ranks.hpp>
#include <softkin/runs/workspace_file.hpp>
#include <thread>

#include "bindings.hpp"
#include "convert.hpp"
#include "pickles.hpp"
#include "solve.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

/// Groups one after another; samples are kept in memory.
class MemoryDesk : public GroupDesk {
 public:
  MemoryDesk(const WorkspacePlan& plan, const Watch& watch) : plan_(plan), watch_(watch), samples_(plan.samples()) {}

  std::optional<GroupTask> take() override {
    const std::lock_guard lock(mutex_);
    if (next_ == plan_.groups.size() || !watch_.go_on()) return std::nullopt;
    GroupTask task{static_cast<Index>(next_), {}};
    task.known.resize(plan_.groups[next_++].size());
    return task;
  }
  void keep(const WorkspaceSample& sample) override {
    const std::lock_guard lock(mutex_);
    samples_[sample.number] = sample;
    ++done_;
  }
  [[nodiscard]] Index done() const { return done_; }
  [[nodiscard]] std::vector<WorkspaceSample> finish() { return std::move(samples_); }

 private:
  const WorkspacePlan& plan_;
  const Watch& watch_;
  std::mutex mutex_;
  std::size_t next_ = 0;
  std::atomic<Index> done_ = 0;
  std::vector<WorkspaceSample> samples_;
};

SamplingOptions sampling_of(const Model& model, Index samples, const std::string& kind, std::uint64_t seed) {
  SamplingOptions options{Sampling::grid, samples, seed};
  if (kind == "sobol")
    options.kind = Sampling::sobol;
  else if (kind == "random")
    options.kind = Sampling::random;
  else if (kind != "grid")
    throw InvalidInput("sampling must be 'grid', 'sobol' or 'random', not '" + kind + "'");
  if (samples < 1) throw InvalidInput("samples must be 1 or more, not " + std::to_string(samples));
  if (options.kind == Sampling::grid) options.samples = full_grid(model, samples);
  return options;
}

/// Callback with the number of samples.
using Counter = nb::typed<nb::callable, nb::object(Index)>;

/// Samples that were solved, in their order.
struct Workspace {
  RobotPtr robot;
  std::string sampling;
  WorkspaceHead head;
  double seconds = 0;
  std::vector<WorkspaceSample> samples;
};

/// kept: called with the number of samples that are done
std::vector<WorkspaceSample> solve_all(const Robot& robot, const WorkspacePlan& plan, const StaticsOptions& options,
                                       int threads, Watch& watch, const Counter& kept) {
  MemoryDesk desk(plan, watch);
  const auto work = [&] {
    solve_groups(robot.statics(), plan, options, threads, desk, [&](const Progress&) { return watch.go_on(); });
  };
  watch.watch(work, [&] { kept(desk.done()); });
  return desk.finish();
}

std::vector<WorkspaceSample> solve_into(const Robot& robot, const SamplingOptions& sampling, const WorkspacePlan& plan,
                                        const StaticsOptions& options, int threads, const std::string& store,
                                        Watch& watch, const Counter& kept) {
  const WorkspaceColumns columns = runs::workspace_columns(robot.model());
  runs::WorkspaceFile file(store, runs::workspace_head(robot.model(), sampling, options), columns, plan, true);
  std::atomic<Index> done = file.done();
  runs::FileDesk desk(
      plan, file, [&] { return watch.go_on(); }, [&] { done = file.done(); });
  const auto work = [&] {
    if (file.complete()) return;
    solve_groups(robot.statics(), plan, options, threads, desk, [&](const Progress&) { return watch.go_on(); });
  };
  watch.watch(work, [&] { kept(done.load()); });
  return file.finish();
}

std::shared_ptr<Workspace> workspace(const RobotPtr& robot, Index samples, const std::string& kind, std::uint64_t seed,
                                     const StaticsOptions& options, int threads, const std::string& store,
                                     const Counter& begin, const Counter& kept) {
  const SamplingOptions sampling = sampling_of(robot->model(), samples, kind, seed);
  const WorkspacePlan plan = plan_workspace(robot->model(), sampling);
  begin(plan.samples());
  Watch watch{std::nullopt};
  const int many = threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto start = std::chrono::steady_clock::now();
  auto result = std::make_shared<Workspace>();
  result->robot = robot;
  result->sampling = runs::sampling_text(robot->model(), sampling);
  result->head = runs::workspace_head(robot->model(), sampling, options);
  result->samples = store.empty() ? solve_all(*robot, plan, options, many, watch, kept)
                                  : solve_into(*robot, sampling, plan, options, many, store, watch, kept);
  result->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// A row per sample of so many numbers; rows that are not known are NaN.
template <class Rows>
TableOut rows_of(const Workspace& workspace, std::size_t columns, const Rows& rows) {
  std::vector<double> values;
  values.reserve(columns * workspace.samples.size());
  for (const WorkspaceSample& sample : workspace.samples) {
    const auto& row = rows(sample);
    const bool known = static_cast<std::size_t>(row.size()) == columns;
    for (std::size_t i = 0; i < columns; ++i)
      values.push_back(known ? row.data()[i] : std::numeric_limits<double>::quiet_NaN());
  }
  return table_of(values.data(), workspace.samples.size(), columns);
}

using HullOut = std::tuple<std::string, TableOut, CellsOut, double, double, std::array<double, 3>>;

/// Of samples that have an equilibrium, at least one.
runs::Reach reach_of(const Workspace& workspace, const std::string& marker) {
  runs::Reach reach = runs::reach_of(workspace.robot->model(), workspace.samples, marker, true);
  if (!reach.hull) throw InvalidInput("no sample of the workspace has an equilibrium: there is nothing to show");
  return reach;
}

void save_hull(const Workspace& workspace, const std::string& path, const std::string& marker) {
  const runs::Reach reach = reach_of(workspace, marker);
  if (reach.hull->triangles.empty())
    throw InvalidInput("the positions of " + reach.marker + " are on a line: their hull has no triangles");
  runs::write_hull(path, *reach.hull);
}

HullOut hull_of(const Workspace& workspace, const std::string& marker) {
  const runs::Reach reach = reach_of(workspace, marker);
  const Hull& hull = *reach.hull;
  static constexpr const char* names[] = {"solid", "flat", "line", "point"};
  return {names[static_cast<int>(hull.shape)],
          table_of<double>(hull.vertices.data(), hull.vertices.rows(), 3),
          cells_out(hull.triangles),
          hull.volume,
          hull.area,
          array_of(hull.extents)};
}

std::string summary_of(const Workspace& workspace, const std::string& marker) {
  const Model& model = workspace.robot->model();
  const auto count = [&](Status status) {
    return static_cast<Index>(std::count_if(workspace.samples.begin(), workspace.samples.end(),
                                            [&](const WorkspaceSample& s) { return s.status == status; }));
  };
  return runs::workspace_summary(model.name, workspace.head, runs::reach_of(model, workspace.samples, marker, true),
                                 workspace.samples.size(), count, workspace.seconds);
}

}  // namespace

void bind_workspace(nb::module_& module) {
  nb::class_<Workspace>(module, "Workspace", "The equilibria of many actuations.")
      .def_prop_ro("robot", [](const Workspace& w) { return w.robot; })
      .def_ro("sampling", &Workspace::sampling)
      .def_prop_ro("columns",
                   [](const Workspace& w) {
                     const WorkspaceColumns c = runs::workspace_columns(w.robot->model());
                     return std::tuple(c.actuators, c.markers, c.loads, c.loaded);
                   })
      .def_prop_ro(
          "actuation",
          [](const Workspace& w) {
            return rows_of(w, w.robot->model().actuators.size(),
                           [](const WorkspaceSample& s) -> const Actuation& { return s.actuation; });
          },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "markers",
          [](const Workspace& w) {
            return rows_of(w, 3 * w.robot->model().markers.size(),
                           [](const WorkspaceSample& s) -> const Points& { return s.markers; });
          },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "multipliers",
          [](const Workspace& w) {
            return rows_of(w, w.robot->model().actuators.size(),
                           [](const WorkspaceSample& s) -> const Eigen::VectorXd& { return s.multipliers; });
          },
          nb::rv_policy::automatic)
      .def_prop_ro("status",
                   [](const Workspace& w) {
                     std::vector<std::string> all;
                     for (const WorkspaceSample& s : w.samples) all.emplace_back(workspace_status(s.status));
                     return all;
                   })
      .def_prop_ro(
          "reached",
          [](const Workspace& w) {
            std::vector<double> all;
            for (const WorkspaceSample& s : w.samples)
              all.push_back(s.markers.rows() > 0 ? s.reached : std::numeric_limits<double>::quiet_NaN());
            return list_of(all.data(), all.size());
          },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "iterations",
          [](const Workspace& w) {
            std::vector<Index> all;
            for (const WorkspaceSample& s : w.samples) all.push_back(s.iterations);
            return list_of(all.data(), all.size());
          },
          nb::rv_policy::automatic)
      .def("pickled",
           [](const Workspace& w) {
             Writer writer;
             writer(w.sampling, w.head, w.seconds, w.samples);
             return nb::bytes(writer.bytes().data(), writer.bytes().size());
           })
      .def_static(
          "unpickled",
          [](RobotPtr robot, nb::bytes bytes) {
            auto read = std::make_shared<Workspace>();
            read->robot = std::move(robot);
            Reader reader({bytes.c_str(), bytes.size()});
            reader(read->sampling, read->head, read->seconds, read->samples);
            reader.finish();
            return read;
          },
          nb::arg("robot"), nb::arg("bytes"))
      .def_ro("seconds", &Workspace::seconds)
      .def("summary", &summary_of, nb::arg("marker"))
      .def("hull", &hull_of, nb::arg("marker"))
      .def("save_hull", &save_hull, nb::arg("path"), nb::arg("marker"))
      .def(
          "save_cloud",
          [](const Workspace& w, const std::string& path, const std::string& marker) {
            runs::write_cloud(path, w.robot->model(), reach_of(w, marker));
          },
          nb::arg("path"), nb::arg("marker"))
      .def(
          "save_plot",
          [](const Workspace& w, const std::string& path, const std::string& marker) {
            write_svg(path, runs::plot_of_reach(reach_of(w, marker)));
          },
          nb::arg("path"), nb::arg("marker"));
  module.def("workspace", &workspace, nb::arg("robot"), nb::arg("samples"), nb::arg("sampling"), nb::arg("seed"),
             nb::arg("options"), nb::arg("threads"), nb::arg("store"), nb::arg("begin"), nb::arg("kept"));
}

}  // namespace softkin::python
