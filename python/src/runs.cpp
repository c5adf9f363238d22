#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <softkin/io/file.hpp>
#include <softkin/io/table/marker_path.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/follow_run.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/runs/plots.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/run_tables.hpp>
#include <softkin/runs/turns.hpp>
#include <softkin/runs/walk_run.hpp>
#include <softkin/runs/workspace_file.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "solve.hpp"
#include "steps.hpp"
#include "watch.hpp"

namespace softkin::python {

namespace {

namespace fs = std::filesystem;
using Steps = std::vector<ActuationStep>;

/// A folder that is there from now on, or none where its name is empty.
fs::path made(const std::string& folder) {
  if (!folder.empty()) fs::create_directories(folder);
  return folder;
}

/// Files of a run that can be resumed; an empty folder: none.
runs::RunFiles files_in(const std::string& store) {
  const fs::path folder = made(store);
  return folder.empty() ? runs::RunFiles() : runs::RunFiles{folder / "report.json", folder / "path.pvd"};
}

/// A run, record by record.
template <class Record>
class Runner {
 public:
  virtual ~Runner() = default;

  [[nodiscard]] std::size_t size() { return run().size(); }
  [[nodiscard]] std::size_t done() { return run().done(); }
  [[nodiscard]] const std::string& remark() const { return remark_; }

  /// The next shape; none at the end.
  [[nodiscard]] ShapePtr next() {
    if (lost_ || run().is_complete()) return nullptr;
    note_resumed();
    const runs::Advance end =
        watched(std::nullopt, [&](const ProgressCallback& callback) { return run().advance(callback); });
    lost_ = end != runs::Advance::made;
    if (const auto* stopped = run().stopped()) return shape_of(stopped->record, stopped->state.positions);
    ++noted_;
    return shape_of(run().last(), run().last_positions());
  }
  [[nodiscard]] std::vector<FindingOut> findings() {
    if (const auto* stopped = run().stopped()) return finding_lines_of(model(), stopped->record);
    return finding_lines_of(model(), run().last());
  }
  /// By how much a marker, or the line from one to another, has turned from rest in each record so far [degrees].
  [[nodiscard]] std::vector<double> turns(const std::string& marker, const std::optional<std::string>& to) {
    std::vector<double> all;
    if (!to) {
      const auto m = static_cast<std::size_t>(robot_->oriented_marker(marker));
      run().log().each([&](std::size_t, const Record& record) { all.push_back(record.marker_turns.at(m)); });
      return all;
    }
    const runs::MarkerLine line = runs::read_marker_line(model(), {marker, *to}, "turns").value();
    runs::TurnMeter meter(line.at_rest(model()));
    run().log().each([&](std::size_t, const Record& record) { all.push_back(meter.next(line.in(record.markers))); });
    return all;
  }
  virtual void finish() { run().finish(); }
  [[nodiscard]] virtual std::string report() {
    std::string text;
    run().log().report([&](std::string_view piece) { text += piece; });
    return text;
  }

 protected:
  Runner(RobotPtr robot, StaticsOptions options)
      : robot_(std::move(robot)), options_(options), lines_(robot_->model()) {}

  [[nodiscard]] virtual runs::Run<Record>& run() = 0;
  [[nodiscard]] const Model& model() const { return robot_->model(); }
  [[nodiscard]] const StaticsOptions& options() const { return options_; }
  void resume(const std::string& store) {
    if (!store.empty()) run().resume(remark_);
  }

 private:
  [[nodiscard]] ShapePtr shape_of(const runs::StepRecord& record, const Points& positions) {
    Equilibrium found{runs::state_of(model(), record, positions), record.actuation, record};
    return std::make_shared<Shape>(robot_, std::move(found), options_,
                                   RunTurns{record.marker_turns, lines_.next(record.markers)});
  }

  /// Of records that an earlier run has made.
  void note_resumed() {
    if (noted_ == run().done()) return;
    lines_ = runs::LineTurns(model());
    noted_ = run().done();
    run().log().each([this](std::size_t, const Record& record) { (void)lines_.next(record.markers); });
  }

