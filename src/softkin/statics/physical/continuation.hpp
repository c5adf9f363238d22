#pragma once

#include <limits>
#include <optional>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/equilibria.hpp>
#include <softkin/statics/physical/stability.hpp>
#include <softkin/statics/physical/step_tracer.hpp>
#include <softkin/statics/physical/swelling.hpp>

namespace softkin::physical {

/// The path of equilibria from one demand to another: predictor, length of steps, slack cables, limits, and where it
/// becomes unstable.
class Continuation {
 public:
  /// All must outlive the object.
  Continuation(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
               const ProgressCallback& progress, SolveReport& report);

  /// Follows the equilibrium from `from` to `to`; at is the last good one.
  Status follow(const Demand& from, const Demand& to, Iterate& at);

  /// What the last good one is an equilibrium of.
  [[nodiscard]] const Demand& here() const { return way_.here; }

  /// Did the way end where its load has its maximum?
  [[nodiscard]] bool at_summit() const { return at_summit_; }

 private:
  /// Friction and the normal forces that it leads to agree where it changes by less than this share.
  static constexpr double frictions_agree = 1e-4;

  /// What Newton's method says of the shape that it came to.
  struct Judgement {
    Imbalance forces;
    bool balanced = true, inverted = false;
    int modes = 0;  // ways in which it is unstable
  };
  /// What a step came to.
  struct StepEnd {
    std::string why{};                    // it ended
    bool found = false, blocked = false;  // an equilibrium; the way there
    bool snap = false, unstable = false;  // of what was found
    bool hurried = false;                 // had it led on with every iteration, perhaps
  };
  /// A shape that a push leads to.
  struct Pushed {
    Iterate at;
    double energy = 0;
    std::vector<bool> active{};
    Judgement last{};
  };
  /// Where a step came out that jumped: what is left where shorter ones find nothing.
  struct Beyond {
    Iterate at;
    Demand demand;
    double done = 0;
    std::vector<bool> active;
    Judgement last;
    double jump_mm = 0;
  };

  /// An equilibrium at a given volume or length instead of a given load.
  struct Measured {
    double measure = 0;  // over that at rest [-]
    double load = 0;     // that it takes [N, kPa]
    Iterate at;
    Judgement last{};
    double gain = 0;      // of the load that was asked for, by the measure on its way
    double share = 1;     // of weights and forces
    double short_of = 0;  // measure that is left to the maximum, about
  };
  /// A way up along the measure of a load, with its maximum between the last points once they are on both sides of it.
  struct Ascent {
    double up = 1, way = 1;                    // signs of the changes of load and measure
    double begin = 0, length = 0;              // measure where it began; next step of it
    Measured low{};                            // the highest point before the maximum
    std::optional<Measured> high{}, passed{};  // beyond the maximum; before low

    [[nodiscard]] const Measured* beside() const { return high ? &*high : passed ? &*passed : nullptr; }
    void take(Measured&& next);
  };
  /// What was looked for, where there is one and nobody stopped it.
  template <class What>
  struct Search {
    std::optional<What> found{};
    bool interrupted = false;
  };
  enum class Climb { lost, arrived, summit, interrupted };
  /// What stopped a way along a measure: the load that was asked, the measure, or nothing that follows.
  enum class Passed { asked, end, nowhere, interrupted };

  /// The way asked for, and how far it was gone.
  struct Way {
    Demand from{}, to{}, here{};
    double done = 0, advance = 1;  // shares of it: gone, and of the next step
    Index load = -1;               // that alone changes beside weights, until it was climbed along what it does
    bool loads_change = false;
    bool releases = false;    // a body, which hardly moves until it is nearly free
    bool factorised = false;  // the stiffness here
    std::optional<Beyond> beyond{};
    std::optional<Demand> then{};           // where the next way leads
    double failed = 0;                      // the nearest share ahead at which a step led nowhere; 0: none
    bool thorough = true;                   // is the next step given every iteration
    double tangent_mm = 0, tangent_at = 0;  // the last but one, over the whole way, and where
    double before = 0;                      // share of all that was asked, gone on ways before
    double marked = 0;                      // the last share at which it was getting on
    int marked_iterations = 0;
  };

  /// Where weights and loads were told apart.
  struct Together {
    Way way;
    Iterate at;
    std::vector<bool> active;
    Judgement last;
  };

