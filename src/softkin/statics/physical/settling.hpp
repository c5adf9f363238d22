#pragma once

#include <optional>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/equilibria.hpp>
#include <softkin/statics/physical/swelling.hpp>

namespace softkin::physical {

/// What Newton's method says of the shape that it came to.
struct Judgement {
  Imbalance forces;
  bool balanced = true, inverted = false;
  int modes = 0;  // ways in which it is unstable
};

/// What was looked for, where there is one and nobody stopped it.
template <class What>
struct Search {
  std::optional<What> found{};
  bool interrupted = false;
};

/// From a prediction to an equilibrium: Newton's method, with cables that slacken or are taken up, friction that
/// follows the normal forces by which it is limited, contact that is foreseen, film that swells.
class Settler {
 public:
  /// Friction and the normal forces that it leads to agree where it changes by less than this share.
  static constexpr double frictions_agree = 1e-4;

  /// All must outlive the object.
  Settler(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
          const ProgressCallback& progress, SolveReport& report);

  /// To the equilibrium of a demand near `at`. Where there is none `active` is as before, and `at` tells nothing.
  ///
  /// factorised  see Newton::solve()
  Newton::Outcome settle(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised = false);

  /// From a prediction to where what touches pushes as it will, from an equilibrium.
  ///
  /// falls  from as far as anything may be
  Newton::Outcome foresee_contact(const Demand& demand, const Iterate& from, bool falls, Iterate& at);

  /// Sheets that were flat, from the shape that `how` begins with.
  Newton::Outcome settle_swollen(const Demand& there, const Swelling& how, Iterate& trial);
  /// Does what moves run into sheets that lie flat?
  [[nodiscard]] bool runs_into_flat(const Demand& there, const Iterate& at);

  /// Factorises at an equilibrium, for the predictor. Returns in how many ways it is unstable; -1: it is none.
  int prepare(const Demand& here, const Iterate& at);

  /// Slackens cables that may be longer than they are and carry nothing: held to their length they would push the body
  /// there before they are found to be slack. contradicting: those too that carry something, against another one.
  bool release(const Demand& there, Iterate& at, bool contradicting);
  /// Releases cables that push and takes up those that are too long, at an equilibrium. Were there any?
  bool change_active(const Demand& demand, Iterate& at);

  /// Another equilibrium instead of the one at hand: what slips goes on from there.
  void take(Iterate& at, Iterate&& found);
  /// New anchors of what rubs at an equilibrium; see renew_friction().
  double renew_anchors(Iterate& at);

  /// Loads that are given are the demand's.
  void give_loads(const Demand& demand, Iterate& at) const;

  /// Of what Newton's method came to.
  [[nodiscard]] Judgement judged() const;
  /// Does the workspace hold the stable stiffness of a shape close by?
  [[nodiscard]] bool factorised_nearby(const Points& shape) const;
  /// Does the workspace's factor hold the constraints that are active?
  [[nodiscard]] bool factor_holds_active() const;
  /// Do weights come, or dead forces, of which something may bear some?
  [[nodiscard]] bool weighs(const Demand& here, const Demand& there) const;
  /// Does anything push in a shape?
  [[nodiscard]] bool touches(const Iterate& at) const;
  /// Rounds of normal forces that the last equilibrium took.
  [[nodiscard]] int rounds() const { return rounds_; }

  [[nodiscard]] const System& system() const { return system_; }
  [[nodiscard]] Workspace& work() const { return work_; }
  [[nodiscard]] Team& team() const { return team_; }
  [[nodiscard]] SolveReport& report() const { return report_; }
  [[nodiscard]] Newton& newton() { return newton_; }

  std::vector<bool> active{};  // which measures are held
  Judgement last{};            // of the last good shape
  Points good_shape{};         // that shape
  FreeWay free_way{};          // of the step at hand; empty: not known

 private:
  Newton::Outcome settle_following(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised);
  Newton::Outcome settle_constraints(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised);
  Newton::Outcome settle_softly(const Demand& demand, bool falls, OtherContact& contact, Iterate& at);
  Newton::Outcome settle_wrinkled(const Demand& demand, double barrier, bool asked, Iterate& trial);
  Newton::Outcome sharpen_swollen(const Demand& demand, double barrier, bool asked, Iterate& trial);
  [[nodiscard]] Demand pressed(Demand demand, double times) const;

  const System& system_;
  Workspace& work_;
  Team& team_;
  SolveReport& report_;
  Newton newton_;
  int rounds_ = 1;
};

}  // namespace softkin::physical