  RobotPtr robot_;
  StaticsOptions options_;
  runs::LineTurns lines_;
  std::size_t noted_ = 0;  // records whose turns lines_ has
  std::string remark_;
  bool lost_ = false;
};

class PathRun : public Runner<runs::StepRecord> {
 public:
  PathRun(const RobotPtr& robot, const MapPtr& map, bool polish, Steps steps, const std::string& name,
          const StaticsOptions& options, const std::string& store)
      : Runner(robot, options),
        session_(robot, map, polish),
        steps_(std::move(steps)),
        job_(session_.statics, steps_, name, options),
        used_(session_.used()),
        run_(model(), job_, files_in(store),
             runs::report_head(model(), model().name, options, used_ ? &*used_ : nullptr), {}) {
    resume(store);
  }
  void save_plot(const std::string& path) {
    const std::string by = used_ && !used_->polished ? used_->file : std::string(name_of(options().solver));
    const std::string title = runs::plot_title(model(), model().name) + ", " + by;
    write_svg(path, runs::plot_of_steps(model(), run_.log().all(), title));
  }

 private:
  [[nodiscard]] runs::Run<runs::StepRecord>& run() override { return run_; }

  Session session_;
  Steps steps_;
  runs::PathJob job_;
  std::optional<runs::UsedMap> used_;
  runs::Run<runs::StepRecord> run_;
};

class FollowRun : public Runner<runs::WaypointRecord> {
 public:
  FollowRun(const RobotPtr& robot, const MapPtr& map, bool polish, MarkerPath path, const std::string& name,
            const TrajectoryOptions& options, const std::string& store)
      : Runner(robot, options.inverse.statics),
        session_(robot, map, polish),
        used_(session_.used()),
        follow_(session_.statics, {model().name, name, std::move(path), used_ ? &*used_ : nullptr}, options,
                runs::FollowFolder(made(store))) {
    resume(store);
  }
  void finish() override { follow_.finish(); }
  void save_plot(const std::string& path) { write_svg(path, follow_.plot()); }
  [[nodiscard]] Table commands() { return follow_.commands(); }
  [[nodiscard]] Table errors() { return follow_.errors(); }
  /// Status, error [mm], targets by marker, equilibria, why the search stopped, time [s], inserted.
  using Requested = std::tuple<std::string, double, std::map<std::string, std::vector<std::optional<double>>>, int,
                               std::string, std::optional<double>, bool>;
  [[nodiscard]] Requested requested() {
    const runs::WaypointRecord& record = run().last();
    Requested all{name_of(record.end),   record.error_mm,          {}, record.equilibria, record.search_remark,
                  record.requested.time, record.requested.inserted};
    const MarkerPath& path = follow_.path();
    for (std::size_t p = 0; p < path.markers.size(); ++p) {
      auto& target = std::get<2>(all)[model().markers[path.markers[p]].name];
      for (Index axis = 0; axis < 3; ++axis)
        target.push_back(path.axes[p][axis] ? std::optional(record.requested.targets[p][axis]) : std::nullopt);
    }
    return all;
  }
  [[nodiscard]] std::string step() { return follow_.step_text(run().last()); }

 private:
  [[nodiscard]] runs::Run<runs::WaypointRecord>& run() override { return follow_.run(); }

  Session session_;
  std::optional<runs::UsedMap> used_;
  runs::FollowRun follow_;
};

class WalkRun : public Runner<runs::WalkRecord> {
 public:
  WalkRun(const RobotPtr& robot, const Steps& gait, const std::string& name, std::size_t cycles,
          const StaticsOptions& options, const std::string& store)
      : Runner(robot, options),
        walk_(model(), {model().name, name, runs::repeated(model(), name, gait, cycles), cycles}, options,
              runs::WalkFolder(made(store))) {
    resume(store);
  }
  void finish() override { walk_.finish(); }
  [[nodiscard]] std::string report() override {
    (void)walk_.note_strides();
    return Runner::report();
  }
  [[nodiscard]] std::string step() { return walk_.step_text(run().last()); }
  [[nodiscard]] Table table() { return runs::walk_table(model(), walk_.records()); }
  [[nodiscard]] std::vector<double> strides() { return walk_.note_strides(); }
  [[nodiscard]] std::array<double, 3> direction() const { return array_of(walk_.direction()); }
  void save_plot(const std::string& path) { write_svg(path, walk_.plot()); }

