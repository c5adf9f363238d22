#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/model/actuator_curve.hpp>

namespace softkin {

namespace {

std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string range_text(const std::vector<double>& values, const std::string& unit) {
  return short_text(values.front()) + " to " + short_text(values.back()) + unit;
}

}  // namespace

const char* branch_name(Branch branch) {
  return branch == Branch::loading ? "loading" : "unloading";
}

const char* unit_of_input(CurveInput input) {
  return input == CurveInput::pressure ? " kPa" : " kV";
}

const CurveBranch& ActuatorCurve::branch(Branch which) const {
  if (which == Branch::loading) return loading;
  if (!unloading) throw InvalidInput("curve " + file + " has no unloading branch");
  return *unloading;
}

double ActuatorCurve::ratio(double asked, Branch which) const {
  const MonotoneCurve& curve = branch(which).ratio;
  if (asked >= curve.x().front() && asked <= curve.x().back()) return curve.value(asked);
  const bool pressure = input == CurveInput::pressure;
  const bool beyond_end = asked > curve.x().back() && !end.empty();
  throw InvalidInput(std::string(pressure ? "the gauge pressure " : "the voltage ") + short_text(asked) +
                     unit_of_input(input) + " is outside the " + branch_name(which) + " branch of curve " + file +
                     ", " + range_text(curve.x(), unit_of_input(input)) +
                     (beyond_end ? " (it ends there by " + end + ")" : ""));
}

double ActuatorCurve::input_of(double asked, Branch which) const {
  const MonotoneCurve& curve = branch(which).ratio;
  if (asked >= curve.y().front() && asked <= curve.y().back()) return curve.inverse(asked);
  throw InvalidInput("the ratio " + short_text(asked) + " is outside the " + branch_name(which) + " branch of curve " +
                     file + ", " + range_text(curve.y(), " [-]"));
}

}  // namespace softkin
