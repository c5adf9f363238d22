#pragma once

#include <optional>
#include <softkin/core/progress.hpp>
#include <softkin/core/temporarily.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/solve_record.hpp>
#include <softkin/statics/physical/system.hpp>
#include <vector>

namespace softkin::physical {

/// Newton's method on the equations of equilibrium under one load state, damped by the natural monotonicity test.
///
/// source  Deuflhard 2011, NLEQ-ERR: a step is as long as the simplified next one shrinks, which is measured with the
///         factor at hand and does not depend on how the equations are scaled
class Newton {
 public:
  struct Settings {
    double tolerance_mm = 0;       // largest move of a vertex by a step
    double force_fraction = 1e-6;  // largest residual over the largest internal force at a vertex
    int max_iterations = ConvergenceOptions().max_iterations;
    bool keep_history = true;
  };
  /// unmet: converged to a shape that violates active constraints, as they contradict each other or cannot be
  /// satisfied. blocked, too_far: not tried, as a collision blocks the motion or the load changes too much.
  enum class Outcome { converged, unstable, stuck, unmet, interrupted, blocked, too_far };

  Newton(const System& system, Workspace& work, Team& team, const Settings& settings, const ProgressCallback& progress,
         SolveRecord& record);

  /// descend: with a stiffness made positive where it is not, towards stable equilibria. follow: with the exact
  /// stiffness, towards the nearest equilibrium, stable or not. near: like descend, but the first step uses the exact
  /// stiffness: this close to a stable equilibrium, negative eigenvalues mostly come from elements that the prediction
  /// compresses.
  enum class Policy { descend, follow, near };

  /// While the returned object exists, a solve uses few factorisations, and a failed one is not repeated in double
  /// precision; for steps that are better shortened.
  [[nodiscard]] Temporarily<bool> with_few_factorisations(bool brief) { return {ending_.brief, brief}; }
  /// While the returned object exists, the tolerances of a solve are multiplied by this factor; for solves that only
  /// prepare the next one.
  [[nodiscard]] Temporarily<double> with_relaxed_tolerance(double times) { return {ending_.loose, times}; }
  /// Does the caller let the solve continue? Polled before operations that take as long as many iterations.
  [[nodiscard]] bool may_continue() const;

  /// Moves `at` to equilibrium. Multipliers that are not active are given. The workspace is left with the last
  /// factorisation. A solve that fails, possibly by rounding of factorisations in single precision, is repeated in
  /// double precision.
  ///
  /// factorised  the workspace holds a stable, exact stiffness of a shape close to `at`: steps are tried with it first
  Outcome solve(const LoadState& load_state, const std::vector<bool>& active, Policy policy, bool factorised,
                Iterate& at);

  /// Moves `at` to a shape whose gaps and contact forces agree, in steps with both as unknowns: contact forces change
  /// little where gaps do. The workspace contains the contact forces; see OtherContact::straighten(). converged: close
  /// enough for Newton's method on the shape alone.
  Outcome correct_pushes(const LoadState& load_state, const std::vector<bool>& active, Iterate& at);

  /// Number of negative eigenvalues under the constraints at the last equilibrium: its unstable modes.
  [[nodiscard]] int unstable_modes() const { return factor_.negative; }

  /// Is the residual at the last equilibrium within its tolerance, too?
  [[nodiscard]] bool balanced() const;
  [[nodiscard]] const Imbalance& imbalance() const { return imbalance_; }

  /// The reason why the last solve failed.
  [[nodiscard]] const char* why_stuck() const { return ending_.why; }

  /// Is an element of the last shape inverted?
  [[nodiscard]] bool inverted() const { return balance_.inverted; }

