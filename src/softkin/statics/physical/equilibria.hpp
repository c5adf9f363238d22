#pragma once

#include <mutex>
#include <softkin/statics/physical/derivative.hpp>
#include <softkin/statics/physical/newton.hpp>
#include <softkin/statics/physical/prediction.hpp>
#include <softkin/statics/sensitivity.hpp>
#include <softkin/statics/solver_options.hpp>

namespace softkin::physical {

/// Equilibria of a robot in the physical formulation: Newton's method along a path of load states from the start to the
/// requested one, in steps as long as it converges, each begun with a tangent predictor.
class Equilibria {
 public:
  class WorkspaceHandle;
  class Inside;

  /// model must outlive the object. throws InvalidInput where some part of the robot is not held
  explicit Equilibria(const Model& model) : system_(model) {}
  /// See Statics.
  Equilibria(const Model& model, const Equilibria& like) : system_(model, like.system_) {}

  struct Options {
    double tolerance_mm = 0;
    bool keep_history = true;
    bool trace = false;
    bool reuse_factor = true;
    bool stable = false;           // leave unstable equilibria
    double beyond = 0;             // see StaticsOptions
    double force_fraction = 1e-6;  // tolerance of the residual, over the largest internal force
    std::shared_ptr<const ViscousHistory> history{};
    double elapsed_s = std::numeric_limits<double>::infinity();
    SolverOptions tuning{};
  };

  /// Arguments are checked already. report.seconds is left to the caller.
  [[nodiscard]] Equilibrium solve(const Actuation& actuation, const State& start, const Options& options,
                                  const ProgressCallback& progress, Team& team) const;

  /// Returns a state with the pressures of mixed elements among its positions, as the system has them; outside()
  /// removes them. If the state does not contain pressures, they are those that balance its forces best, which are the
  /// only ones at an equilibrium.
  ///
  /// throws  InvalidInput on pressures of another robot
  [[nodiscard]] State inside(const State& at, Team& team) const;
  void outside(State& at) const;

  /// Returns the sensitivity of an equilibrium; see Statics::sensitivity.
  [[nodiscard]] Sensitivity sensitivity(const State& at, const Options& options, double accuracy, Team& team) const;

  [[nodiscard]] ParameterSensitivity sensitivity(const State& at, const std::vector<Perturbation>& perturbations,
                                                 const Options& options, double accuracy, bool reactions,
                                                 Team& team) const;
  [[nodiscard]] ParameterSensitivity sensitivity(const State& at, const std::vector<Actuation>& changes,
                                                 const Options& options, double accuracy, bool reactions,
                                                 Team& team) const;

  /// See Perturbations::gradients. The system must be reciprocal.
  [[nodiscard]] Eigen::MatrixXd gradients(const State& at, const std::vector<Perturbation>& perturbations,
                                          const std::vector<ShapeGradient>& reported, const Options& options,
                                          double accuracy, Team& team) const;

  /// See Statics::reciprocal_moves.
  [[nodiscard]] std::vector<Points> moves_under(const State& at, const std::vector<Points>& forces,
                                                const Options& options, double accuracy, Team& team) const;

  /// See Statics::extrapolate.
  bool extrapolate(const Actuation& actuation, const State& at, const SolverOptions& options, Points& positions,
                   Team& team) const;

  /// See Statics::set_initial_guess.
  bool set_initial_guess(const State& at, State there) const;

  /// Adds stress and reactions of an equilibrium; see Statics::measured.
  void measure(const State& at, ElementDeformation& out, Team& team) const;

  /// See Statics::pressing_changes.
  [[nodiscard]] std::vector<std::vector<Vec3>> pressing_changes(const State& at, const std::vector<Points>& moves,
                                                                Team& team) const;

  /// See Statics::flow.
  [[nodiscard]] ViscousFlow flow(const State& at, Team& team) const;

  /// Discards the workspaces of earlier solves.
  void forget() const;

  [[nodiscard]] const System& system() const { return system_; }

 private:
  /// Can every vertex move on a straight path from one shape to the other without penetration?
  bool comes_to(const Points& from, const Points& to, Workspace& work, Team& team) const;
  [[nodiscard]] Equilibrium solve_inside(const Actuation& actuation, const State& start, const Options& options,
                                         const ProgressCallback& progress, Team& team) const;
  [[nodiscard]] Iterate iterate_at(const State& start, const LoadState& from) const;
  [[nodiscard]] LoadState load_state_now(const State& start, const LoadState& from, const Iterate& at,
                                         const Options& options, Workspace& work, Team& team) const;
  [[nodiscard]] State state_at(Iterate&& at, const LoadState& load_state, const Options& options) const;
  void find_pressures(State& at, Team& team) const;
  void drop_vertices(Points& points) const;
  void begin_again(const LoadState& to, const Options& options, const ProgressCallback& progress, Team& team,
                   Workspace& work, Iterate& at, SolveRecord& record, SolveReport& report) const;

  System system_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Workspace>> idle_;  // from earlier solves
};

}  // namespace softkin::physical
