#pragma once

#include <optional>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/equilibria.hpp>
#include <softkin/statics/physical/swelling.hpp>

namespace softkin::physical {

/// Properties of the shape at which Newton's method ended.
struct Judgement {
  Imbalance forces;
  bool balanced = true, inverted = false;
  int modes = 0;  // number of unstable modes
};

/// The result of a search, if there is one and the caller did not interrupt the search.
template <class What>
struct Search {
  std::optional<What> found{};
  bool interrupted = false;
};

/// Corrects a prediction to an equilibrium: Newton's method with an active set of cables, friction limited by the
/// normal forces at the shape, predicted contact, and sheets inflated from flat.
class Corrector {
 public:
  /// All must outlive the object.
  Corrector(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
            const ProgressCallback& progress, SolveRecord& record, SolveReport& report);

  /// Corrects `at` to a nearby equilibrium of a load state. If none is found, `active` is unchanged and `at` has no
  /// meaning.
  ///
  /// factorised  see Newton::solve()
  Newton::Outcome correct(const LoadState& load_state, Newton::Policy policy, Iterate& at, bool factorised = false);

  /// Moves a prediction, made from the equilibrium `from`, to a shape with consistent contact forces.
  ///
  /// falls  may the contacts be far away from the prediction
  Newton::Outcome predict_contact(const LoadState& load_state, const Iterate& from, bool falls, Iterate& at);

  /// Corrects sheets that were flat, from the inflated shape `trial`, with the smoothing and pressures of `how`.
  Newton::Outcome correct_swollen(const LoadState& there, const Swelling& how, Iterate& trial);
  /// Do moving supports run into flat sheets?
  [[nodiscard]] bool runs_into_flat(const LoadState& there, const Iterate& at);

  /// Factorises at an equilibrium, for the predictor. Returns the number of unstable modes; -1: forces are not finite.
  int prepare(const LoadState& here, const Iterate& at);

  /// Deactivates cables that are shorter than commanded and have no tension: as constraints they would push the body
  /// before they are found to be slack. contradicting: also cables with tension, which contradict another one. Returns
  /// whether any was deactivated.
  bool release(const LoadState& there, Iterate& at, bool contradicting);
  /// Updates the active set at an equilibrium: deactivates cables that push and activates those that are too long.
  /// Returns whether it changed.
  bool change_active(const LoadState& load_state, Iterate& at);

  /// Replaces the current equilibrium by another one; sliding contacts and tendons continue from there.
  void take(Iterate& at, Iterate&& found);
  /// Updates the anchors of friction at an equilibrium; see renew_friction().
  double renew_anchors(Iterate& at);

  /// Sets the given loads to those of the load state.
  void give_loads(const LoadState& load_state, Iterate& at) const;

  /// Returns the properties of the shape at which Newton's method ended.
  [[nodiscard]] Judgement judged() const;
  /// Is the last factorisation exact, stable and of a nearby shape?
  [[nodiscard]] bool factorised_nearby(const Points& shape) const;
  /// Are the constraints of the last factorisation the active ones?
  [[nodiscard]] bool factor_holds_active() const;
  /// Do dead loads change, and may contact carry a part of them?
  [[nodiscard]] bool weighs(const LoadState& here, const LoadState& there) const;
  /// Are there contact forces at a shape?
  [[nodiscard]] bool touches(const Iterate& at) const;
  /// The number of updates of normal forces for the last equilibrium.
  [[nodiscard]] int rounds() const { return rounds_; }

  [[nodiscard]] const System& system() const { return system_; }
  [[nodiscard]] Workspace& work() const { return work_; }
  [[nodiscard]] Team& team() const { return team_; }
  [[nodiscard]] SolveRecord& record() const { return record_; }
  [[nodiscard]] SolveReport& report() const { return report_; }
  [[nodiscard]] Newton& newton() { return newton_; }

  std::vector<bool> active{};  // which measures are constrained
  Judgement last{};            // of the last accepted shape
  Points good_shape{};         // that shape
  FreeMotion free_motion{};    // of the current step; empty: unknown

 private:
  Newton::Outcome correct_following(const LoadState& load_state, Newton::Policy policy, Iterate& at, bool factorised);
  Newton::Outcome correct_constraints(const LoadState& load_state, Newton::Policy policy, Iterate& at, bool factorised);
  Newton::Outcome correct_softly(const LoadState& load_state, bool falls, OtherContact& contact, Iterate& at);
  Newton::Outcome correct_wrinkled(const LoadState& load_state, double barrier, bool requested, Iterate& trial);
  Newton::Outcome sharpen_swollen(const LoadState& load_state, double barrier, bool requested, Iterate& trial);
  [[nodiscard]] LoadState pressed(LoadState load_state, double times) const;

  const System& system_;
  Workspace& work_;
  Team& team_;
  const SolverOptions& tuning_;
  SolveRecord& record_;
  SolveReport& report_;
  Newton newton_;
  int rounds_ = 1;
};

}  // namespace softkin::physical
