#pragma once

#include <softkin/io/table/actuation_path.hpp>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/kinematics/walk.hpp>
#include <softkin/runs/job.hpp>

namespace softkin::runs {

/// Equilibria along a path of actuations, each from the last.
class PathJob : public Job<StepRecord> {
 public:
  /// All must outlive the job. file: of the steps, for messages
  PathJob(const Model& model, const Statics& statics, const std::vector<ActuationStep>& steps, std::string file,
          const StaticsOptions& options);

  [[nodiscard]] std::size_t size() const override { return steps_.size(); }
  [[nodiscard]] Codec<StepRecord> codec() const override;
  [[nodiscard]] std::string mismatch(std::size_t number, const StepRecord& record) const override;
  [[nodiscard]] std::optional<Made> make(std::size_t number, const ProgressCallback& progress) override;
  void go_on(std::size_t number, const StepRecord& before, Points positions) override;

 private:
  const Model& model_;
  const Statics& statics_;
  const std::vector<ActuationStep>& steps_;
  std::string file_;
  StaticsOptions options_;
  State state_;
};

/// Inverse kinematics along a path of markers.
class FollowJob : public Job<WaypointRecord> {
 public:
  /// All must outlive the job. file: of the path, for messages. Throws as PathFollower.
  FollowJob(const Model& model, const Statics& statics, const MarkerPath& path, std::string file,
            const TrajectoryOptions& options);

  [[nodiscard]] std::size_t size() const override { return path_.waypoints.size(); }
  [[nodiscard]] Codec<WaypointRecord> codec() const override;
  [[nodiscard]] std::string mismatch(std::size_t number, const WaypointRecord& record) const override;
  [[nodiscard]] std::optional<Made> make(std::size_t number, const ProgressCallback& progress) override;
  void go_on(std::size_t number, const WaypointRecord& before, Points positions) override;

 private:
  const Model& model_;
  const Statics& statics_;
  const MarkerPath& path_;
  std::string file_;
  PathFollower follower_;
};

/// A row of a gait, on its way.
struct GaitStep {
  ActuationStep asked;    // its time goes on from cycle to cycle
  std::size_t cycle = 0;  // from 1; 0: where the robot is put down
};

/// The gait so many times. Throws InvalidInput, naming file and line, where its last row is not its first one again
[[nodiscard]] std::vector<GaitStep> repeated(const Model& model, const std::string& file,
                                             const std::vector<ActuationStep>& gait, std::size_t cycles);

/// A walk. A step without an equilibrium ends it.
class WalkJob : public Job<WalkRecord> {
 public:
  /// All must outlive the job. file: of the gait, for messages
  WalkJob(const Model& model, Walker& walker, const std::vector<GaitStep>& steps, std::string file);

  [[nodiscard]] std::size_t size() const override { return steps_.size(); }
  [[nodiscard]] Codec<WalkRecord> codec() const override;
  [[nodiscard]] std::string mismatch(std::size_t number, const WalkRecord& record) const override;
  [[nodiscard]] std::optional<Made> make(std::size_t number, const ProgressCallback& progress) override;
  [[nodiscard]] bool keeps(const WalkRecord& record) const override { return record.status == Status::converged; }
  void go_on(std::size_t number, const WalkRecord& before, Points positions) override;

 private:
  const Model& model_;
  Walker& walker_;
  const std::vector<GaitStep>& steps_;
  std::string file_;
};

}  // namespace softkin::runs
