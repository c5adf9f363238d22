#pragma once

#include <functional>
#include <softkin/core/progress.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/kinematics/walk.hpp>
#include <softkin/model/model.hpp>
#include <softkin/runs/record_log.hpp>
#include <softkin/runs/turns.hpp>
#include <utility>

namespace softkin::runs {

/// Something long that is done record by record, each from the one before.
template <class Record>
class Job {
 public:
  /// A record with its shape.
  struct Made {
    Record record;                   // stopped: not the requested one, but the last good shape on its path
    State state;                     // the shape, its commands and loads
    ElementDeformation deformation;  // what the shape measures
  };

  virtual ~Job() = default;
  /// How many records there are to make.
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// How they are written and read.
  [[nodiscard]] virtual Codec<Record> codec() const = 0;

  /// Returns why a record is not the requested one of that number; empty: it is.
  [[nodiscard]] virtual std::string mismatch(std::size_t number, const Record& record) const = 0;

  /// Makes the record of that number, after the one before was made or go_on() was called.
  [[nodiscard]] virtual Made make(std::size_t number, const ProgressCallback& progress) = 0;

  /// Can the run continue from this record? Else it ends before it.
  [[nodiscard]] virtual bool keeps(const Record&) const { return true; }

  /// Takes note of a record that was made before, in their order, before go_on(); where it needs all of them.
  [[nodiscard]] virtual bool recalls() const { return false; }
  virtual void recall(const Record&, const Points&) {}

  /// Forgets everything but the record before that number and its shape: what is made from here on is a function of
  /// these alone.
  virtual void go_on(std::size_t number, const Record& before, Points positions) = 0;
};

/// The end of a step of a run: a record; it was stopped; or a record that the run cannot continue from (Job::keeps).
enum class Advance { made, interrupted, lost };

/// A job and its log. Now and then the job forgets all but the last record, so that a run that is resumed makes again
/// the few records since then and runs on as if it had never been stopped: bit by bit, with the same number of threads.
template <class Record>
class Run {
 public:
  /// A record with its shape.
  using Made = typename Job<Record>::Made;
  static constexpr std::size_t fresh_every = 32;  // records; a fresh start costs about one factorisation

  /// model and job must outlive the object; head and same: as RecordLog has them.
  Run(const Model& model, Job<Record>& job, RunFiles files, std::string head, std::vector<std::string> same)
      : model_(model), job_(job), files_(files), log_(model, files, std::move(head), std::move(same), job.codec()) {}

  /// How many records there are to make.
  [[nodiscard]] std::size_t size() const { return job_.size(); }
  /// How many of them are on disk.
  [[nodiscard]] std::size_t done() const { return log_.size(); }
  /// Are all of them?
  [[nodiscard]] bool is_complete() const { return done() >= size(); }
  /// What was made last, kept or not.
  [[nodiscard]] const Record& last() const { return last_; }
  [[nodiscard]] const Points& last_positions() const { return state_.positions; }
  /// None before anything was made.
  [[nodiscard]] const ElementDeformation& last_deformation() const { return deformation_; }
  [[nodiscard]] const State& last_state() const { return state_; }
  /// The record that advance() was stopped in; null where it was not.
  [[nodiscard]] const Made* stopped() const { return stopped_ ? &*stopped_ : nullptr; }
  [[nodiscard]] TypedLog<Record>& log() { return log_; }

  /// Of a record and its shape; of one that was made: with its deformation.
  using Watcher = std::function<void(const Record&, const Points&, const ElementDeformation*)>;
  /// Called with every record in their order: those that resume() takes over and those that are made.
  void watch(Watcher watcher) { watcher_ = std::move(watcher); }

  /// Takes over what is on disk. remark: for the user. Throws as RecordLog::resume
  void resume(std::string& remark) {
    log_.resume([this](std::size_t number, const Record& record) { return job_.mismatch(number, record); }, remark);
    if (done() == 0) return;
    if (watcher_)
      log_.each([this](std::size_t number, const Record& record) {
        watcher_(record, log_.shape_of(number, record).value(), nullptr);
      });
    last_ = log_.at(done() - 1);
    state_ = state_of(model_, last_, log_.shape_of(done() - 1, last_).value());
    resumed_ = true;
  }

  /// The next record, onto the disk.
  [[nodiscard]] Advance advance(const ProgressCallback& progress) {
    if (std::exchange(resumed_, false) && !repeat(progress)) {
      resumed_ = true;
      return Advance::interrupted;
    }
    log_.begin();
    const std::size_t number = done();
    if (number > 0 && number % fresh_every == 0) job_.go_on(number, last_, state_.positions);
    auto made = job_.make(number, progress);
    if (number > 0)
      made.record.marker_turns =
          continued_marker_turns(model_, made.state.positions, last_.marker_turns, state_.positions);
    if (made.record.stopped) {
      stopped_ = std::move(made);
      return Advance::interrupted;
    }
    const bool keeps = job_.keeps(made.record);
    if (keeps) log_.add(made.record, made.state, made.deformation);
    last_ = std::move(made.record);
    state_ = std::move(made.state);
    deformation_ = std::move(made.deformation);
    if (keeps && watcher_) watcher_(last_, state_.positions, &deformation_);
    return keeps ? Advance::made : Advance::lost;
  }

