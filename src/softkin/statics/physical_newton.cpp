#include <cmath>
#include <softkin/statics/physical_newton.hpp>

namespace softkin {

namespace {

constexpr double least_damping = 1e-3;
/// A simplified step that is this much shorter than the step before saves a factorisation.
constexpr double chord_contraction = 0.02;

}  // namespace

PhysicalNewton::PhysicalNewton(const PhysicalSystem& system, PhysicalSystem::Workspace& work, Team& team,
                               const Settings& settings, const ProgressCallback& progress, SolveReport& report)
    : system_(system), work_(work), team_(team), settings_(settings), progress_(progress), report_(report) {}

void PhysicalNewton::record(double step_mm) {
  IterationRecord entry;
  entry.energy = balance_.energy;
  entry.gradient_norm = balance_.force.norm();
  entry.step_mm = step_mm;
  ++report_.iterations;
  report_.energy = entry.energy;
  report_.step_mm = step_mm;
  report_.gradient_norm = entry.gradient_norm;
  if (settings_.keep_history) report_.history.push_back(entry);
}

/// The exact stiffness where it is stable under the constraints; else made so element by element, then by a shift.
bool PhysicalNewton::factorise(const Iterate& at, const Demand& demand, const std::vector<bool>& active) {
  using Stiffness = PhysicalSystem::Stiffness;
  ++report_.factorisations;
  negative_ = system_.factorise(at, demand, active, Stiffness::exact, 0, work_, team_);
  if (negative_ == 0) return true;
  ++report_.projections;
  ++report_.factorisations;
  if (system_.factorise(at, demand, active, Stiffness::projected, 0, work_, team_) == 0) return true;
  for (double shift = 1e-4; shift < 100; shift *= 10) {
    ++report_.shifts;
    ++report_.factorisations;
    if (system_.factorise(at, demand, active, Stiffness::projected, shift, work_, team_) == 0) return true;
  }
  return false;
}

PhysicalNewton::Outcome PhysicalNewton::solve(const Demand& demand, const std::vector<bool>& active, Iterate& at) {
  Eigen::VectorXd step, change, simplified, simplified_change;
  system_.evaluate(at, demand, active, work_, balance_, team_);
  if (balance_.forbidden || !balance_.force.allFinite()) return Outcome::stuck;
  double damping = 1;
  for (int iteration = 0; iteration < settings_.max_iterations; ++iteration) {
    if (!factorise(at, demand, active)) return Outcome::stuck;
    system_.step(balance_, work_, step, change, team_);
    PhysicalSystem::Size size = system_.size_of(step, at.positions);
    if (!std::isfinite(size.mean)) return Outcome::stuck;

    damping = std::min(1.0, 2 * damping);
    double contraction = 0;
    PhysicalSystem::Size next_size;
    for (;;) {
      trial_ = at;
      system_.advance(step, damping, work_, trial_.positions, team_);
      trial_.multipliers += damping * change;
      system_.evaluate(trial_, demand, active, work_, next_balance_, team_);
      bool good = !next_balance_.forbidden && next_balance_.force.allFinite();
      if (good) {
        system_.step(next_balance_, work_, simplified, simplified_change, team_);
        next_size = system_.size_of(simplified, trial_.positions);
        contraction = next_size.mean / std::max(size.mean, 1e-300);
        good = std::isfinite(contraction) && (contraction <= 1 - damping / 4 || size.largest < settings_.tolerance_mm);
      }
      if (good) break;
      // the length at which the quadratic model of the contraction is just acceptable
      const double residue = std::isfinite(contraction) && contraction > 0
                                 ? (simplified - (1 - damping) * step).norm() / std::max(step.norm(), 1e-300)
                                 : 0;
      damping = std::min(damping / 2, residue > 0 ? damping * damping / (2 * residue) : damping / 2);
      if (damping < least_damping) return Outcome::stuck;
    }
    record(damping * size.largest);
    at = trial_;
    balance_ = next_balance_;
    if (progress_ && !progress_({report_.iterations, report_.step_mm, settings_.tolerance_mm}))
      return Outcome::interrupted;
    if (damping < 1) continue;

    // the simplified step is at hand: take it, and more of them as long as they shrink fast
    while (size.largest >= settings_.tolerance_mm && contraction < chord_contraction) {
      size = next_size;
      trial_ = at;
      system_.advance(simplified, 1, work_, trial_.positions, team_);
      trial_.multipliers += simplified_change;
      system_.evaluate(trial_, demand, active, work_, next_balance_, team_);
      if (next_balance_.forbidden || !next_balance_.force.allFinite()) break;
      record(size.largest);
      at = trial_;
      balance_ = next_balance_;
      if (size.largest < settings_.tolerance_mm) break;
      system_.step(balance_, work_, simplified, simplified_change, team_);
      next_size = system_.size_of(simplified, at.positions);
      contraction = next_size.mean / std::max(size.mean, 1e-300);
      if (!std::isfinite(contraction)) break;
    }
    if (size.largest < settings_.tolerance_mm) {
      report_.gradient_norm = balance_.force.norm();
      report_.energy = balance_.energy;
      return negative_ == 0 ? Outcome::converged : Outcome::unstable;
    }
  }
  return Outcome::stuck;
}

}  // namespace softkin
