#pragma once

#include <softkin/statics/physical/step_tracer.hpp>

namespace softkin::physical {

/// Equilibria on a way of any commands, weights and supports, by the length of their own curve instead of the share of
/// the way: where the way turns back, at the largest share that the robot bears, the curve goes on.
///
/// source  Riks 1979, An incremental approach to the solution of snapping and buckling problems, with the plane across
///         the tangent as the constraint; Allgower, Georg 1990, Numerical continuation methods, chapter 4
class ArcLength : protected Follower {
 public:
  /// lost: the curve could not be followed to one of the others. passed: beyond where steps of the share failed.
  enum class End { lost, passed, turned, interrupted };
  struct Route {
    Demand from{}, to{};  // the way asked for
    double done = 0;      // share of it, at a stable equilibrium
    double failed = 1;    // share ahead at which a step led nowhere
    bool beyond = false;  // on beyond a turn, to where more is borne again
  };
  struct Jump {
    double share = 0, move_mm = 0;  // of the way, where the curve turned; from there
  };

  /// All must outlive the object.
  ArcLength(Settler& settler, StepTracer& tracer, const Equilibria::Options& options, const Route& route);

  /// From the equilibrium `at` along the curve; at is then the last stable one that was found.
  End follow(Iterate& at);

  /// Share at the last one.
  [[nodiscard]] double done() const { return route_.done; }
  /// The largest share, where the curve turned, about.
  [[nodiscard]] double largest() const { return largest_; }
  /// Over which it came to that, where it lies beyond a turn.
  [[nodiscard]] const std::optional<Jump>& jump() const { return jump_; }

 protected:
  /// An equilibrium on the curve. Per unit of its length, in unknowns:
  struct Point {
    Iterate at{};
    double share = 0;
    Eigen::VectorXd ahead{}, multipliers{};  // along which it goes on, of length 1, and what multipliers change by
    double slope = 0;                        // of the share
    Eigen::VectorXd bend{};                  // of what is ahead, by the last point; empty: not known
    double slope_change = 0;                 // the same of the slope
    int negative = 0;                        // eigenvalues of the stiffness that the constraints leave
    double went = 0;                         // along the curve, from the last point
  };

  [[nodiscard]] Demand demand(double share) const { return between(route_.from, route_.to, share); }
  /// Newton's method across from.ahead, until a correction is shorter than `tolerance_mm`.
  ///
  /// whole_mm  largest move of a vertex by the step, which corrections are compared with
  bool correct(const Point& from, double whole_mm, double tolerance_mm, Point& point);
  [[nodiscard]] bool holds(const Point& point) const;
  /// Newton's step by the factorisation at hand from a shape that is put under loads; none where it is forbidden.
  std::optional<Eigen::VectorXd> step_from(Iterate& shape, const Demand& there, Balance& balance);

  const char* why_ = "";  // it was not found
  bool interrupted_ = false;

 private:
  /// A point beyond the turn.
  struct Beyond {
    double away = 0;  // along the curve
    double share = 0, slope = 0;
  };

  /// Steps along the curve: the length of the next one, the shortest; iterations of all; how many may fail in a row,
  /// and how many did.
  struct Pace {
    double length = 0, shortest = 0;
    int most_iterations = 0, most_missed = 0, missed = 0;
  };

  bool set_rates(const Balance& balance, const Eigen::VectorXd* before, Point& point);
  bool begin(const Iterate& at, Point& point);
  std::optional<Point> next(const Point& from, Pace& pace);
  std::optional<Point> go(const Point& from, double length);
  bool is_curve_between(const Point& low, const Point& high, double length);
  [[nodiscard]] double largest_between(const Point& low, const Beyond& high);
  double jump_to(const Point& before, const Point& found, const Iterate& at);
  bool keep(const Point& found, Iterate& at);
  End go_beyond(Point last, Iterate& at);

  Route route_;
  std::optional<Jump> jump_{};
  double largest_ = 0;
  double missed_ = 0;  // by the last step, over its length
};

}  // namespace softkin::physical
