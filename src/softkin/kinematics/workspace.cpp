#include <algorithm>
#include <atomic>
#include <softkin/core/error.hpp>
#include <softkin/core/together.hpp>
#include <softkin/kinematics/workspace.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

namespace {

/// An equilibrium may belong to another branch than the one that the robot would reach where its distance from the
/// prediction exceeds both this fraction of the predicted motion from the group's middle and this fraction of the
/// robot's diagonal.
constexpr double max_correction = 0.5, min_snap = 0.01;

/// Moves the sample nearest to the mean to the front; distances in fractions of the ranges.
void begin_with_the_middle(const Model& model, const Actuations& actuations, std::vector<Index>& group) {
  const std::vector<Index> varied = varied_actuators(model);
  Eigen::MatrixXd fractions(varied.size(), group.size());
  for (std::size_t d = 0; d < varied.size(); ++d) {
    const Actuator& actuator = model.actuators[varied[d]];
    for (std::size_t i = 0; i < group.size(); ++i)
      fractions(d, i) = (actuations(group[i], varied[d]) - actuator.low) / (actuator.high - actuator.low);
  }
  const Eigen::VectorXd mean = fractions.rowwise().mean();
  Index middle = 0;
  (fractions.colwise() - mean).colwise().squaredNorm().minCoeff(&middle);
  std::rotate(group.begin(), group.begin() + middle, group.begin() + middle + 1);
}

class Group {
 public:
  Group(const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options,
        const ProgressCallback& progress)
      : model_(statics.model()), statics_(statics), plan_(plan), options_(one_of_many(options)), progress_(progress) {}

  /// Nothing where progress stopped it.
  std::optional<WorkspaceSample> solve(Index number) {
    const Actuation actuation = plan_.actuations.row(number);
    Equilibrium found =
        around_ ? from_middle(actuation) : statics_.solve(actuation, statics_.rest(), options_, progress_);
    if (around_ && failed(found)) {
      const int before = found.report.iterations;
      found = statics_.solve(actuation, statics_.rest(), options_, progress_);
      found.report.iterations += before;
    }
    if (found.report.stopped) return std::nullopt;
    WorkspaceSample sample = sample_of(found, number);
    if (!around_ && found.report.status == Status::converged) {
      around_.emplace(statics_, found.state);
      middle_ = std::move(found.state);
    }
    return sample;
  }

 private:
  [[nodiscard]] static bool failed(const Equilibrium& found) {
    return found.report.status != Status::converged && !found.report.stopped;
  }

  [[nodiscard]] Equilibrium from_middle(const Actuation& actuation) {
    const State predicted = around_->predict(actuation);
    Equilibrium found = statics_.solve(actuation, predicted, options_, progress_);
    const double correction = largest_move(predicted.positions, found.state.positions);
    const double move = largest_move(middle_.positions, predicted.positions);
    const bool snapped = model_.formulation == Formulation::physical && correction > max_correction * move &&
                         correction > min_snap * model_.diagonal_mm;
    if (found.report.stopped || !(failed(found) || snapped)) return found;
    const int before = found.report.iterations;
    found = statics_.solve(actuation, middle_, options_, progress_);
    found.report.iterations += before;
    return found;
  }

  [[nodiscard]] WorkspaceSample sample_of(const Equilibrium& found, Index number) const {
    WorkspaceSample sample;
    sample.number = number;
    sample.actuation = found.actuation;
    sample.status = found.report.status;
    sample.iterations = found.report.iterations;
    const bool limit = sample.status == Status::limit && found.report.reached > 0;
    if (sample.status != Status::converged && !limit) return sample;
    sample.reached = limit ? found.report.reached : 1;
    sample.multipliers = found.state.multipliers;
    sample.markers.resize(model_.markers.size(), 3);
    for (std::size_t p = 0; p < model_.markers.size(); ++p)
      sample.markers.row(p) = model_.markers[p].at(found.state.positions);
    return sample;
  }

  const Model& model_;
  const Statics& statics_;
  const WorkspacePlan& plan_;
  StaticsOptions options_;
  const ProgressCallback& progress_;
  State middle_;  // the first equilibrium of the group
  std::optional<Neighbourhood> around_;
};

}  // namespace

Index group_size(Index samples) {
  return std::clamp<Index>(samples / 50, 8, 64);
}

WorkspacePlan plan_workspace(const Model& model, const SamplingOptions& options) {
  WorkspacePlan plan;
  plan.actuations = sample_actuations(model, options);
  const std::vector<Index> order = order_of_neighbours(model, plan.actuations);
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = begin + std::min<std::ptrdiff_t>(group_size(options.samples), order.end() - begin);
    begin_with_the_middle(model, plan.actuations, plan.groups.emplace_back(begin, end));
    begin = end;
  }
  return plan;
}

bool solve_group(const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options,
                 const GroupTask& task, const std::function<void(const WorkspaceSample&)>& give,
                 const ProgressCallback& progress) {
  const std::vector<Index>& samples = plan.groups.at(task.group);
  const auto is_missing = [](const std::optional<Status>& known) { return !known; };
  auto missing = std::count_if(task.known.begin(), task.known.end(), is_missing);
  Group group(statics, plan, options, progress);
  bool has_middle = false;
  for (std::size_t i = 0; i < samples.size() && missing > 0; ++i) {
    const std::optional<Status>& known = task.known.at(i);
    if (known && (has_middle || *known != Status::converged)) continue;
    const std::optional<WorkspaceSample> sample = group.solve(samples[i]);  // known: for its shape
    if (!sample) return false;
    has_middle = has_middle || sample->status == Status::converged;
    if (known) continue;
    give(*sample);
    --missing;
  }
  return true;
}

void solve_groups(const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options, int threads,
                  GroupDesk& desk, const ProgressCallback& progress) {
  std::atomic<bool> stopped = false;
  const ProgressCallback go_on = [&](const Progress& p) { return !stopped && (!progress || progress(p)); };
  work_together(threads, stopped, [&] {
    const std::optional<GroupTask> task = desk.take();
    if (!task) return false;
    const auto keep = [&](const WorkspaceSample& sample) { desk.keep(sample); };
    if (!solve_group(statics, plan, options, *task, keep, go_on)) stopped = true;
    return true;
  });
}

}  // namespace softkin
