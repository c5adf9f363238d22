#include <algorithm>
#include <chrono>
#include <mutex>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/kinematics/workspace.hpp>
#include <thread>
#include <utility>

namespace softkin {

namespace {

/// Groups of a plan in their order, and their samples.
class SampleDesk : public GroupDesk {
 public:
  explicit SampleDesk(const WorkspacePlan& plan) : plan_(plan) {}

  [[nodiscard]] std::optional<GroupTask> take() override {
    const std::lock_guard lock(mutex_);
    if (next_ == std::ssize(plan_.groups)) return std::nullopt;
    const std::size_t size = plan_.groups[next_].size();
    return GroupTask{next_++, std::vector<std::optional<Status>>(size)};
  }
  void keep(const WorkspaceSample& sample) override {
    const std::lock_guard lock(mutex_);
    samples_.push_back(sample);
  }
  [[nodiscard]] int count() {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(samples_.size());
  }
  /// In the order of their numbers, whatever threads made them.
  [[nodiscard]] std::vector<WorkspaceSample> finish() {
    std::sort(samples_.begin(), samples_.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
    return std::move(samples_);
  }

 private:
  const WorkspacePlan& plan_;
  std::mutex mutex_;
  Index next_ = 0;
  std::vector<WorkspaceSample> samples_;
};

double seconds_from(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

/// The grid, where it is not known; false where it was interrupted.
bool PathFollower::sample(InverseResult& spent, const ProgressCallback& progress) {
  if (samples_) return true;
  const auto start = std::chrono::steady_clock::now();
  const WorkspacePlan plan = plan_workspace(model_, {.samples = std::get<Index>(*options_.nearest)});
  SampleDesk desk(plan);
  const auto caller = std::this_thread::get_id();  // other threads are none of the callback's business
  const double error = goal_errors(model_, goals_of(path_, path_.waypoints.at(next_)), state_.positions).maxCoeff();
  bool stopped = false;
  const ProgressCallback reported = [&](const Progress&) {
    if (!progress || std::this_thread::get_id() != caller) return true;
    stopped = stopped || !progress({desk.count(), error, options_.inverse.tolerance_mm, -1});
    return !stopped;
  };
  const StaticsOptions& statics = options_.inverse.statics;
  const int threads =
      statics.threads > 0 ? statics.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  solve_groups(statics_, plan, statics, threads, desk, reported);
  spent.equilibria += desk.count();
  spent.seconds += seconds_from(start);
  if (stopped) return false;
  samples_.emplace(model_, desk.finish());
  return true;
}

InverseResult PathFollower::advance_nearest(const ProgressCallback& progress) {
  const Waypoint& waypoint = path_.waypoints.at(next_);
  const std::vector<Goal> goals = goals_of(path_, waypoint);
  InverseResult found;
  found.equilibrium.state = state_;
  found.equilibrium.actuation = state_.actuation.size() > 0 ? state_.actuation : model_.rest_actuation();
  found.active.assign(model_.actuators.size(), 0);
  found.errors_mm = goal_errors(model_, goals, state_.positions);
  const auto stop = [&] {
    found.status = InverseStatus::interrupted;
    found.stopped = true;
    return found;
  };
  if (!sample(found, progress)) return stop();
  const WorkspaceSample& nearest = samples_->samples()[samples_->find(goals).front()];
  clock_.set(waypoint.time, options_.inverse.statics);
  const auto solve = [&](const State& from) {
    found.equilibrium = statics_.solve(nearest.actuation, from, options_.inverse.statics, reported(progress));
    ++found.equilibria;
    found.seconds += found.equilibrium.report.seconds;
    return found.equilibrium.report.status == Status::converged || found.equilibrium.report.stopped;
  };
  if (!solve(state_)) (void)solve(statics_.rest());
  if (found.equilibrium.report.stopped) return stop();
  const bool converged = found.equilibrium.report.status == Status::converged;
  found.errors_mm = goal_errors(model_, goals, found.equilibrium.state.positions);
  const double error = found.errors_mm.maxCoeff();
  found.history.push_back(
      {nearest.actuation, found.equilibrium.report.status, error, found.equilibrium.report.iterations});
  found.status = !converged                               ? InverseStatus::not_converged
                 : error <= options_.inverse.tolerance_mm ? InverseStatus::reached
                                                          : InverseStatus::unreachable;
  if (found.status == InverseStatus::unreachable)
    found.remark = "the nearest of " + std::to_string(samples_->samples().size()) + " samples";
  if (!converged) found.remark = "the sample has no equilibrium from here: " + found.equilibrium.report.remark;
  if (converged) state_ = found.equilibrium.state;
  lost_mJ_.reset();
  if (converged) lost_mJ_ = clock_.pass(waypoint.time, state_);
  ++next_;
  return found;
}

}  // namespace softkin
