#include <algorithm>
#include <cmath>
#include <softkin/statics/target_shape/newton.hpp>
#include <utility>

namespace softkin::target_shape {

using namespace energy;

namespace {

/// Energy of Eq. (9) that the rounding of coordinates alone can make, in its unit.
double rounding_energy(const Model& model, const ElementSets& sets) {
  double weight = 0;
  const auto add = [&weight](const auto& set) {
    for (const auto& block : set.blocks) weight += energy::sum(block.weight);
  };
  if (model.weights == ElementWeights::printed) {
    for (const double v : model.elements.tetrahedron_volumes) weight += v;
    for (const double v : model.elements.prism_volumes) weight += v;
  } else {
    add(sets.tetrahedra);
    add(sets.prisms);
  }
  const double rounding = 1e-14 * model.diagonal_mm;
  return weight * rounding * rounding;
}

using End = NewtonSearch::End;

/// Follows intermediate equilibria from one actuation to another; the step is halved where one is not found and doubled
/// where one is.
End follow(const Actuation& from, const Actuation& to, const TargetShapeOptions& options, NewtonSearch& search,
           Points& positions, SolveReport& report) {
  double fraction = 0, step = options.first_fraction;
  Points reached = positions;
  report.continuation_steps = 0;
  while (fraction < 1) {
    const double next = std::min(1.0, fraction + step);
    positions = reached;
    const End end = search.run(from + next * (to - from), options.max_intermediate_steps, 0, positions);
    if (end == End::interrupted || end == End::astray) return end;
    if (end == End::converged) {
      fraction = next;
      step *= 2;
      reached = positions;
      ++report.continuation_steps;
    } else {
      step /= 2;
      if (step < options.min_fraction) return End::stuck;
    }
  }
  return End::converged;
}

}  // namespace

Workspace::Workspace(const Unknowns& unknowns)
    : tangent(unknowns),
      local(unknowns.system.make_scratch()),
      start(unknowns.system.make_scratch()),
      work(unknowns.system.make_scratch()) {}

NewtonSearch::NewtonSearch(const Unknowns& unknowns, const supports::GlobalStep& global, Workspace& workspace,
                           const StaticsOptions& options, const ProgressCallback& progress, Team& team,
                           SolveReport& report)
    : unknowns_(unknowns),
      global_(global),
      options_(options),
      progress_(progress),
      team_(team),
      report_(report),
      workspace_(workspace) {
  // rotations are searched for from the last ones: those of an earlier search would show in the last digits
  for (auto& rotations : workspace_.local.rotations) std::fill(rotations.begin(), rotations.end(), PackRotation{});
}

/// Makes the local step at positions, which are projected to the supports before.
void NewtonSearch::evaluate(const Actuation& actuation, Points& positions) {
  poses_ = global_.project(actuation, positions);
  energy_ = unknowns_.system.local_step(actuation, positions, workspace_.local, team_);
}

/// Computes the exact step; false where that fails.
bool NewtonSearch::exact_direction(const Points& positions) {
  if (!direction_.keep_factor) {
    if (!workspace_.tangent.factorise(workspace_.local, positions, false, team_, report_)) return false;
    (void)natural_norm(positions);
  }
  direction_.keep_factor = false;
  // Eisenstat and Walker 1996, choice 2: as accurate as the last steps were successful, and as is needed at last
  const double norm = moves_.norm(), ratio = natural_start_ > 0 ? norm / natural_start_ : 1;
  const double enough = 0.1 * report_.tolerance_mm / std::max(norm, report_.tolerance_mm);
  tolerance_ =
      std::clamp(0.9 * ratio * ratio, std::clamp(enough, tuning().tightest_tolerance, tuning().loosest_tolerance),
                 tuning().loosest_tolerance);
  natural_start_ = norm;
  direction_.exact = !workspace_.tangent.symmetric() || !workspace_.tangent.shifted();
  return workspace_.tangent.solve(workspace_.local, positions, natural_, tolerance_, team_, step_) && step_.allFinite();
}

/// The step with the positive semidefinite matrices near the exact ones: it goes down in the energy at fixed targets.
bool NewtonSearch::projected_direction(const Points& positions) {
  if (!workspace_.tangent.factorise(workspace_.local, positions, true, team_, report_)) return false;
  natural_start_ = 0;
  direction_.exact = false;
  step_ = residual_;
  workspace_.tangent.precondition(step_, team_);
  return step_.allFinite() && step_.dot(residual_) > 0;
}

/// The residual seen through the preconditioner: natural_ over the unknowns, moves_ over the vertices, whose Euclidean
/// norm it returns [mm].
double NewtonSearch::natural_norm(const Points& positions) {
  workspace_.tangent.reduce(workspace_.local.residual, positions, natural_);
  workspace_.tangent.precondition(natural_, team_);
  workspace_.tangent.freedoms().expand(natural_, positions, moves_);
  return moves_.norm();
}

/// Is it a whole, exact step that ends the search? Its change of energy or residual may be rounding.
bool NewtonSearch::negligible(int halvings, const Points& positions) const {
  return halvings == 0 && direction_.exact && largest_move(before_, positions) < report_.tolerance_mm;
}

/// Is it a fixed point of Algorithm 1, too? Where best-fit rotations are about to turn over, many small steps of
/// Newton's method follow.
bool NewtonSearch::at_fixed_point(const Points& positions) {
  Points next = positions;
  std::vector<supports::Pose> poses = poses_;
  global_.step(workspace_.local.residual, next, poses, team_);
  return largest_move(positions, next) < report_.tolerance_mm;
}

/// Takes another step with the last factor if it ends the search.
bool NewtonSearch::close(const Actuation& actuation, Points& positions, double& step_mm) {
  if (workspace_.tangent.shifted()) return false;
  if (workspace_.tangent.symmetric()) (void)natural_norm(positions);  // else search_residual did it
  step_mm = moves_.rowwise().norm().maxCoeff();
  if (!(step_mm < tuning().safe_step * report_.tolerance_mm)) return false;
  workspace_.tangent.freedoms().move(natural_, 1, positions);
  evaluate(actuation, positions);
  direction_.keep_factor = false;
  return at_fixed_point(positions);
}

/// Backtracking to a sufficient decrease (Armijo) of the energy; below its rounding any step is as good.
NewtonSearch::Step NewtonSearch::search_energy(const Actuation& actuation, Points& positions) {
  constexpr double rounding = 1e-12;
  const double start = energy_, slope = -2 * residual_.dot(step_);
  double scale = 1;
  const int halvings = workspace_.tangent.symmetric() ? tuning().max_halvings : tuning().few_halvings;
  for (int i = 0; i <= halvings; ++i, scale /= 2) {
    move(scale, positions);
    evaluate(actuation, positions);
    if (negligible(i, positions) || energy_ <= start + tuning().armijo * scale * slope + rounding * start)
      return i == 0 ? Step::full : Step::shortened;
  }
  return Step::none;
}

/// Backtracks until the preconditioned residual falls, with one preconditioner (Deuflhard 2004, Section 3.3), or the
/// energy falls well below its minimum so far, which is the better criterion far from the fixed point.
NewtonSearch::Step NewtonSearch::search_residual(const Actuation& actuation, Points& positions) {
  double scale = 1;
  for (int i = 0; i <= tuning().few_halvings; ++i, scale /= 2) {
    move(scale, positions);
    evaluate(actuation, positions);
    const double norm = natural_norm(positions);
    if (negligible(i, positions) || norm <= (1 - scale / 4) * natural_start_ ||
        energy_ < tuning().energy_drop * min_energy_) {
      direction_.keep_factor = i == 0 && norm < tuning().kept_factor * natural_start_;
      return i == 0 ? Step::full : Step::shortened;
    }
  }
  return Step::none;
}

/// Moves from before_ by a fraction of the step, including the rotations of the targets that it causes: parts that bend
/// far then bend instead of growing along the tangents.
void NewtonSearch::move(double scale, Points& positions) {
  scaled_ = scale * step_;
  workspace_.tangent.freedoms().expand(scaled_, before_, moves_);
  unknowns_.system.turned_move(workspace_.start, moves_, workspace_.work, team_);
  positions = before_;
  poses_ = poses_before_;
  global_.step(workspace_.work.residual, positions, poses_, team_);
}

void NewtonSearch::take_back(const Actuation& actuation, Points& positions) {
  positions = before_;
  evaluate(actuation, positions);
}

NewtonSearch::Step NewtonSearch::newton_step(const Actuation& actuation, Points& positions) {
  before_ = positions;
  poses_before_ = poses_;
  workspace_.start = workspace_.local;
  Step step = Step::none;
  workspace_.tangent.reduce(workspace_.local.residual, positions, residual_);
  if (!residual_.allFinite()) return Step::none;
  if (!std::exchange(direction_.projected_next, false) && exact_direction(positions)) {
    step = workspace_.tangent.symmetric() ? search_energy(actuation, positions) : search_residual(actuation, positions);
    if (step == Step::none) take_back(actuation, positions);
  }
  if (step == Step::none && projected_direction(positions)) {
    step = search_energy(actuation, positions);
    if (step == Step::none) take_back(actuation, positions);
  }
  min_energy_ = std::min(min_energy_, energy_);
  return step;
}

NewtonSearch::End NewtonSearch::enter(const IterationRecord& record) {
  accept(record, options_.keep_history, report_);
  const bool may_continue = !progress_ || progress_({report_.iterations, report_.step_mm, report_.tolerance_mm});
  return may_continue ? End::stuck : End::interrupted;
}

/// stuck: the search continues
NewtonSearch::End NewtonSearch::local_global(const Actuation& actuation, int count, Points& positions) {
  LocalGlobal iteration(unknowns_.system, global_, tuning().rescue_window, actuation, positions);
  End end = End::stuck;
  for (int i = 0; i < count && end == End::stuck; ++i) {
    if (i > 0) iteration.extrapolate();
    IterationRecord record;
    if (!iteration.iterate(workspace_.local, team_, record)) return End::astray;
    end = enter(record);
  }
  evaluate(actuation, positions);
  natural_start_ = 0;
  direction_.keep_factor = false;
  return end;
}

/// Energy and gradient norm of the last shape evaluated.
IterationRecord NewtonSearch::here() const {
  IterationRecord record;
  record.energy = energy_;
  record.gradient_norm = 2 * global_.free_norm(workspace_.local.residual, poses_);
  return record;
}

NewtonSearch::End NewtonSearch::run(const Actuation& actuation, int most, int left, Points& positions) {
  evaluate(actuation, positions);
  natural_start_ = 0;
  direction_.keep_factor = false;
  direction_.projected_next = !workspace_.tangent.symmetric();
  min_energy_ = energy_;
  if (energy_ <= rounding_energy(unknowns_.model, unknowns_.system.sets())) {  // every element has its target shape
    (void)enter(here());
    return End::converged;
  }
  int idle = 0;
  for (int i = 0; i < most && idle < tuning().max_idle_steps; ++i) {
    IterationRecord record = here();
    const Step step = newton_step(actuation, positions);
    if (step == Step::none) {
      if (left <= 0) return End::stuck;
      left -= tuning().rescue_iterations;
      if (const End end = local_global(actuation, tuning().rescue_iterations, positions); end != End::stuck) return end;
      continue;
    }
    record.step_mm = largest_move(before_, positions);
    const End end = enter(record);
    const bool whole = step == Step::full && direction_.exact;
    if (whole && record.step_mm < report_.tolerance_mm && at_fixed_point(positions)) return End::converged;
    if (end != End::stuck) return end;
    idle = record.step_mm < report_.tolerance_mm ? idle + 1 : 0;
    record = here();
    if (whole && close(actuation, positions, record.step_mm)) {
      (void)enter(record);
      return End::converged;
    }
  }
  return End::stuck;
}

Newton::Newton(const Unknowns& unknowns, const supports::GlobalStep& global) : global_(global), unknowns_(unknowns) {}

std::unique_ptr<Workspace> Newton::take_workspace(const Points* shape) const {
  {
    const std::lock_guard lock(mutex_);
    if (!workspaces_.empty()) {
      const auto found = std::find_if(workspaces_.begin(), workspaces_.end(), [&](const auto& workspace) {
        return shape != nullptr && workspace->solved_shape.rows() == shape->rows() && workspace->solved_shape == *shape;
      });
      if (found != workspaces_.end()) std::swap(*found, workspaces_.back());
      std::unique_ptr<Workspace> workspace = std::move(workspaces_.back());
      workspaces_.pop_back();
      return workspace;
    }
  }
  return std::make_unique<Workspace>(unknowns_);
}

void Newton::forget() const {
  const std::lock_guard lock(mutex_);
  workspaces_.clear();
}

void Newton::put_back(std::unique_ptr<Workspace> workspace) const {
  const std::lock_guard lock(mutex_);
  workspaces_.push_back(std::move(workspace));
}

void Newton::solve(const Actuation& start, const StaticsOptions& options, const ProgressCallback& progress, Team& team,
                   Equilibrium& result) const {
  const TargetShapeOptions& tuning = options.tuning.target_shape;
  SolveReport& report = result.report;
  report.solver = "newton";
  report.continuation_steps = 1;
  Points& positions = result.state.positions;
  const Points begin = positions;
  std::unique_ptr<Workspace> workspace = take_workspace();
  workspace->solved_shape.resize(0, 3);
  NewtonSearch search(unknowns_, global_, *workspace, options, progress, team, report);
  End end = search.run(result.actuation, tuning.max_steps, tuning.first_patience, positions);
  if (end == End::stuck) {
    positions = begin;
    const Actuation from = start.size() == result.actuation.size() ? start : unknowns_.model.rest_actuation();
    end = follow(from, result.actuation, tuning, search, positions, report);
  }
  if (end == End::stuck) {
    positions = begin;
    report.continuation_steps = 1;
    end = search.run(result.actuation, tuning.max_steps, tuning.patience, positions);
  }
  if (end == End::converged && report.factorisations > 0) workspace->solved_shape = positions;
  put_back(std::move(workspace));
  if (end == End::stuck) {
    positions = begin;
    report.continuation_steps = 1;
    const Patience at_last{tuning.last_window, tuning.max_last_iterations,
                           false};  // most such robots have no fixed point
    solve_local_global({unknowns_.model, unknowns_.system, global_}, options, at_last, progress, team, result);
    report.solver = "newton";
    if (report.status != Status::converged)
      report.remark = "neither Newton's method nor Algorithm 1 converged" +
                      (report.remark.empty() ? "" : " (" + report.remark + ")");
    return;
  }
  report.status = end == End::converged     ? Status::converged
                  : end == End::interrupted ? Status::interrupted
                                            : Status::not_converged;
  if (end == End::astray) report.remark = "coordinates too large to compute with";
  report.estimated_error_mm = report.step_mm;
}

}  // namespace softkin::target_shape
