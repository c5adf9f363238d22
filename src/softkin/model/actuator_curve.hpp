#pragma once

#include <optional>
#include <softkin/model/monotone_curve.hpp>
#include <string>

namespace softkin {

/// What a calibrated actuator is driven by: gauge pressure [kPa] (pneumatic) or voltage [kV] (dea).
enum class CurveInput { pressure, voltage };

/// Of a hysteresis: the input rises, or it falls.
enum class Branch { loading, unloading };

struct CurveBranch {
  MonotoneCurve ratio;         // of the input [kPa gauge or kV]: volume or area over that without input [-]
  std::vector<double> spread;  // standard deviation of the ratio between repeated runs, per point; empty: not known
};

/// Measured or computed relation between an actuator's input and its volume or area.
struct ActuatorCurve {
  std::string file;  // for messages
  CurveInput input = CurveInput::pressure;
  double atmosphere_kPa = 100;  // absolute; that of the gauge pressures
  std::string end;              // what ends it at its highest input ("pull-in"); empty: the measurements
  CurveBranch loading;
  std::optional<CurveBranch> unloading;

  /// throws  InvalidInput where the curve has no unloading branch
  [[nodiscard]] const CurveBranch& branch(Branch which) const;
  /// throws  InvalidInput, naming file, branch and range, outside the branch; nothing is extrapolated
  [[nodiscard]] double ratio(double input, Branch which) const;
  [[nodiscard]] double input_of(double ratio, Branch which) const;
};

[[nodiscard]] const char* branch_name(Branch branch);
/// " kPa" or " kV".
[[nodiscard]] const char* unit_of_input(CurveInput input);

}  // namespace softkin