  Status follow_whole(const Demand& from, const Demand& to, Iterate& at);
  void set_out(const Demand& from, const Demand& to);
  [[nodiscard]] double whole(double done) const;
  [[nodiscard]] Index only_load(const Demand& from, const Demand& to) const;
  bool loads_at_last(const Iterate& at);
  void go_together(Iterate& at);
  Search<Measured> at_measure(Index a, double measure, const Demand& load, const Measured& from, bool prepared,
                              const Measured* beside);
  void bend(Index a, const Demand& here, const Demand& there, const Measured& from, const Measured& beside,
            Iterate& trial);
  bool leads_too_far(const Demand& here, const Demand& there, const Iterate& at);
  [[nodiscard]] Ascent ascent_from(Index a, const Demand& here, const Demand& to, const Iterate& at);
  Climb climb(Index a, const Demand& from, const Demand& here, const Demand& to, Iterate& at);
  [[nodiscard]] static double left_to_summit(double way, const Measured* beside, const Measured& low,
                                             const Measured& next);
  [[nodiscard]] static bool at_maximum(const Measured& point);
  double slope_at(Index a, const Demand& load, const Measured& point);
  Climb arrive_at(const Demand& to, const Measured& near, Iterate& at, Newton::Policy policy);
  Climb stop_at(Index a, double way, double begin, const Demand& from, const Demand& to, const Measured& summit,
                Iterate& at);
  void keep(Index a, const Demand& from, const Demand& to, const Measured& kept, Iterate& at);
  [[nodiscard]] double share_of(Index a, const Demand& from, const Demand& to, double load) const;
  Passed go_along(Index a, double way, double end, double longest, const Demand& to, Measured& last,
                  std::optional<Measured>& next);
  Climb arrive_between(Index a, const Demand& to, Measured low, Measured high, Iterate& at);
  Climb go_beyond(Index a, double way, const Demand& from, const Demand& to, const Measured& summit, Iterate& at);
  Climb go_back(Index a, const Demand& from, const Demand& to, Iterate& at);
  void note_branch(Index a, const Measured& point);
  void sort_branch();
  [[nodiscard]] std::string measure_text(Index a, double measure) const;
  [[nodiscard]] std::string load_text(Index a, double load) const;
  void tell_beyond(Index a, const Measured& last, bool asked);
  void tell_summit(Index a, const Demand& from, const Demand& to, const Measured& summit);
  [[nodiscard]] Judgement judged() const;
  [[nodiscard]] bool factor_holds_active() const;
  [[nodiscard]] bool snapped(double predicted_mm, double correction_mm) const;
  [[nodiscard]] double lengthened(int iterations) const;
  [[nodiscard]] double longest_step(bool snap, bool unstable) const;
  [[nodiscard]] bool change_loads(const Demand& from, const Demand& to) const;
  [[nodiscard]] std::string instead_of_loads() const;
  void tell_balance();
  Status limit(double done, const std::string& why, const Iterate& at);
  [[nodiscard]] double next_share();
  [[nodiscard]] bool may_turn_back() const;
  [[nodiscard]] double left_to_fold() const;
  [[nodiscard]] bool leads_over_fold(double length) const;
  std::optional<Status> start_step(const Demand& there, Iterate& at);
  [[nodiscard]] StepEnd judge(Newton::Outcome outcome, const Demand& there, double length, const Iterate& at,
                              const Iterate& trial);
  std::optional<Status> go_on(Iterate& at);
  void lengthen(int iterations, bool unstable, Iterate& at);
  std::optional<Status> shorten(double length, bool hurried, Iterate& at);
  bool come_to(const Demand& there, double next, bool unstable, Iterate& at);
  void pass(const Demand& demand, double done);
  std::optional<Status> out_of_patience(const Iterate& at);
  bool release(const Demand& there, Iterate& at, bool contradicting);
  Newton::Outcome settle_swollen(const Demand& there, const Swelling& how, Iterate& trial);
  Newton::Outcome sharpen_swollen(const Demand& there, Swelling how, double by, Iterate& trial);
  [[nodiscard]] bool runs_into_flat(const Demand& there, const Iterate& at);
  [[nodiscard]] Demand pressed(Demand demand, double times) const;
  void give_loads(const Demand& demand, Iterate& at) const;
  bool lead(const Demand& here, const Demand& there, Iterate& trial);
  Newton::Outcome step_from_flat(const Demand& there, const Iterate& at, Iterate& trial);
  Newton::Outcome step(const Demand& here, const Demand& there, double length, const Iterate& at, Iterate& trial);
  bool leads_beyond(const Iterate& at);
  void take_beyond(Iterate& at);
  bool jumped(const Demand& here, const Demand& there, const Iterate& at, const Iterate& trial);
  void tell_snap(double move_mm, double from);
  Status arrive(const Demand& demand, Iterate& at);
  void tell_stability(const Demand& demand, const Iterate& at);
  bool buckle(const Demand& demand, Iterate& at);
  Search<Pushed> lower(const Demand& demand, const Iterate& from, const LowestMode& mode);
  Search<Pushed> pushed(const Demand& demand, const Iterate& from, const LowestMode& mode, double share);
  int prepare(const Demand& here, const Iterate& at);
  double renew_anchors(Iterate& at);
  [[nodiscard]] bool weighs(const Demand& here, const Demand& there) const;
  [[nodiscard]] bool touches(const Iterate& at) const;
  Newton::Outcome fall_onto(const Demand& here, const Demand& there, const Iterate& at, Iterate& trial);
  Newton::Outcome settle_softly(const Demand& demand, bool falls, OtherContact& contact, Iterate& at);
  Newton::Outcome foresee_contact(const Demand& demand, const Iterate& from, bool falls, Iterate& at);
  Newton::Outcome settle_here(const Demand& demand, Iterate& at);
  Newton::Outcome settle(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised = false);
  Newton::Outcome settle_following(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised);
  Newton::Outcome settle_constraints(const Demand& demand, Newton::Policy policy, Iterate& at, bool factorised);
  void take(Iterate& at, Iterate&& found);
  [[nodiscard]] bool factorised_nearby(const Points& shape) const;
  bool change_active(const Demand& demand, Iterate& at);

  const System& system_;
  Workspace& work_;
  Team& team_;
  Newton newton_;
  double tolerance_mm_;
  int max_iterations_;
  bool stable_;
  double beyond_;
  SolveReport& report_;
  StepTracer tracer_;
  Way way_;
  std::vector<bool> active_;
  Points from_;                       // the last good shape
  Points predicted_, begun_;          // by the last step, and what of it is in nobody's way
  FreeWay free_way_;                  // of the step at hand; empty: not known
  double tangent_mm_ = 0;             // at the begin of the step at hand, over the whole way; 0: not known
  double move_mm_ = 0, jump_mm_ = 0;  // of it: to what it predicted, and beside the way
  bool unforetold_ = false;           // does no tangent say where it should have led
  Judgement last_;                    // of the last good shape
  int rounds_ = 1;                    // of normal forces, for the last equilibrium
  std::optional<Together> together_;
  bool at_summit_ = false;
};

}  // namespace softkin::physical
