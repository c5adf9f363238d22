#pragma once

#include <filesystem>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/runs/jobs.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin::runs {

/// What a folder of a walk holds; an empty folder: nothing is written.
class WalkFolder {
 public:
  explicit WalkFolder(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

  [[nodiscard]] RunFiles run() const { return {in("report.json"), in("walk.pvd")}; }
  [[nodiscard]] std::filesystem::path table() const { return in("walk.csv"); }
  [[nodiscard]] std::filesystem::path plot() const { return in("walk.svg"); }

 private:
  [[nodiscard]] std::filesystem::path in(const char* name) const { return folder_.empty() ? folder_ : folder_ / name; }

  std::filesystem::path folder_;
};

/// What is walked, and how it is called.
struct WalkTask {
  std::string scene, gait;  // files, as the user named them
  std::vector<GaitStep> steps;
  std::size_t cycles = 0;
};

/// A walk, record by record, and what is made of it.
class WalkRun {
 public:
  /// model must outlive it. Throws InvalidInput as Walker does, and where the gait is not closed
  WalkRun(const Model& model, WalkTask task, const StaticsOptions& options, WalkFolder folder);

  [[nodiscard]] Run<WalkRecord>& run() { return run_; }
  [[nodiscard]] std::vector<WalkRecord> records() { return run_.log().all(); }
  [[nodiscard]] const Vec3& direction() const { return walker_.direction(); }

  /// Of the steps so far, at least one.
  [[nodiscard]] Plot plot();
  /// A step of the report, JSON.
  [[nodiscard]] std::string step_text(const WalkRecord& record) const { return job_.codec().write(record); }
  /// The strides so far into the report's head. Returns them [mm].
  std::vector<double> note_strides();
  /// Report, series, table and plot into the folder; nothing without a step.
  void finish();

 private:
  const Model& model_;
  WalkTask task_;
  WalkFolder folder_;
  Walker walker_;
  WalkJob job_;
  Run<WalkRecord> run_;
};

}  // namespace softkin::runs
