#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace softkin {

/// A strictly ascending function through given points: a cubic between neighbours, continuously differentiable, without
/// overshoot; and its inverse.
///
/// source  Fritsch and Carlson, SIAM J. Numer. Anal. 17(2), 1980; slopes at the points are those of Fritsch and
///         Butland, SIAM J. Sci. Stat. Comput. 5(2), 1984, at the ends three-point differences limited to stay
///         monotone (PCHIP)
class MonotoneCurve {
 public:
  /// throws  InvalidInput: fewer than two points, not as many x as y, numbers that are not finite or do not ascend
  MonotoneCurve(std::vector<double> x, std::vector<double> y);

  /// The points that it was made of.
  [[nodiscard]] const std::vector<double>& x() const { return x_; }
  [[nodiscard]] const std::vector<double>& y() const { return y_; }

  /// throws  InvalidInput outside x().front() to x().back()
  [[nodiscard]] double value(double x) const;
  /// The x whose value is y, to rounding.
  ///
  /// throws  InvalidInput outside y().front() to y().back()
  [[nodiscard]] double inverse(double y) const;

 private:
  /// Value of the cubic of interval i at the fraction t of it.
  [[nodiscard]] double cubic(std::size_t i, double t) const;

  std::vector<double> x_, y_, slopes_;
};

/// The input of a calibrated actuator: gauge pressure [kPa] (pneumatic) or voltage [kV] (dea).
enum class CurveInput { pressure, voltage };

/// Of a hysteresis: the input rises, or it falls.
enum class Branch { loading, unloading };

/// One branch of a curve: the ratio that an input gives.
struct CurveBranch {
  MonotoneCurve ratio;         // of the input [kPa gauge or kV]: volume or area over that without input [-]
  std::vector<double> spread;  // standard deviation of the ratio between repeated runs, per point; empty: not known
};

/// Measured or computed relation between an actuator's input and its volume or area.
struct ActuatorCurve {
  std::string file;                         // for messages
  CurveInput input = CurveInput::pressure;  // the quantity of which it is a function
  double atmosphere_kPa = 100;              // absolute; that of the gauge pressures
  std::string end;                          // why it ends at its highest input ("pull-in"); empty: end of measurements
  CurveBranch loading;                      // of a rising input
  std::optional<CurveBranch> unloading;     // of a falling one; none: not measured

  /// throws  InvalidInput where the curve has no unloading branch
  [[nodiscard]] const CurveBranch& branch(Branch which) const;
  /// throws  InvalidInput, naming file, branch and range, outside the branch; nothing is extrapolated
  [[nodiscard]] double ratio(double input, Branch which) const;
};

/// "loading" or "unloading".
[[nodiscard]] const char* branch_name(Branch branch);
/// " kPa" or " kV".
[[nodiscard]] const char* unit_of_input(CurveInput input);

}  // namespace softkin
