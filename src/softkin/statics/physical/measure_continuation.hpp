#pragma once

#include <optional>
#include <softkin/statics/physical/step_tracer.hpp>

namespace softkin::physical {

/// Converts the completed fraction of a path segment to that of the whole requested path.
struct WholePath {
  double before = 0;   // fraction completed by earlier segments
  bool aside = false;  // whether the segment only leads to the start of another one
  [[nodiscard]] double operator()(double done) const { return aside ? before : before + (1 - before) * done; }
};

/// Traces a path on which one load changes besides weights and forces, with the load's own measure (volume or length)
/// as the parameter, so that a maximum of the load does not end it. The load is at its maximum, a limit point, where
/// its derivative with respect to the measure is zero.
///
/// source  Riks' idea, with the load's own measure as the parameter
class MeasureContinuation : Follower {
 public:
  enum class End { lost, arrived, limit_point, interrupted };
  struct Route {
    Index load = -1;         // index among the actuators
    LoadState from{}, to{};  // ends of the requested path
    LoadState here{};        // load state of the last accepted equilibrium
    double done = 0;         // completed fraction of the path
    WholePath whole{};
  };

  /// All must outlive the object.
  MeasureContinuation(Corrector& corrector, StepTracer& tracer, const Equilibria::Options& options, const Route& route);

  /// Traces the path from its current equilibrium. End::lost: the path ends at the last equilibrium found, and load
  /// control continues from it.
  End up(Iterate& at);
  /// Traces a post-limit-point branch back to the requested load. End::lost: the shape is not on such a branch.
  End back(Iterate& at);

  /// The route, whose member `here` is the load state of the equilibrium that was reached.
  [[nodiscard]] const Route& route() const { return route_; }
  /// Returns what is to be reported about the maximum at which the path ended; "" where it did not.
  [[nodiscard]] const std::string& remark() const { return remark_; }
  /// Has the path reached a maximum of the load?
  [[nodiscard]] bool at_limit_point() const { return at_limit_point_; }

 private:
  /// An equilibrium at a given volume or length instead of a given load.
  struct Measured {
    double measure = 0;  // relative to the measure at rest [-]
    double load = 0;     // load that the measure requires [N, kPa]
    Iterate at;
    Judgement last{};
    double gain = 0;         // derivative of the load with respect to the measure, positive before the maximum
    double load_factor = 1;  // load factor of weights and forces
    double short_of = 0;     // estimated change of the measure up to the maximum
  };
  /// State of a continuation along the measure of a load. Two points bracket the maximum once it is passed.
  struct Ascent {
    double up = 1, path = 1;                   // signs of the changes of load and measure
    double begin = 0, length = 0;              // first measure; length of the next step
    Measured low{};                            // last point before the maximum
    std::optional<Measured> high{}, passed{};  // point beyond the maximum; point before `low`

    [[nodiscard]] const Measured* beside() const { return high ? &*high : passed ? &*passed : nullptr; }
    void take(Measured&& next, const MeasureControlOptions& by);
  };
  /// The reason why a path along a measure ends: the requested load, the last measure, a failed step or an
  /// interruption.
  enum class Passed { requested, end, nowhere, interrupted };

  [[nodiscard]] double requested_load() const { return route_.to.actuation[load_]; }
  [[nodiscard]] double first_load() const { return route_.from.actuation[load_]; }
  [[nodiscard]] Ascent ascent_from(const Iterate& at);
  Search<Measured> at_measure(double measure, const Measured& from, bool prepared, const Measured* beside);
  Search<Measured> nearly_at(double measure, const Measured& from, bool prepared, const Measured* beside);
  void bend(const LoadState& here, const LoadState& there, const Measured& from, const Measured& beside,
            Iterate& trial);
  [[nodiscard]] static double left_to_summit(double path, const Measured* beside, const Measured& low,
                                             const Measured& next);
  [[nodiscard]] bool at_maximum(const Measured& point) const;
  double slope_at(const LoadState& load, const Measured& point);
  End arrive_at(const Measured& near, Iterate& at, Newton::Policy policy);
  End arrive_before(Measured next, const Ascent& ascent, Iterate& at);
  End arrive_between(Measured low, Measured high, Iterate& at);
  End stop_at(double path, double begin, const Measured& limit_point, Iterate& at);
  Passed go_along(double path, double end, double longest, Measured& last, std::optional<Measured>& next);
  End go_beyond(double path, const Measured& limit_point, Iterate& at);
  void keep(const Measured& kept, Iterate& at);
  Search<Measured> exactly(Measured found);
  [[nodiscard]] double fraction_of(double load) const;
  void note_branch(const Measured& point);
  [[nodiscard]] std::string measure_text(double measure) const;
  [[nodiscard]] std::string load_text(double load) const;
  void report_beyond(const Measured& last, bool requested);
  void report_limit_point(const Measured& limit_point);

  Route route_;
  Index load_;
  std::string remark_{};
  bool at_limit_point_ = false;
};

/// Sorts the points of a path along a measure by that measure. Does nothing if no path was traced by a measure.
void sort_branch(const System& system, LoadBranch& branch);

}  // namespace softkin::physical
