#pragma once

#include <softkin/kinematics/grasp.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/statics/statics.hpp>

#include "archive.hpp"

namespace softkin::python {

// The members of results. Found by the archive's namespace.

template <class A, class First, class Second>
void members(A& archive, std::pair<First, Second>& p) {
  archive(p.first, p.second);
}
template <class A>
void members(A& archive, IterationRecord& r) {
  archive(r.energy, r.step_mm, r.gradient_norm);
}
template <class A>
void members(A& archive, SolveReport& r) {
  archive(r.status, r.solver, r.iterations, r.factorisations, r.factorisations_in_double, r.projections, r.shifts,
          r.continuation_steps, r.reached, r.remark, r.energy, r.step_mm, r.tolerance_mm, r.gradient_norm, r.residual_N,
          r.pull_N, r.unstable_modes, r.buckled, r.buckled_mm, r.snapped_mm, r.snapped_from, r.friction_change,
          r.unstable_from, r.estimated_error_mm, r.history, r.seconds);
}
template <class A>
void members(A& archive, Anchor& a) {
  archive(a.vertex, a.part, a.triangle, a.weights, a.slipped_mm);
}
/// What a material remembers, which may be nothing.
template <class A>
void remembered(A& archive, std::shared_ptr<const ViscousHistory>& history) {
  std::vector<double> strains = history ? history->strains : std::vector<double>();
  archive(strains);
  if (!history && !strains.empty()) history = std::make_shared<ViscousHistory>(ViscousHistory{std::move(strains)});
}
template <class A>
void members(A& archive, Equilibrium& e) {
  archive(e.state.positions, e.state.actuation, e.state.multipliers, e.state.share, e.state.anchors, e.actuation,
          e.report, e.state.elapsed_s);
  remembered(archive, e.state.history);
  archive(e.state.eyelets);
}
template <class A>
void members(A& archive, StaticsOptions& o) {
  archive(o.solver, o.step_tolerance_mm, o.max_iterations, o.anderson, o.threads, o.keep_history, o.stable,
          o.reuse_factor, o.elapsed_s, o.as_published);
  remembered(archive, o.history);
}

template <class A>
void members(A& archive, Sensitivity& s) {
  archive(s.positions, s.multipliers, s.regular);
}
template <class A>
void members(A& archive, InverseTrial& t) {
  archive(t.actuation, t.status, t.error_mm, t.iterations);
}
template <class A>
void members(A& archive, InverseResult& r) {
  archive(r.status, r.equilibrium, r.errors_mm, r.active, r.slope, r.sensitivity, r.iterations, r.equilibria, r.history,
          r.remark, r.seconds);
}
template <class A>
void members(A& archive, InverseOptions& o) {
  std::vector<char> free(o.free.begin(), o.free.end());
  archive(o.method, o.tolerance_mm, o.max_equilibria, o.max_iterations, o.other_starts, o.preferred,
          o.preferred_tolerance, free, o.statics);
  o.free.assign(free.begin(), free.end());
}
template <class A>
void members(A& archive, PositionGoal& g) {
  archive(g.marker, g.target, g.axes);
}
template <class A>
void members(A& archive, PlaneGoal& g) {
  archive(g.marker, g.point, g.normal);
}
template <class A>
void members(A& archive, DirectionGoal& g) {
  archive(g.from, g.to, g.direction, g.lever_mm);
}
template <class A>
void members(A& archive, ForceGoal& g) {
  archive(g.on, g.index, g.force, g.axes, g.mm_per_N);
}
template <class A>
void members(A& archive, runs::NamedGoal& g) {
  std::uint64_t kind = g.goal.what.index();
  archive(g.name, g.goal.weight, kind);
  if (kind == 1 && g.goal.what.index() != 1) g.goal.what = PlaneGoal();
  if (kind == 2 && g.goal.what.index() != 2) g.goal.what = DirectionGoal();
  if (kind == 3 && g.goal.what.index() != 3) g.goal.what = ForceGoal();
  std::visit([&archive](auto& goal) { archive(goal); }, g.goal.what);
}
template <class A>
void members(A& archive, Pressed& p) {
  archive(p.normal_N, p.slipping);
}
template <class A>
void members(A& archive, PullDirection& d) {
  archive(d.name, d.along);
}
template <class A>
void members(A& archive, Pull& p) {
  archive(p.direction, p.status, p.force_N, p.moved_mm, p.pressed, p.last);
}
template <class A>
void members(A& archive, Grasp& g) {
  archive(g.held, g.remark, g.last);
}
template <class A>
void members(A& archive, WorkspaceSample& s) {
  archive(s.number, s.actuation, s.markers, s.multipliers, s.status, s.reached, s.iterations);
}

}  // namespace softkin::python
