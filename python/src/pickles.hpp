#pragma once

#include <softkin/kinematics/grasp.hpp>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/statics/solver_option_fields.hpp>
#include <softkin/statics/statics.hpp>

#include "archive.hpp"
#include "robot.hpp"

namespace softkin::python {

// The members of results, taken apart so that the compiler finds one that is missing. Found by the archive's namespace.

template <class A, class First, class Second>
void members(A& archive, std::pair<First, Second>& p) {
  archive(p.first, p.second);
}
template <class A>
void members(A& archive, IterationRecord& r) {
  auto& [energy, step_mm, gradient_norm] = r;
  archive(energy, step_mm, gradient_norm);
}
template <class A>
void members(A& archive, TracedStep& s) {
  auto& [from, to, length, along, predicted_mm, corrected_mm, iterations, factorisations, in_double, projections,
         shifts, taken, why] = s;
  archive(from, to, length, along, predicted_mm, corrected_mm, iterations, factorisations, in_double, projections,
          shifts, taken, why);
}
template <class A>
void members(A& archive, LoadBranch::Point& p) {
  auto& [measure, load] = p;
  archive(measure, load);
}
template <class A>
void members(A& archive, LoadBranch& b) {
  auto& [actuator, points] = b;
  archive(actuator, points);
}
template <class A>
void members(A& archive, PhysicalReport& r) {
  auto& [residual_N, pull_N, unstable_modes, buckled, buckled_mm, snapped_mm, snapped_from, friction_change,
         unstable_from, branch] = r;
  archive(residual_N, pull_N, unstable_modes, buckled, buckled_mm, snapped_mm, snapped_from, friction_change,
          unstable_from, branch);
}
template <class A>
void members(A& archive, SolveReport& r) {
  auto& [status, stopped, solver, iterations, factorisations, in_double, projections, shifts, steps, reached, remark,
         energy, step_mm, tolerance_mm, gradient_norm, physical, error_mm, history, trace, seconds] = r;
  archive(status, stopped, solver, iterations, factorisations, in_double, projections, shifts, steps, reached, remark,
          energy, step_mm, tolerance_mm, gradient_norm, physical, error_mm, history, trace, seconds);
}
template <class A>
void members(A& archive, Anchor& a) {
  auto& [vertex, part, triangle, weights, slipped_mm] = a;
  archive(vertex, part, triangle, weights, slipped_mm);
}
/// What a material remembers, which may be nothing.
template <class A>
void remembered(A& archive, std::shared_ptr<const ViscousHistory>& history) {
  std::vector<double> strains = history ? history->strains : std::vector<double>();
  archive(strains);
  if (!history && !strains.empty()) history = std::make_shared<ViscousHistory>(ViscousHistory{std::move(strains)});
}
template <class A>
void members(A& archive, State& s) {
  auto& [positions, actuation, multipliers, fraction, anchors, eyelets, pressures, history, elapsed_s] = s;
  archive(positions, actuation, multipliers, fraction, anchors, eyelets, pressures, elapsed_s);
  remembered(archive, history);
}
template <class A>
void members(A& archive, Equilibrium& e) {
  auto& [state, actuation, report] = e;
  archive(state, actuation, report);
}
template <class A>
void members(A& archive, SolverOptions& o) {
  visit_groups(o, [&](const char*, const char*, auto& group) {
    visit_fields(group, [&](const OptionField&, auto& value) { archive(value); });
  });
}
/// But for the deadline, which is past when a pickle is read.
template <class A>
void members(A& archive, StaticsOptions& o) {
  auto& [solver, step_tolerance_mm, max_iterations, anderson, as_published, threads, keep_history, trace, deadline,
         stable, beyond, reuse_factor, history, elapsed_s, tuning] = o;
  (void)deadline;
  archive(solver, step_tolerance_mm, max_iterations, anderson, as_published, threads, keep_history, trace, stable,
          beyond, reuse_factor, elapsed_s, tuning);
  remembered(archive, history);
}

template <class A>
void members(A& archive, Sensitivity& s) {
  auto& [positions, multipliers, regular] = s;
  archive(positions, multipliers, regular);
}
template <class A>
void members(A& archive, InverseTrial& t) {
  auto& [actuation, status, error_mm, iterations] = t;
  archive(actuation, status, error_mm, iterations);
}
template <class A>
void members(A& archive, InverseResult& r) {
  auto& [status, stopped, equilibrium, errors_mm, active, slope, sensitivity, iterations, equilibria, history, remark,
         seconds] = r;
  archive(status, stopped, equilibrium, errors_mm, active, slope, sensitivity, iterations, equilibria, history, remark,
          seconds);
}
/// But for the sensitivity of the start, which is not of the options alone.
template <class A>
void members(A& archive, InverseOptions& o) {
  auto& [method, tolerance_mm, max_equilibria, max_iterations, other_starts, preferred, preferred_tolerance, free,
         start_sensitivity, statics] = o;
  (void)start_sensitivity;
  std::vector<char> may_change(free.begin(), free.end());
  archive(method, tolerance_mm, max_equilibria, max_iterations, other_starts, preferred, preferred_tolerance,
          may_change, statics);
  free.assign(may_change.begin(), may_change.end());
}
template <class A>
void members(A& archive, PositionGoal& g) {
  auto& [marker, target, axes] = g;
  archive(marker, target, axes);
}
template <class A>
void members(A& archive, PlaneGoal& g) {
  auto& [marker, point, normal] = g;
  archive(marker, point, normal);
}
template <class A>
void members(A& archive, DirectionGoal& g) {
  auto& [from, to, direction, lever_mm] = g;
  archive(from, to, direction, lever_mm);
}
template <class A>
void members(A& archive, ForceGoal& g) {
  auto& [on, index, force, axes, mm_per_N] = g;
  archive(on, index, force, axes, mm_per_N);
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
  auto& [normal_N, slipping] = p;
  archive(normal_N, slipping);
}
template <class A>
void members(A& archive, PullDirection& d) {
  auto& [name, along] = d;
  archive(name, along);
}
template <class A>
void members(A& archive, Pull& p) {
  auto& [direction, status, slips, force_N, moved_mm, pressed, last] = p;
  archive(direction, status, slips, force_N, moved_mm, pressed, last);
}
template <class A>
void members(A& archive, Grasp& g) {
  auto& [held, remark, last] = g;
  archive(held, remark, last);
}
template <class A>
void members(A& archive, WorkspaceSample& s) {
  auto& [number, actuation, markers, multipliers, status, reached, iterations] = s;
  archive(number, actuation, markers, multipliers, status, reached, iterations);
}

template <class A>
void members(A& archive, RunTurns& t) {
  auto& [markers, lines] = t;
  archive(markers, lines);
}

}  // namespace softkin::python
