#pragma once

#include <softkin/statics/physical/step_tracer.hpp>

namespace softkin::physical {

/// Traces the equilibria on a path of any commands, weights and supports with the arc length of their curve as the
/// parameter instead of the load factor, so that the curve is followed past limit points, where the load factor has a
/// maximum.
///
/// source  Riks 1979, An incremental approach to the solution of snapping and buckling problems, with the plane across
///         the tangent as the constraint; Allgower, Georg 1990, Numerical continuation methods, chapter 4
class ArcLength : protected Follower {
 public:
  /// lost: the curve cannot be followed to any of the other ends. passed: a point lies beyond the load factor at which
  /// load steps failed. turned: the curve has a limit point before that.
  enum class End { lost, passed, turned, interrupted };
  struct Route {
    LoadState from{}, to{};  // ends of the requested path
    double done = 0;         // completed fraction of the path, at a stable equilibrium
    double failed = 1;       // fraction ahead at which a load step failed
    bool beyond = false;     // continue past a limit point, to a larger load factor than there
  };
  struct Jump {
    double load_factor = 0, move_mm = 0;  // load factor at the limit point; largest displacement from there
  };

  /// All must outlive the object.
  ArcLength(Corrector& corrector, StepTracer& tracer, const Equilibria::Options& options, const Route& route);

  /// Follows the curve from the equilibrium `at`, which becomes the last stable equilibrium found.
  End follow(Iterate& at);

  /// Returns the load factor of the last stable equilibrium.
  [[nodiscard]] double done() const { return route_.done; }
  /// Returns the estimated load factor at the limit point.
  [[nodiscard]] double largest() const { return largest_; }
  /// Returns the snap-through by which the last stable equilibrium was reached, if that lies beyond a limit point.
  [[nodiscard]] const std::optional<Jump>& jump() const { return jump_; }

 protected:
  /// An equilibrium on the curve. Derivatives are with respect to the arc length, in the space of the unknowns.
  struct Point {
    Iterate at{};
    double load_factor = 0;
    Eigen::VectorXd ahead{}, multipliers{};  // unit tangent of the unknowns; derivative of the multipliers
    double slope = 0;                        // derivative of the load factor
    Eigen::VectorXd bend{};                  // derivative of `ahead`, from the previous point; empty: unknown
    double slope_change = 0;                 // derivative of `slope`, likewise
    int negative = 0;                        // negative eigenvalues of the stiffness on the constraints' tangent space
    double went = 0;                         // arc length from the previous point
  };

  [[nodiscard]] LoadState load_state(double fraction) const { return between(route_.from, route_.to, fraction); }
  /// Corrects a point by Newton's method in the plane normal to from.ahead, until a correction is shorter than
  /// `tolerance_mm`.
  ///
  /// whole_mm  largest displacement of a vertex by the step, with which corrections are compared
  bool correct(const Point& from, double whole_mm, double tolerance_mm, Point& point);
  [[nodiscard]] bool holds(const Point& point) const;
  /// Applies loads to a shape and returns Newton's step from it with the current factorisation; none if the shape is
  /// inadmissible.
  std::optional<Eigen::VectorXd> step_from(Iterate& shape, const LoadState& there, Balance& balance);

  const char* why_ = "";  // why no point was found
  bool interrupted_ = false;

 private:
  /// A point beyond the limit point.
  struct Beyond {
    double away = 0;  // arc length to it
    double load_factor = 0, slope = 0;
  };

  /// Step-size control along the curve: the length of the next step, the shortest length, the limit on the total of
  /// iterations, and the allowed and the current number of consecutive failed steps.
  struct Pace {
    double length = 0, shortest = 0;
    int max_iterations = 0, max_missed = 0, missed = 0;
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
  double missed_ = 0;  // first correction of the last step, over the length of the step
};

}  // namespace softkin::physical