 private:
  [[nodiscard]] runs::Run<runs::WalkRecord>& run() override { return walk_.run(); }

  runs::WalkRun walk_;
};

Steps steps_of(const Robot& robot, const TableIn& rows, const std::optional<VectorIn>& times) {
  Steps steps;
  const Eigen::Index columns = rows.shape(1);
  for (std::size_t i = 0; i < rows.shape(0); ++i) {
    ActuationStep step;
    step.actuation = Eigen::Map<const Eigen::VectorXd>(rows.data() + i * rows.shape(1), columns);
    if (times) step.time = times->data()[i];
    check_actuation(robot.model(), step.actuation);
    steps.push_back(std::move(step));
  }
  return steps;
}

using TargetsIn = nb::ndarray<const double, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

/// targets: k x p x 3; a coordinate that does not count is 0
MarkerPath path_of(const Robot& robot, const std::vector<std::string>& markers, const TargetsIn& targets,
                   const std::vector<std::array<bool, 3>>& axes, const std::optional<VectorIn>& times) {
  MarkerPath path;
  for (const std::string& marker : markers) path.markers.push_back(robot.marker(marker));
  path.axes = axes;
  for (std::size_t i = 0; i < targets.shape(0); ++i) {
    Waypoint waypoint;
    for (std::size_t p = 0; p < targets.shape(1); ++p) {
      const double* at = targets.data() + 3 * (i * targets.shape(1) + p);
      waypoint.targets.emplace_back(at[0], at[1], at[2]);
    }
    if (times) waypoint.time = times->data()[i];
    path.waypoints.push_back(std::move(waypoint));
  }
  return path;
}

void bind_table(nb::module_& module) {
  nb::class_<Table>(module, "Table", "Columns and rows, as the command prints and writes them.")
      .def_static(
          "of_numbers",
          [](const std::vector<std::string>& keys, const std::vector<std::vector<double>>& rows) {
            Table table;
            for (const std::string& key : keys) table.columns.push_back({.key = key});
            for (const std::vector<double>& row : rows) table.rows.emplace_back(row.begin(), row.end());
            return table;
          },
          nb::arg("keys"), nb::arg("rows"))
      .def_prop_ro("keys",
                   [](const Table& table) {
                     std::vector<std::string> keys;
                     for (const Column& column : table.columns) keys.push_back(column.key);
                     return keys;
                   })
      .def_prop_ro(
          "titles",
          [](const Table& table) {
            std::vector<std::string> titles;
            for (const Column& c : table.columns)
              titles.push_back((c.title.empty() ? c.key : c.title) + (c.unit.empty() ? "" : " [" + c.unit + "]"));
            return titles;
          })
      .def_prop_ro("rows", [](const Table& table) { return table.rows; })
      .def("csv", &Table::csv)
      .def("text", [](const Table& table) {
        std::string text;
        for (const std::string& line : table.lines()) text += line + "\n";
        return text;
      });
}

template <class Run>
nb::class_<Run> bind_runner(nb::module_& module, const char* name, const char* what) {
  return nb::class_<Run>(module, name, what)
      .def_prop_ro("size", &Run::size)
      .def_prop_ro("done", &Run::done)
      .def_prop_ro("remark", &Run::remark, "What was not there as it was written, of a run that goes on; else ''.")
      .def("next", &Run::next)
      .def("findings", &Run::findings, "Lines about the last shape, as Shape.findings().")
      .def("turns", &Run::turns, nb::arg("marker"), nb::arg("to").none(), "[degrees]")
      .def("finish", &Run::finish)
      .def("save_plot", &Run::save_plot, nb::arg("path"))
      .def("report", &Run::report);
}

void bind_paths(nb::module_& module) {
  nb::class_<NamedSteps>(module, "Steps", "Commands of a path or a gait, step by step.")
      .def_static(
          "of_rows",
          [](const Robot& robot, const TableIn& rows, const std::optional<VectorIn>& times, const std::string& name) {
            return NamedSteps{steps_of(robot, rows, times), name};
          },
          nb::arg("robot"), nb::arg("rows"), nb::arg("times").none(), nb::arg("name"))
      .def_static(
          "of_file",
          [](const Robot& robot, const std::string& file, const std::vector<std::string>& settings) {
            const Settings others = read_settings(robot.model(), "path", settings);
            return NamedSteps{read_actuation_path(robot.model(), file, others), file};
          },
          nb::arg("robot"), nb::arg("file"), nb::arg("settings"));
  bind_runner<PathRun>(module, "PathRun", "Equilibria along a path of actuations, each from the last.")
      .def(
          "__init__",
          [](PathRun* self, const RobotPtr& robot, const MapPtr& map, bool polish, const NamedSteps& path,
             const StaticsOptions& options, const std::string& store) {
            new (self) PathRun(robot, map, polish, path.steps, path.name, options, store);
          },
          nb::arg("robot"), nb::arg("map").none(), nb::arg("polish"), nb::arg("path"), nb::arg("options"),
          nb::arg("store"));
  bind_runner<WalkRun>(module, "WalkRun", "A gait that is walked, each equilibrium from the last.")
      .def(
          "__init__",
          [](WalkRun* self, const RobotPtr& robot, const NamedSteps& gait, std::size_t cycles,
             const StaticsOptions& options,
             const std::string& store) { new (self) WalkRun(robot, gait.steps, gait.name, cycles, options, store); },
          nb::arg("robot"), nb::arg("gait"), nb::arg("cycles"), nb::arg("options"), nb::arg("store"))
      .def("step", &WalkRun::step, "The last record as a step of the report, JSON.")
      .def("table", &WalkRun::table)
      .def("strides", &WalkRun::strides, "[mm]")
      .def("direction", &WalkRun::direction);
}

}  // namespace

void bind_runs(nb::module_& module) {
  bind_table(module);
  nb::class_<MarkerPath>(module, "MarkerPath", "Places that markers are to visit one after another.")
      .def_static("of_targets", &path_of, nb::arg("robot"), nb::arg("markers"), nb::arg("targets"), nb::arg("axes"),
                  nb::arg("times").none())
      .def_static(
          "of_file",
          [](const Robot& robot, const std::string& file, const std::string& marker) {
            return read_marker_path(file, robot.model(), marker);
          },
          nb::arg("robot"), nb::arg("file"), nb::arg("marker"))
      .def(
          "densified", [](const MarkerPath& path, double step) { return densified(path, step); },
          nb::arg("max_step_mm"))
      .def("doubts", [](const MarkerPath& path, const Robot& robot) { return doubts_about(robot.model(), path); })
      .def_prop_ro("size", [](const MarkerPath& path) { return path.waypoints.size(); });
  bind_paths(module);
  bind_runner<FollowRun>(module, "FollowRun", "Inverse kinematics along a path of markers.")
      .def(
          "__init__",
          [](FollowRun* self, const RobotPtr& robot, const MapPtr& map, bool polish, const MarkerPath& path,
             const std::string& name, const InverseOptions& inverse, bool predict, const std::optional<VectorIn>& start,
             const std::string& workspace, bool nearest, std::optional<Index> samples, const std::string& store) {
            TrajectoryOptions options{inverse, predict, start ? vector_of(*start) : Actuation()};
            if (nearest && samples)
              options.nearest = full_grid(robot->model(), *samples);
            else if (nearest)
              options.nearest = runs::samples_of(robot->model(), workspace);
            else if (!workspace.empty() && !path.waypoints.empty())
              options.start =
                  runs::nearest_actuation(robot->model(), workspace, goals_of(path, path.waypoints.front()));
            new (self) FollowRun(robot, map, polish, path, name, options, store);
          },
          nb::arg("robot"), nb::arg("map").none(), nb::arg("polish"), nb::arg("path"), nb::arg("name"),
          nb::arg("inverse"), nb::arg("predict"), nb::arg("start").none(), nb::arg("workspace"), nb::arg("nearest"),
          nb::arg("samples").none(), nb::arg("store"))
      .def("commands", &FollowRun::commands)
      .def("errors", &FollowRun::errors)
      .def("asked", &FollowRun::requested)
      .def("step", &FollowRun::step, "The last record as a step of the report, JSON.");
}

}  // namespace softkin::python
