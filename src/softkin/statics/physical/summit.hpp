#pragma once

#include <optional>
#include <softkin/statics/physical/step_tracer.hpp>

namespace softkin::physical {

/// What a share of one way is of all that was asked.
struct WholeWay {
  double before = 0;   // gone on ways before
  bool aside = false;  // is the way at hand one to where another begins
  [[nodiscard]] double operator()(double done) const { return aside ? before : before + (1 - before) * done; }
};

/// A way on which one load changes beside weights and forces, gone along what the load does, its volume or its length:
/// there a maximum of the load is no end. Where the load's slope by that measure is zero it is at its maximum.
///
/// source  Riks' idea, with the load's own measure as the parameter
class Climb : Follower {
 public:
  enum class End { lost, arrived, summit, interrupted };
  struct Route {
    Index load = -1;      // of the actuators
    Demand from{}, to{};  // the way asked for
    Demand here{};        // the last good equilibrium on it
    double done = 0;      // share of the way
    WholeWay whole{};
  };

  /// All must outlive the object.
  Climb(Settler& settler, StepTracer& tracer, const Equilibria::Options& options, const Route& route);

  /// From where the way is. lost: as far as it leads, and loads go on from there.
  End up(Iterate& at);
  /// From a shape beyond a maximum to where the load is as asked; lost: it is not beyond one.
  End back(Iterate& at);

  /// What the way's end is an equilibrium of.
  [[nodiscard]] const Route& route() const { return route_; }
  /// Did it come to a maximum of the load?
  [[nodiscard]] bool at_summit() const { return at_summit_; }

 private:
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
  /// What stopped a way along a measure: the load that was asked, the measure, or nothing that follows.
  enum class Passed { asked, end, nowhere, interrupted };

  [[nodiscard]] double asked_load() const { return route_.to.actuation[load_]; }
  [[nodiscard]] double first_load() const { return route_.from.actuation[load_]; }
  [[nodiscard]] Ascent ascent_from(const Iterate& at);
  Search<Measured> at_measure(double measure, const Measured& from, bool prepared, const Measured* beside);
  Search<Measured> nearly_at(double measure, const Measured& from, bool prepared, const Measured* beside);
  void bend(const Demand& here, const Demand& there, const Measured& from, const Measured& beside, Iterate& trial);
  [[nodiscard]] static double left_to_summit(double way, const Measured* beside, const Measured& low,
                                             const Measured& next);
  [[nodiscard]] static bool at_maximum(const Measured& point);
  double slope_at(const Demand& load, const Measured& point);
  End arrive_at(const Measured& near, Iterate& at, Newton::Policy policy);
  End arrive_before(Measured next, const Ascent& ascent, Iterate& at);
  End arrive_between(Measured low, Measured high, Iterate& at);
  End stop_at(double way, double begin, const Measured& summit, Iterate& at);
  Passed go_along(double way, double end, double longest, Measured& last, std::optional<Measured>& next);
  End go_beyond(double way, const Measured& summit, Iterate& at);
  void keep(const Measured& kept, Iterate& at);
  Search<Measured> exactly(Measured found);
  [[nodiscard]] double share_of(double load) const;
  void note_branch(const Measured& point);
  [[nodiscard]] std::string measure_text(double measure) const;
  [[nodiscard]] std::string load_text(double load) const;
  void tell_beyond(const Measured& last, bool asked);
  void tell_summit(const Measured& summit);

  Route route_;
  Index load_;
  bool at_summit_ = false;
};

/// Notes a jump where it is the longest so far.
///
/// from  share of all that was asked
void tell_snap(double move_mm, double from, SolveReport& report);
/// The points of a way along what a load does in the order of its measure; nothing where the way did not go so.
void sort_branch(const System& system, SolveReport& report);

}  // namespace softkin::physical
