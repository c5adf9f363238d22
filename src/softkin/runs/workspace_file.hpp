#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <softkin/io/table/workspace_table.hpp>
#include <softkin/kinematics/goal.hpp>
#include <softkin/kinematics/hull.hpp>
#include <softkin/kinematics/workspace.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin {
struct Plot;  // io/plot/svg_plot.hpp
}

namespace softkin::runs {

class Store;  // store.hpp

/// The columns of a workspace of the robot: tendon1 or air_kPa; tip_x_mm, tip_y_mm, tip_z_mm; tendon1_tension_N or
/// air_pressure_kPa (physical formulation).
[[nodiscard]] WorkspaceColumns workspace_columns(const Model& model);

/// What the samples are a function of, each a line of the file: softkin's version, the robot's fingerprint, the solver
/// with those of its options that are not the defaults, the sampling with its ranges, the number of samples.
[[nodiscard]] WorkspaceHead workspace_head(const Model& model, const SamplingOptions& sampling,
                                           const StaticsOptions& solver);

/// "grid of 15 x 15 x 15", "sobol" or "random, seed 7".
[[nodiscard]] std::string sampling_text(const Model& model, const SamplingOptions& sampling);

/// The samples on disk. While they are solved the file grows, a whole row at a time, in the order in which they come;
/// the rows alone say what has been done. At the end it is put in the order of the samples.
class WorkspaceFile {
 public:
  /// Begins the file or, with resume, continues it. columns must outlive it.
  ///
  /// throws  InvalidInput where there is an unfinished workspace that is not to be resumed, or one of another robot,
  ///         solver or sampling that is; where another softkin is at work on it; where it cannot be written
  WorkspaceFile(std::filesystem::path path, const WorkspaceHead& head, const WorkspaceColumns& columns,
                const WorkspacePlan& plan, bool resume);
  ~WorkspaceFile();
  WorkspaceFile(const WorkspaceFile&) = delete;
  WorkspaceFile& operator=(const WorkspaceFile&) = delete;

  /// How many samples are in the file.
  [[nodiscard]] Index done() const;
  /// Are all of them?
  [[nodiscard]] bool complete() const;
  /// A last row was so; it is solved again.
  [[nodiscard]] bool was_torn() const;
  /// Samples that ended so.
  [[nodiscard]] Index count(Status status) const;
  /// Samples of which there is no shape, not even a last good one.
  [[nodiscard]] Index count_without_shape() const { return without_shape_; }
  [[nodiscard]] const std::optional<Status>& known(Index sample) const { return known_[sample]; }

  /// Appends the row. Throws as Store::append
  void add(const WorkspaceSample& sample);

  /// Replaces the file by one in the order of the samples, and gives them. All of them must be done.
  [[nodiscard]] std::vector<WorkspaceSample> finish();

 private:
  void note(const WorkspaceSample& sample);
  void take(const WorkspaceTable& table, const WorkspaceHead& head, const WorkspacePlan& plan);

  std::filesystem::path path_;
  const WorkspaceColumns& columns_;
  std::vector<std::optional<Status>> known_;  // per sample
  Index without_shape_ = 0;
  std::unique_ptr<Store> store_;
};

/// The samples of a workspace of the robot.
///
/// throws  InvalidInput naming file and line: no workspace of this robot
[[nodiscard]] std::vector<WorkspaceSample> samples_of(const Model& model, const std::string& workspace);

/// The actuation of the sample of a workspace at which the goals are nearest to being met.
///
/// throws  InvalidInput naming file and line: no workspace of this robot, no sample with an equilibrium
[[nodiscard]] Actuation nearest_actuation(const Model& model, const std::string& workspace,
                                          const std::vector<Goal>& goals);

/// What a finished workspace shows of one marker.
struct Reach {
  std::string marker;                    // its name
  std::vector<WorkspaceSample> samples;  // those with equilibria
  Points positions;                      // of the marker, #samples by 3 [mm]
  std::optional<Hull> hull{};            // where it is requested and there are samples
};

/// The marker of that name; empty: the first. Throws InvalidInput on a robot without markers or an unknown name
[[nodiscard]] Index shown_marker(const Model& model, const std::string& name);

/// throws  as shown_marker
[[nodiscard]] Reach reach_of(const Model& model, std::vector<WorkspaceSample> samples, const std::string& marker,
                             bool with_hull);

/// What a hull is called, and its measure.
[[nodiscard]] std::string hull_text(const Hull& hull);

/// The positions as points, with actuation and loads.
void write_cloud(const std::filesystem::path& path, const Model& model, const Reach& reach);
/// STL or .vtu, by its name. hull: one with triangles
void write_hull(const std::filesystem::path& path, const Hull& hull);
/// The positions, seen along the axes.
[[nodiscard]] Plot plot_of_reach(const Reach& reach);

/// JSON of what a workspace with such a head came to. samples: in all; count: of those that ended so
[[nodiscard]] std::string workspace_summary(const std::string& scene, const WorkspaceHead& head, const Reach& reach,
                                            Index samples, const std::function<Index(Status)>& count, double seconds);

}  // namespace softkin::runs
