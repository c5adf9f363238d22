#pragma once

#include <filesystem>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/turns.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin::runs {

/// What a folder of a trajectory holds; an empty folder: nothing is written.
class FollowFolder {
 public:
  /// plot: another file for it; empty: path.svg in the folder
  explicit FollowFolder(std::filesystem::path folder = {}, std::filesystem::path plot = {})
      : folder_(std::move(folder)), plot_(std::move(plot)) {}

  [[nodiscard]] RunFiles run() const { return {in("report.json"), in("path.pvd")}; }
  [[nodiscard]] std::filesystem::path commands() const { return in("commands.csv"); }
  [[nodiscard]] std::filesystem::path errors() const { return in("errors.csv"); }
  /// Are the commands in the folder those of the report beside them? They say nothing of softkin themselves, as any
  /// reader of tables is to read them.
  [[nodiscard]] bool has_written_commands() const;
  [[nodiscard]] std::filesystem::path plot() const { return plot_.empty() ? in("path.svg") : plot_; }

 private:
  [[nodiscard]] std::filesystem::path in(const char* name) const { return folder_.empty() ? folder_ : folder_ / name; }

  std::filesystem::path folder_, plot_;
};

/// What is followed, and how it is called.
struct FollowTask {
  std::string scene, file;  // as the user named them
  MarkerPath path;
  const UsedMap* map = nullptr;      // null: none
  std::optional<MarkerLine> line{};  // whose turn is drawn
};

/// A trajectory, waypoint by waypoint, and what is made of it.
class FollowRun {
 public:
  /// statics must outlive it. Throws as FollowJob
  FollowRun(const Statics& statics, FollowTask task, const TrajectoryOptions& options, FollowFolder folder);

  [[nodiscard]] Run<WaypointRecord>& run() { return run_; }
  [[nodiscard]] std::vector<WaypointRecord> records() { return run_.log().all(); }
  [[nodiscard]] const MarkerPath& path() const { return task_.path; }

  [[nodiscard]] Table commands();
  [[nodiscard]] Table errors();
  /// Of the waypoints so far, at least one.
  [[nodiscard]] Plot plot();
  /// A step of the report, JSON.
  [[nodiscard]] std::string step_text(const WaypointRecord& record) const { return job_.codec().write(record); }
  /// Report, series, tables and plot into the folder; nothing without a waypoint.
  void finish();

 private:
  const Model& model_;
  FollowTask task_;
  double tolerance_mm_;
  FollowFolder folder_;
  FollowJob job_;
  Run<WaypointRecord> run_;
};

/// "55 waypoints, 55 reached to 0.001 mm: error at most 3.2e-04 mm, ...".
/// nearest: by samples, whose errors all count
[[nodiscard]] std::string summary_of(const std::vector<WaypointRecord>& done, double tolerance_mm, bool nearest);
/// The largest change of a command and step of a marker between neighbouring waypoints.
[[nodiscard]] std::string jumps_of(const std::vector<WaypointRecord>& done);
/// Which waypoints were not reached, and by how much at worst; empty where all were.
[[nodiscard]] std::string missed_text(const std::vector<WaypointRecord>& done, bool nearest);

}  // namespace softkin::runs
