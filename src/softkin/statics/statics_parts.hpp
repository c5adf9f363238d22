#pragma once

#include <atomic>
#include <mutex>
#include <softkin/statics/physical/equilibria.hpp>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/target_shape/local_global.hpp>
#include <softkin/statics/target_shape/newton.hpp>

namespace softkin {

/// throws  InvalidInput on what is not of the model, and on options out of range
void check_start(const Model& model, const State& start, const StaticsOptions& options);

/// What a robot's equilibria are found with.
struct Statics::Parts {
  explicit Parts(const Model& robot);

  void assemble(const Model& robot);
  struct TargetShape {
    explicit TargetShape(const Model& robot)
        : system(robot),
          turning(robot),
          unknowns(robot, system),
          global(robot, system.global_matrix(), unknowns.freedoms.vertex_order()),
          newton(unknowns, global) {}
    target_shape::System system;
    supports::Turning turning;
    target_shape::Unknowns unknowns;
    supports::GlobalStep global;
    target_shape::Newton newton;
  };
  [[nodiscard]] TeamPool::Lent team(const StaticsOptions& options);

  /// of: for messages
  void check_actuation(const State& at, const StaticsOptions& options, const std::string& of) const;
  void check_known(const State& at, const StaticsOptions& options, const std::string& of) const;
  void check_history(const ViscousHistory* history, double elapsed_s) const;

  [[nodiscard]] double paper_tolerance() const { return 8e-8 * model.diagonal_mm; }
  [[nodiscard]] double tolerance(const StaticsOptions& options) const {
    return options.step_tolerance_mm > 0 ? options.step_tolerance_mm : paper_tolerance();
  }
  [[nodiscard]] physical::Equilibria::Options physical_options(const StaticsOptions& options) const;

  /// Where a viscous robot has stood for long, relaxed, before times begin: found once. Else not converged.
  Equilibrium long_rest(StaticsOptions options, const ProgressCallback& progress, Team& team);

  /// In the physical formulation.
  Equilibrium solve(const Actuation& actuation, const State& start, const StaticsOptions& options,
                    const ProgressCallback& progress, Team& team);

  /// In target shapes, from result.state.positions. Where supports turn far, by equilibria on the way: what is held is
  /// put in its place at once, and elements that it turns over would stay so.
  void solve_target_shape(const Actuation& start, const StaticsOptions& options, const ProgressCallback& progress,
                          Team& team, Equilibrium& result);

  const Model& model;
  std::mutex rested_mutex;
  std::optional<Equilibrium> rested;
  std::shared_ptr<const ViscousHistory> remembered;  // of rested
  std::atomic<int> worthwhile = 1;                   // threads
  TeamPool teams;
  std::optional<TargetShape> target_shape;
  std::optional<physical::Equilibria> physical;
  std::unique_ptr<const GivenEquilibria> given;

  [[nodiscard]] bool assembled() const { return physical || target_shape; }
};

}  // namespace softkin
