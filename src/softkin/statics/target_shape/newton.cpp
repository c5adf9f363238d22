#include <algorithm>
#include <softkin/statics/target_shape/newton.hpp>

namespace softkin::target_shape {

namespace {

using End = NewtonSearch::End;

/// Local-global iterations that help Newton's method out in one run.
constexpr int patience = 300;

/// Equilibria on the way from one actuation to another; the step is halved where one is not found and doubled where
/// one is.
End follow(const Actuation& from, const Actuation& to, NewtonSearch& search, Points& positions, SolveReport& report) {
  constexpr double first = 0.25, least = 1.0 / 256;
  double share = 0, step = first;
  Points reached = positions;
  report.continuation_steps = 0;
  while (share < 1) {
    const double next = std::min(1.0, share + step);
    positions = reached;
    const End end = search.run(from + next * (to - from), 0, positions);
    if (end == End::interrupted || end == End::exhausted || end == End::astray) return end;
    if (end == End::converged) {
      share = next;
      step *= 2;
      reached = positions;
      ++report.continuation_steps;
    } else {
      step /= 2;
      if (step < least) return End::stuck;
    }
  }
  return End::converged;
}

}  // namespace

Newton::Newton(const Unknowns& unknowns, const supports::GlobalStep& global) : global_(global), unknowns_(unknowns) {}

std::unique_ptr<Workspace> Newton::take_workspace(const Points* shape) const {
  {
    const std::lock_guard lock(mutex_);
    if (!workspaces_.empty()) {
      const auto found = std::find_if(workspaces_.begin(), workspaces_.end(), [&](const auto& workspace) {
        return shape != nullptr && workspace->home.rows() == shape->rows() && workspace->home == *shape;
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
  SolveReport& report = result.report;
  report.solver = "newton";
  report.continuation_steps = 1;
  Points& positions = result.state.positions;
  const Points begin = positions;
  std::unique_ptr<Workspace> workspace = take_workspace();
  workspace->home.resize(0, 3);
  NewtonSearch search(unknowns_, global_, *workspace, options, progress, team, report);
  End end = search.run(result.actuation, patience, positions);
  if (end == End::stuck) {
    positions = begin;
    const Actuation from = start.size() == result.actuation.size() ? start : unknowns_.model.rest_actuation();
    end = follow(from, result.actuation, search, positions, report);
  }
  if (end == End::converged && report.factorisations > 0) workspace->home = positions;
  put_back(std::move(workspace));
  if (end == End::stuck) {
    positions = begin;
    report.continuation_steps = 1;
    solve_local_global(unknowns_.system, global_, options, progress, team, result);
    report.solver = "newton";
    if (report.status != Status::converged) report.remark = "neither Newton's method nor Algorithm 1 converged";
    return;
  }
  report.status = end == End::converged     ? Status::converged
                  : end == End::interrupted ? Status::interrupted
                                            : Status::not_converged;
  if (end == End::exhausted) report.remark = "the iterations allowed were not enough";
  if (end == End::astray) report.remark = "coordinates too large to compute with";
  report.estimated_error_mm = report.step_mm;
}

}  // namespace softkin::target_shape