  /// Writes the report and the series' collection of the completed records; where the run was stopped, also the shape
  /// on the path to the next record.
  void finish() {
    if (stopped_) log_.add_stopped(stopped_->record, stopped_->state, stopped_->deformation);
    if (done() > 0 && !files_.shapes.empty()) {
      std::vector<PvdEntry> entries;
      log_.each([&](std::size_t number, const Record& record) {
        entries.push_back({record.time_s.value_or(static_cast<double>(number)), record.shape});
      });
      write_pvd(files_.shapes, entries);
    }
    log_.finish();
  }

 private:
  /// Makes the records since the last fresh start again, so that the job regains its state. False: interrupted.
  [[nodiscard]] bool repeat(const ProgressCallback& progress) {
    const std::size_t end = done(), begin = end - end % fresh_every;
    if (job_.recalls())
      log_.each([&](std::size_t number, const Record& record) {
        if (number < begin) job_.recall(record, log_.shape_of(number, record).value());
      });
    if (begin == end) return true;
    if (begin > 0) {
      const Record before = log_.at(begin - 1);
      job_.go_on(begin, before, log_.shape_of(begin - 1, before).value());
    }
    for (std::size_t number = begin; number < end; ++number) {
      const auto made = job_.make(number, progress);
      if (made.record.stopped) return false;
      if (number + 1 < end) continue;
      // another machine, or another number of threads, ends a rounding away: what is on disk counts
      if (fingerprint_of(made.state.positions) != last_.shape_fingerprint) job_.go_on(end, last_, state_.positions);
    }
    return true;
  }

  const Model& model_;
  Job<Record>& job_;
  RunFiles files_;
  TypedLog<Record> log_;
  Watcher watcher_{};
  Record last_;
  State state_;
  ElementDeformation deformation_{};
  std::optional<Made> stopped_;
  bool resumed_ = false;
};

/// Equilibria along a path of actuations, each from the last.
class PathJob : public Job<StepRecord> {
 public:
  /// All must outlive the job. file: of the steps, for messages; start: of the first step, none: rest
  PathJob(const Statics& statics, const std::vector<ActuationStep>& steps, std::string file,
          const StaticsOptions& options, std::optional<State> start = {});

  [[nodiscard]] std::size_t size() const override { return steps_.size(); }
  [[nodiscard]] Codec<StepRecord> codec() const override;
  [[nodiscard]] std::string mismatch(std::size_t number, const StepRecord& record) const override;
  [[nodiscard]] Made make(std::size_t number, const ProgressCallback& progress) override;
  [[nodiscard]] bool recalls() const override { return clock_.counts(steps_.front().time); }
  void recall(const StepRecord& record, const Points& positions) override;
  void go_on(std::size_t number, const StepRecord& before, Points positions) override;

 private:
  const Model& model_;
  const Statics& statics_;
  const std::vector<ActuationStep>& steps_;
  std::vector<Actuation> acting_;  // of each step, by its commands and those before
  std::string file_;
  StaticsOptions options_;
  ViscousClock clock_;
  State state_;
  OverlapSearch overlap_;
};

/// Inverse kinematics along a path of markers.
class FollowJob : public Job<WaypointRecord> {
 public:
  /// All must outlive the job. file: of the path, for messages. Throws as PathFollower.
  FollowJob(const Statics& statics, const MarkerPath& path, std::string file, const TrajectoryOptions& options);

  [[nodiscard]] std::size_t size() const override { return path_.waypoints.size(); }
  [[nodiscard]] Codec<WaypointRecord> codec() const override;
  [[nodiscard]] std::string mismatch(std::size_t number, const WaypointRecord& record) const override;
  [[nodiscard]] Made make(std::size_t number, const ProgressCallback& progress) override;
  [[nodiscard]] bool recalls() const override { return statics_.viscous() && path_.waypoints.front().time; }
  void recall(const WaypointRecord& record, const Points& positions) override;
  void go_on(std::size_t number, const WaypointRecord& before, Points positions) override;

 private:
  const Model& model_;
  const Statics& statics_;
  const MarkerPath& path_;
  std::string file_;
  PathFollower follower_;
  OverlapSearch overlap_;
  WaypointRecord last_;
};

/// A row of a gait within the walk.
struct GaitStep {
  ActuationStep requested;  // its time goes on from cycle to cycle
  std::size_t cycle = 0;    // from 1; 0: where the robot is put down
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
  [[nodiscard]] Made make(std::size_t number, const ProgressCallback& progress) override;
  [[nodiscard]] bool keeps(const WalkRecord& record) const override { return record.status == Status::converged; }
  void go_on(std::size_t number, const WalkRecord& before, Points positions) override;

 private:
  const Model& model_;
  Walker& walker_;
  const std::vector<GaitStep>& steps_;
  std::string file_;
  OverlapSearch overlap_;
};

}  // namespace softkin::runs
