#pragma once

#include <optional>
#include <softkin/core/progress.hpp>
#include <softkin/core/temporarily.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/system.hpp>

namespace softkin::physical {

/// Newton's method on the equations of equilibrium under one demand, damped by the natural monotonicity test.
///
/// source  Deuflhard 2011, NLEQ-ERR: a step is as long as the simplified next one shrinks, which is measured with the
///         factor at hand and does not depend on how the equations are scaled
class Newton {
 public:
  struct Settings {
    double tolerance_mm = 0;    // largest move of a vertex by a step
    double force_share = 1e-6;  // of the elements' largest pull that may be out of balance
    int max_iterations = 30;
    bool keep_history = true;
  };
  /// unmet: arrived where the active constraints contradict each other or cannot be moved; they are missed.
  /// blocked, too_far: not tried, as the way there is.
  enum class Outcome { converged, unstable, stuck, unmet, interrupted, blocked, too_far };

  Newton(const System& system, Workspace& work, Team& team, const Settings& settings, const ProgressCallback& progress,
         SolveReport& report);

  /// descend: with a stiffness made positive where it is not, towards stable equilibria. follow: with the exact one,
  /// towards the nearest equilibrium, stable or not. near: descend, but for the first step, which is of the exact one:
  /// begun so near a stable equilibrium, what is unstable are mostly elements that a foretold shape presses.
  enum class Policy { descend, follow, near };

  /// While it lives, where a shorter step is worth more than patience: few factors, and none again in double precision.
  [[nodiscard]] Temporarily<bool> briefly(bool brief) { return {ending_.brief, brief}; }
  /// While it lives a solve, which only leads to the next one, may end so many times as far from its equilibrium.
  [[nodiscard]] Temporarily<double> loosely(double times) { return {ending_.loose, times}; }
  /// Times its tolerances, where only the next solve is to find its way.
  static constexpr double by_far = 1e5;
  /// Does who asked for the solve let it go on? Asked before what takes as long as many iterations.
  [[nodiscard]] bool goes_on() const;

  /// Moves `at` to equilibrium. Multipliers that are not active are given. The workspace is left with the last
  /// factorisation. What gets stuck where rounding of factors in single precision shows is tried again with others.
  ///
  /// factorised  the workspace holds a stable, exact stiffness of a shape close to `at`: steps are tried with it first
  Outcome solve(const Demand& demand, const std::vector<bool>& active, Policy policy, bool factorised, Iterate& at);

  /// Moves `at` to where things touch as they push each other, in steps with both as unknowns: pushes change little
  /// where gaps do. The workspace knows the pushes; see System::straighten_contact. converged: Newton's method on the
  /// shape alone is near enough.
  Outcome settle_pushes(const Demand& demand, const std::vector<bool>& active, Iterate& at);

  /// Negative eigenvalues that the constraints leave, at the last equilibrium: ways to snap away from it.
  [[nodiscard]] int unstable_modes() const { return factor_.negative; }

  /// Are the forces in balance at the last equilibrium, too?
  [[nodiscard]] bool balanced() const;
  [[nodiscard]] const Imbalance& imbalance() const { return imbalance_; }

  /// Why the last solve got stuck.
  [[nodiscard]] const char* why_stuck() const { return ending_.why; }

  /// Is an element of the last shape inverted?
  [[nodiscard]] bool inverted() const { return balance_.inverted; }

 private:
  struct Step {
    Eigen::VectorXd move, change;  // of unknowns and of multipliers
    supports::Freedoms::Size size;
  };
  /// A step and what it left to do over step . (step - left): Broyden's update.
  struct Secant {
    Eigen::VectorXd step, left, left_change;
  };
  enum class Advance { none, made, arrived, interrupted };
  /// How steps get on.
  struct Pace {
    int poor = 0;         // in a row that were much shorter than Newton's
    int same = 0;         // in a row that left as much to go
    int downhill = 0;     // in a row that lead down and no nearer
    double steepest = 0;  // slope of the merit function so far
    bool slow = false;    // are they of a stiffness that was made positive element by element
  };
  /// The last factorisation.
  struct Factored {
    int negative = 0;        // eigenvalues that the constraints leave
    bool doubtful = false;   // is there a doubt about these
    bool looked_at = false;  // is it known how rounding shows in its steps
    bool refines = false;    // do these want more than what its precision gives
    double shift = 0;        // the first to try
    Points shape{};          // where it was made
  };
  /// What is solved for.
  struct Asked {
    const Demand* demand = nullptr;
    const std::vector<bool>* active = nullptr;
  };
  /// What it costs in the merit function to miss constraints [N], [MPa].
  struct Price {
    Eigen::VectorXd multipliers{};  // before the step
    Eigen::VectorXd above{};        // of what is missed, whatever its sign

    void set(const Eigen::VectorXd& multipliers_before, const Eigen::VectorXd& changes, const Eigen::VectorXd& missed,
             double& slope);
  };
  /// Of actuators' constraints, and of volumes that are kept.
  struct Prices {
    Price constraints{}, volumes{};
  };
  /// How a solve is to end, and how the last one did.
  struct Ending {
    bool brief = false;    // after a few factors
    double loose = 1;      // times its tolerances
    bool rounded = false;  // did the last one get stuck by rounding, perhaps
    const char* why = "";  // did the last one get stuck
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
  bool labours(double damping);
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
  void settle_gases(Iterate& at) const;
  Advance reject(const Iterate& at);
  void record(double step_mm);

  const System& system_;
  Workspace& work_;
  Team& team_;
  Settings settings_;
  const ProgressCallback& progress_;
  SolveReport& report_;
  Asked asked_;
  Balance balance_, trial_balance_;  // at the iterate, at the one being tried
  Step step_, next_;
  std::vector<Secant> secants_;  // of the factor at hand
  Prices prices_;
  Iterate start_, trial_;
  Ending ending_;
  Pace pace_;
  Factored factor_;
  Imbalance imbalance_;
  double missed_ = 0;  // the worst constraint, over its measure at rest [-]
};

}  // namespace softkin::physical