 private:
  struct Step {
    Eigen::VectorXd move, change;  // of unknowns and of multipliers
    supports::Freedoms::Size size;
  };
  /// Broyden's update: a step, and the step that remained after it over step . (step - left).
  struct Secant {
    Eigen::VectorXd step, left, left_change;
  };
  enum class Advance { none, made, arrived, interrupted };
  /// Records of convergence, for step-size control.
  struct Pace {
    int poor = 0;         // consecutive steps much shorter than Newton's
    int same = 0;         // consecutive steps after which as much remained
    int downhill = 0;     // consecutive steps that decreased the merit function only
    double steepest = 0;  // steepest slope of the merit function until now
    bool slow = false;    // do steps with an element-wise projected stiffness converge slowly
  };
  /// The last factorisation.
  struct Factored {
    int negative = 0;        // negative eigenvalues under the constraints
    bool doubtful = false;   // is their number uncertain
    bool looked_at = false;  // was the effect of rounding on its steps checked
    bool refines = false;    // do its steps need iterative refinement
    double shift = 0;        // the first shift to try
    Points shape{};          // the factorised shape
  };
  /// The requested load state and active constraints.
  struct Requested {
    const LoadState* load_state = nullptr;
    const std::vector<bool>* active = nullptr;
  };
  /// Weights of violated constraints in the merit function [N], [MPa].
  struct Price {
    Eigen::VectorXd multipliers{};  // before the step
    Eigen::VectorXd above{};        // weights of the magnitudes of the violations

    void set(const Eigen::VectorXd& multipliers_before, const Eigen::VectorXd& changes, const Eigen::VectorXd& missed,
             const LineSearchOptions& by, double& slope);
  };
  /// The weights of the actuators' constraints and of the volume constraints of mixed elements.
  struct Prices {
    Price constraints{}, volumes{};
  };
  /// The limits of a solve, and how the last one ended.
  struct Ending {
    bool brief = false;    // is the number of factorisations limited
    double loose = 1;      // factor of the tolerances
    bool rounded = false;  // may rounding be why the last one failed
    const char* why = "";  // why the last one failed
    double step_mm = 0;    // the last step of the current one; infinite: none yet
    double missed = 0;     // its largest constraint violation, over the measure at rest [-]
  };

  void begin_steps();
  Outcome descend(Policy policy, bool factorised, Iterate& at);
  bool rests();
  Advance factorise(const Iterate& at, Policy policy);
  void find(const Balance& balance, const Iterate& at, Step& step);
  double refine(const Balance& balance, const Iterate& at, Step& step);
  bool refine_first(const Iterate& at);
  [[nodiscard]] double tolerance_mm() const { return ending_.loose * settings_.tolerance_mm; }
  [[nodiscard]] bool last(const Step& step, double before) const;
  bool attempt(const Step& step, double& damping, const Iterate& from);
  bool attempt_whole(const Step& step, const Iterate& from);
  bool stagnates(double damping);
  void note_pace(double damping);
  [[nodiscard]] double merit(const Balance& balance) const;
  [[nodiscard]] double weigh_constraints(const Iterate& at);
  Advance accept(double moved_mm, bool arrives, Iterate& at);
  Advance damped_step(Iterate& at, double& damping);
  [[nodiscard]] double shorter(double damping) const;
  void lengthen(double& damping);
  bool update_next();
  [[nodiscard]] bool shrink_fast() const;
  Advance quasi_newton_steps(Iterate& at);
  Advance steps_from_here(Iterate& at, double& damping);
  Advance step_to_stable(Iterate& at, double& damping);
  Advance steps_from_nearby(Iterate& at);
  [[nodiscard]] bool meets_constraints() const;
  bool improve_balance();
  [[nodiscard]] bool doubts_stability(const Iterate& at);
  void make_sure(const Iterate& at);
  bool improve_constraints();
  void correct_gases(Iterate& at) const;
  Advance reject(const Iterate& at);
  void note_iteration(double step_mm);

  const System& system_;
  Workspace& work_;
  Team& team_;
  Settings settings_;
  const ProgressCallback& progress_;
  const NewtonOptions& tuning_;
  SolveRecord& record_;
  Requested requested_;
  Balance balance_, trial_balance_;  // at the iterate, at the one being tried
  Step step_, next_;
  std::vector<Secant> secants_;  // of the factor at hand
  Prices prices_;
  Iterate start_, trial_;
  Ending ending_;
  Pace pace_;
  Factored factor_;
  Imbalance imbalance_;
};

}  // namespace softkin::physical
