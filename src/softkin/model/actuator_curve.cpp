#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/actuator_curve.hpp>
#include <softkin/model/pchip.hpp>
#include <utility>

namespace softkin {

namespace {

void check_ascending(const std::vector<double>& values, const char* what) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) throw InvalidInput(std::string("a curve has a ") + what + " that is not finite");
    if (i > 0 && !(values[i] > values[i - 1]))
      throw InvalidInput(std::string("the ") + what + "s of a curve must ascend from point to point");
  }
}

/// Interval of ascending values that holds value, which lies within them.
std::size_t interval_of(const std::vector<double>& values, double value) {
  const auto above = std::upper_bound(values.begin() + 1, values.end() - 1, value);
  return static_cast<std::size_t>(above - values.begin()) - 1;
}

void check_inside(const std::vector<double>& values, double value) {
  if (!(value >= values.front() && value <= values.back())) throw InvalidInput("outside the curve");
}

std::string range_text(const std::vector<double>& values, const std::string& unit) {
  return number(values.front()) + " to " + number(values.back()) + unit;
}

}  // namespace

MonotoneCurve::MonotoneCurve(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
  if (x_.size() != y_.size()) throw InvalidInput("a curve needs as many values as places");
  if (x_.size() < 2) throw InvalidInput("a curve needs at least two points");
  check_ascending(x_, "place");
  check_ascending(y_, "value");
  for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
    const double secant = (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]);
    if (!(secant > 0 && std::isfinite(secant))) throw InvalidInput("two points of a curve are too near to each other");
  }
  slopes_ = pchip_slopes(x_, y_);
}

double MonotoneCurve::cubic(std::size_t i, double t) const {
  const double h = x_[i + 1] - x_[i], dy = y_[i + 1] - y_[i];
  const double a = h * slopes_[i], b = h * slopes_[i + 1];
  return y_[i] + t * (a + t * ((3 * dy - 2 * a - b) + t * (a + b - 2 * dy)));
}

double MonotoneCurve::value(double x) const {
  check_inside(x_, x);
  if (x == x_.back()) return y_.back();
  const std::size_t i = interval_of(x_, x);
  return cubic(i, (x - x_[i]) / (x_[i + 1] - x_[i]));
}

double MonotoneCurve::inverse(double y) const {
  check_inside(y_, y);
  if (y == y_.back()) return x_.back();
  const std::size_t i = interval_of(y_, y);
  double low = 0, high = 1;
  constexpr int bits = 60;  // of the fraction: beyond double precision
  for (int k = 0; k < bits; ++k) {
    const double middle = (low + high) / 2;
    (cubic(i, middle) > y ? high : low) = middle;
  }
  return x_[i] + low * (x_[i + 1] - x_[i]);
}

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

double ActuatorCurve::ratio(double requested, Branch which) const {
  const MonotoneCurve& curve = branch(which).ratio;
  if (requested >= curve.x().front() && requested <= curve.x().back()) return curve.value(requested);
  const bool pressure = input == CurveInput::pressure;
  const bool beyond_end = requested > curve.x().back() && !end.empty();
  throw InvalidInput(std::string(pressure ? "the gauge pressure " : "the voltage ") + number(requested) +
                     unit_of_input(input) + " is outside the " + branch_name(which) + " branch of curve " + file +
                     ", " + range_text(curve.x(), unit_of_input(input)) +
                     (beyond_end ? " (it ends there by " + end + ")" : ""));
}

}  // namespace softkin
