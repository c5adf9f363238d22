#pragma once

#include <optional>
#include <softkin/statics/physical/arc_length.hpp>
#include <softkin/statics/physical/segment_check.hpp>
#include <softkin/statics/physical/settling.hpp>
#include <softkin/statics/physical/step_tracer.hpp>
#include <softkin/statics/physical/summit.hpp>

namespace softkin::physical {

/// The path of equilibria from one demand to another: predictor, length of steps, limits, and where it becomes
/// unstable.
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
  /// The step at hand.
  struct Step {
    Points predicted{}, begun{};      // where it was to lead, and what of that is in nobody's way
    Points straight{};                // where its tangent leads to first order
    double move_mm = 0, jump_mm = 0;  // to what it predicted, and beside the way
    bool unforetold = false;          // does no tangent say where it should have led
    bool extrapolated = false;        // was it predicted without a tangent, from equilibria around it
  };
  /// What a step came to.
  struct StepEnd {
    std::string why{};                    // it ended
    bool found = false, blocked = false;  // an equilibrium; the way there
    bool snap = false, unstable = false;  // of what was found
    bool interrupted = false;             // while it was checked
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

  /// The nearest share ahead at which a step led nowhere.
  struct Failed {
    double share = 0;  // 0: none
    double ahead = 0;  // how far it was then

    void note(double at, double done);
  };

  /// The way asked for, and how far it was gone.
  struct Way {
    Demand from{}, to{}, here{};
    double done = 0, advance = 1;  // shares of it: gone, and of the next step
    Index load = -1;               // that alone changes beside weights, until it was climbed along what it does
    bool loads_change = false;
    bool releases = false;    // a body, which hardly moves until it is nearly free
    bool factorised = false;  // the stiffness here
    std::optional<Beyond> beyond{};
    std::optional<Demand> then{};  // where the next way leads
    Failed failed{};
    bool thorough = true;  // is the next step given every iteration
    double before = 0;     // share of all that was asked, gone on ways before
    double marked = 0;     // the last share at which it was getting on
    int marked_iterations = 0;
    int misses = 0, next_look = 2;  // steps that led nowhere, and after how many the curve is followed
    bool turned = false;            // does it turn back here
    bool bears_all = false;         // beyond what is left, about

    [[nodiscard]] WholeWay whole() const { return {before, then.has_value()}; }
  };

  /// Where weights and loads were told apart.
  struct Together {
    Way way;
    Iterate at;
    std::vector<bool> active;
    Judgement last;
  };

  // the way
  Status follow_whole(const Demand& from, const Demand& to, Iterate& at);
  void set_out(const Demand& from, const Demand& to);
  Newton::Outcome settle_here(const Demand& demand, Iterate& at);
  [[nodiscard]] double whole(double done) const { return way_.whole()(done); }
  [[nodiscard]] Index only_load(const Demand& from, const Demand& to) const;
  [[nodiscard]] bool change_loads(const Demand& from, const Demand& to) const;
  [[nodiscard]] bool anything_comes_with_share() const;
  [[nodiscard]] bool holds_elsewhere() const;
  std::optional<Status> go_on(Iterate& at);
  void pass(const Demand& demand, double done);
  bool come_to(const Demand& there, double next, bool unstable, Iterate& at);
  bool loads_at_last(const Iterate& at);
  void go_together(Iterate& at);
  ArcLength::End follow_curve(Iterate& at);
  Climb::End climb(Climb::End (Climb::*along)(Iterate&), Index load, Iterate& at);

  // a step
  std::optional<Status> start_step(const Demand& there, Iterate& at);
  Newton::Outcome step(const Demand& here, const Demand& there, double length, const Iterate& at, Iterate& trial);
  Newton::Outcome step_from_flat(const Demand& there, const Iterate& at, Iterate& trial);
  Newton::Outcome fall_onto(const Demand& here, const Demand& there, const Iterate& at, Iterate& trial);
  bool lead(const Demand& here, const Demand& there, Iterate& trial);
  bool leads_too_far(const Demand& here, const Demand& there, const Iterate& at);
  SegmentCheck::Verdict check_segment(double length, bool changed, const Iterate& at, const Iterate& trial);
  void check_path(double length, bool changed, const Iterate& at, const Iterate& trial, StepEnd& end);
  [[nodiscard]] StepEnd judge(Newton::Outcome outcome, const Demand& there, double length, const Iterate& at,
                              const Iterate& trial);
  bool turned_back(const Iterate& at, const Iterate& trial);
  bool jumped(const Demand& here, const Demand& there, const Iterate& at, const Iterate& trial);
  [[nodiscard]] bool snapped(double predicted_mm, double correction_mm) const;
  bool leads_beyond(const Iterate& at);
  void take_beyond(Iterate& at);

  // its length
  [[nodiscard]] double next_share();
  [[nodiscard]] double longest_step(bool snap, bool unstable) const;
  void lengthen(int iterations, bool unstable, Iterate& at);
  [[nodiscard]] double lengthened(int iterations) const;
  std::optional<Status> shorten(double length, Iterate& at);
  [[nodiscard]] double shortest_advance() const;
  [[nodiscard]] bool ends_early(bool short_step) const;
  [[nodiscard]] bool is_smooth() const;
  [[nodiscard]] bool jerky() const { return system_.contact() || way_.releases; }

  // the end
  Status arrive(const Demand& demand, Iterate& at);
  Status limit(double done, const std::string& why, const Iterate& at);
  std::optional<Status> out_of_patience(const Iterate& at);
  void tell_stability(const Demand& demand, const Iterate& at);
  void tell_balance();
  [[nodiscard]] std::string beyond_here() const;
  [[nodiscard]] std::string instead_of_loads() const;

  const System& system_;
  Workspace& work_;
  Team& team_;
  const Equilibria::Options& options_;
  SolveReport& report_;
  Settler settler_;
  StepTracer tracer_;
  Way way_;
  Step step_;
  std::optional<Together> together_;
  bool at_summit_ = false;
};

}  // namespace softkin::physical
