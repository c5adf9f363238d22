#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <softkin/statics/target_shape/local_global.hpp>
#include <utility>

namespace softkin::target_shape {

namespace {

/// Accelerated steps may temporarily raise the energy a little, and must where R_omega < 1 or ratios are redistributed;
/// those that raise it more lead to other equilibria.
constexpr double tolerated_growth = 1.2;

/// How far the fixed point may be: the step over the least change of steps per change of shape in the last iterations,
/// which for a linear iteration x <- G x is bounded by 1 - (largest eigenvalue of G), accelerated or not.
class ErrorEstimate {
 public:
  void add(const Points& at, const Points& step) {
    if (last_at_.size() > 0) {
      const double moved = (at - last_at_).norm();
      if (moved > 0) slopes_[count_++ % slopes_.size()] = (step - last_step_).norm() / moved;
    }
    last_at_ = at;
    last_step_ = step;
  }
  [[nodiscard]] double mm(double step_mm) const {
    double least = 1;
    for (std::size_t i = 0; i < std::min(count_, slopes_.size()); ++i) least = std::min(least, slopes_[i]);
    return step_mm / std::max(least, 1e-9);
  }

 private:
  Points last_at_, last_step_;
  std::array<double, 20> slopes_{};
  std::size_t count_ = 0;
};

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Detects iterations without progress: over a given number of them the least step is hardly shorter than before, or is
/// still far from the tolerance at that rate.
class Stall {
 public:
  Stall(const Patience& patience, double tolerance_mm) : patience_(patience), tolerance_mm_(tolerance_mm) {}

  [[nodiscard]] bool add(const IterationRecord& record) {
    constexpr double hardly = 0.9, no_smaller = 1 - 1e-6;
    step_mm_ = std::min(step_mm_, record.step_mm);
    energy_ = std::min(energy_, record.energy);
    if (++count_ % patience_.iterations != 0) return false;
    const double left = patience_.iterations * std::log(step_mm_ / tolerance_mm_) / std::log(best_step_mm_ / step_mm_);
    const bool slow = step_mm_ > hardly * best_step_mm_ || left > patience_.max_left;
    const bool stalled = slow && !(patience_.descends && energy_ <= no_smaller * best_energy_);
    best_step_mm_ = std::min(best_step_mm_, std::exchange(step_mm_, unlimited));
    best_energy_ = std::min(best_energy_, std::exchange(energy_, unlimited));
    return stalled;
  }

 private:
  double step_mm_ = unlimited, energy_ = unlimited;  // least in this window
  double best_step_mm_ = unlimited, best_energy_ = unlimited;
  Patience patience_;
  double tolerance_mm_;
  int count_ = 0;
};

double largest_marker_move(const Model& model, const Points& before, const Points& after) {
  double largest = 0;
  for (const Marker& marker : model.markers) largest = std::max(largest, (marker.at(after) - marker.at(before)).norm());
  return largest;
}

bool has_arrived(const Model& model, const LocalGlobal& iteration, bool as_published, const SolveReport& report) {
  if (!as_published) return report.step_mm < report.tolerance_mm;
  return report.iterations >= PublishedStop::first_iteration &&
         largest_marker_move(model, iteration.before(), iteration.positions()) < PublishedStop::move_mm;
}

}  // namespace

void accept(const IterationRecord& record, bool keep_history, SolveReport& report) {
  ++report.iterations;
  report.energy = record.energy;
  report.step_mm = record.step_mm;
  report.gradient_norm = record.gradient_norm;
  if (keep_history) report.history.push_back(record);
}

LocalGlobal::LocalGlobal(const System& system, const supports::GlobalStep& global, int anderson,
                         const Actuation& actuation, Points& positions)
    : system_(system),
      global_(global),
      anderson_(anderson),
      mixer_(anderson),
      actuation_(actuation),
      positions_(positions),
      poses_(global.project(actuation, positions)),
      tolerated_(unlimited) {
  accepted_ = positions;
}

bool LocalGlobal::iterate(System::Scratch& scratch, Team& team, IterationRecord& record) {
  record.energy = system_.local_step(actuation_, positions_, scratch, team);
  if (record.energy > tolerated_) {  // the extrapolation diverged: continue from the plain step
    positions_ = accepted_;
    poses_ = global_.project(actuation_, positions_);
    mixer_.restart();
    record.energy = system_.local_step(actuation_, positions_, scratch, team);
  }
  record.gradient_norm = 2 * global_.free_norm(scratch.residual, poses_);
  tolerated_ = anderson_ > 0 ? tolerated_growth * record.energy : unlimited;
  before_ = positions_;
  global_.step(scratch.residual, positions_, poses_, team);
  record.step_mm = largest_move(before_, positions_);
  // the squares of far-off coordinates overflow
  if (!std::isfinite(record.energy + record.gradient_norm + record.step_mm) || !positions_.allFinite()) {
    positions_ = accepted_;
    return false;
  }
  return true;
}

void LocalGlobal::extrapolate() {
  accepted_ = positions_;
  if (anderson_ == 0) return;
  positions_ = mixer_.next(before_, positions_);
  poses_ = global_.project(actuation_, positions_);
}

void solve_local_global(const Steps& steps, const StaticsOptions& options, const Patience& patience,
                        const ProgressCallback& progress, Team& team, Equilibrium& result) {
  SolveReport& report = result.report;
  report.solver = "local-global";
  if (options.as_published) report.tolerance_mm = PublishedStop::move_mm;
  const int anderson = options.as_published ? 0 : options.anderson;
  LocalGlobal iteration(steps.system, steps.global, anderson, result.actuation, result.state.positions);
  System::Scratch scratch = steps.system.make_scratch();
  ErrorEstimate estimate;
  Stall stall(patience, report.tolerance_mm);
  for (;;) {
    IterationRecord record;
    if (!iteration.iterate(scratch, team, record)) {
      report.remark = "the coordinates became too large to compute with";
      break;
    }
    accept(record, options.keep_history, report);
    estimate.add(iteration.before(), iteration.positions() - iteration.before());
    if (has_arrived(steps.model, iteration, options.as_published, report)) {
      report.status = Status::converged;
      break;
    }
    if (progress && !progress({report.iterations, report.step_mm, report.tolerance_mm})) {
      report.status = Status::interrupted;
      break;
    }
    if (stall.add(record)) {
      report.remark = "the last " + std::to_string(patience.iterations) + " iterations led nowhere";
      break;
    }
    iteration.extrapolate();
  }
  report.estimated_error_mm = estimate.mm(report.step_mm);
}

}  // namespace softkin::target_shape
