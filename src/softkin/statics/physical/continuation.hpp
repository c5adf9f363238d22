#pragma once

#include <optional>
#include <softkin/statics/physical/arc_length.hpp>
#include <softkin/statics/physical/corrector.hpp>
#include <softkin/statics/physical/measure_continuation.hpp>
#include <softkin/statics/physical/segment_check.hpp>
#include <softkin/statics/physical/step_tracer.hpp>

namespace softkin::physical {

/// Follows the path of equilibria from one load state to another: predictor, step-size control, limits, and where the
/// path becomes unstable.
class Continuation {
 public:
  /// All must outlive the object.
  Continuation(const System& system, Workspace& work, Team& team, const Equilibria::Options& options,
               const ProgressCallback& progress, SolveRecord& record, SolveReport& report);

  /// Follows the equilibrium from `from` to `to`; `at` becomes the last accepted one.
  Status follow(const LoadState& from, const LoadState& to, Iterate& at);

  /// The load state of the last accepted equilibrium.
  [[nodiscard]] const LoadState& here() const { return path_.here; }

  /// Did the path end at a limit point of its load?
  [[nodiscard]] bool at_limit_point() const { return at_limit_point_; }

 private:
  /// The current step.
  struct Step {
    Points predicted{}, begun{};      // the prediction, and its part without collision
    Points straight{};                // the first-order prediction, along the tangent
    double move_mm = 0, jump_mm = 0;  // largest predicted move; distance of the end from the path
    bool unpredicted = false;         // is there no tangent that predicts its end
    bool extrapolated = false;        // was it predicted from nearby equilibria, without a tangent
  };
  /// The result of a step.
  struct StepEnd {
    std::string why{};                    // reason of its end
    bool found = false, blocked = false;  // was an equilibrium found; did a collision block the motion
    bool snap = false, unstable = false;  // properties of that equilibrium
    bool interrupted = false;             // did the caller interrupt the check
  };
  /// The end of a step that snapped through; it is accepted if shorter steps find no equilibrium.
  struct Beyond {
    Iterate at;
    LoadState load_state;
    double done = 0;
    std::vector<bool> active;
    Judgement last;
    double jump_mm = 0;
  };

  /// The smallest load factor ahead at which a step failed.
  struct Failed {
    double load_factor = 0;  // 0: none
    double ahead = 0;        // its distance from the equilibrium at that time

    void note(double at, double done);
  };

  /// The requested path and its progress.
  struct PathState {
    LoadState from{}, to{}, here{};
    double done = 0, advance = 1;  // fractions of it: completed, and of the next step
    Index load = -1;               // the only one that changes besides dead loads, until its measure is followed
    bool loads_change = false;
    bool releases = false;    // a body is released, which hardly moves until it is nearly free
    bool factorised = false;  // is the stiffness at the current shape factorised
    std::optional<Beyond> beyond{};
    std::optional<LoadState> then{};  // the end of the next path
    Failed failed{};
    bool thorough = true;  // may the next step use all iterations
    double before = 0;     // fraction of the whole request that earlier paths completed
    double marked = 0;     // the fraction at the last sufficient progress
    int marked_iterations = 0;
    int misses = 0, next_look = 0;   // failed steps; how many start arc-length continuation
    bool turned = false;             // does the curve of equilibria turn back here
    bool carries_full_load = false;  // does a shape after the turn carry about the whole load

    [[nodiscard]] WholePath whole() const { return {before, then.has_value()}; }
  };

  /// The state in which the path was split into dead loads and other loads.
  struct Together {
    PathState path;
    Iterate at;
    std::vector<bool> active;
    Judgement last;
  };

  // the path
  Status follow_whole(const LoadState& from, const LoadState& to, Iterate& at);
  void set_out(const LoadState& from, const LoadState& to);
  Newton::Outcome correct_here(const LoadState& load_state, Iterate& at);
  [[nodiscard]] double whole(double done) const { return path_.whole()(done); }
  [[nodiscard]] Index only_load(const LoadState& from, const LoadState& to) const;
  [[nodiscard]] bool change_loads(const LoadState& from, const LoadState& to) const;
  [[nodiscard]] bool changes_with_load_factor() const;
  [[nodiscard]] bool holds_elsewhere() const;
  std::optional<Status> go_on(Iterate& at);
  void pass(const LoadState& load_state, double done);
  bool come_to(const LoadState& there, double next, bool unstable, Iterate& at);
  bool loads_at_last(const Iterate& at);
  void go_together(Iterate& at);
  ArcLength::End follow_curve(Iterate& at);
  MeasureContinuation::End follow_measure(MeasureContinuation::End (MeasureContinuation::*along)(Iterate&), Index load,
                                          Iterate& at);

  // a step
  std::optional<Status> start_step(const LoadState& there, Iterate& at);
  Newton::Outcome step(const LoadState& here, const LoadState& there, double length, const Iterate& at, Iterate& trial);
  Newton::Outcome step_from_flat(const LoadState& there, const Iterate& at, Iterate& trial);
  Newton::Outcome fall_onto(const LoadState& here, const LoadState& there, const Iterate& at, Iterate& trial);
  bool extrapolate(const LoadState& here, const LoadState& there, Iterate& trial);
  bool leads_too_far(const LoadState& here, const LoadState& there, const Iterate& at);
  SegmentCheck::Verdict check_segment(double length, bool changed, const Iterate& at, const Iterate& trial);
  void check_path(double length, bool changed, const Iterate& at, const Iterate& trial, StepEnd& end);
  [[nodiscard]] StepEnd judge(Newton::Outcome outcome, const LoadState& there, double length, const Iterate& at,
                              const Iterate& trial);
  bool turned_back(const Iterate& at, const Iterate& trial);
  bool jumped(const LoadState& here, const LoadState& there, const Iterate& at, const Iterate& trial);
  [[nodiscard]] bool snapped(double predicted_mm, double correction_mm) const;
  bool leads_beyond(const Iterate& at);
  void take_beyond(Iterate& at);

  // its length
  [[nodiscard]] double next_fraction();
  [[nodiscard]] double longest_step(bool snap, bool unstable) const;
  void lengthen(int iterations, bool unstable, Iterate& at);
  [[nodiscard]] double lengthened(int iterations) const;
  std::optional<Status> shorten(double length, Iterate& at);
  [[nodiscard]] double shortest_advance() const;
  [[nodiscard]] bool ends_early(bool short_step) const;
  [[nodiscard]] bool is_smooth() const;
  [[nodiscard]] bool is_non_smooth() const { return system_.contact() || path_.releases; }

  // the end
  Status arrive(const LoadState& load_state, Iterate& at);
  Status limit(double done, const std::string& why, const Iterate& at);
  std::optional<Status> out_of_patience(const Iterate& at);
  void report_stability(const LoadState& load_state, const Iterate& at);
  void report_balance();
  [[nodiscard]] std::string beyond_here() const;
  [[nodiscard]] std::string instead_of_loads() const;

  const System& system_;
  Workspace& work_;
  Team& team_;
  const Equilibria::Options& options_;
  const PathOptions& tuning_;
  SolveRecord& record_;
  SolveReport& report_;
  Corrector corrector_;
  StepTracer tracer_;
  PathState path_;
  Step step_;
  std::optional<Together> together_;
  std::string measure_remark_{};  // of the last measure-controlled continuation
  bool at_limit_point_ = false;
};

}  // namespace softkin::physical
