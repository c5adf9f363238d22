#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/actuator_curve.hpp>
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

/// Slope at the end of the first of two intervals of widths h and secants d that is not shared.
double end_slope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  return std::clamp(slope, 0.0, 3 * d0);
}

/// Weighted harmonic mean of the secants on both sides.
double inner_slope(double h0, double h1, double d0, double d1) {
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
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
  const std::size_t n = x_.size();
  std::vector<double> h(n - 1), d(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x_[i + 1] - x_[i];
    d[i] = (y_[i + 1] - y_[i]) / h[i];
    if (!(d[i] > 0 && std::isfinite(d[i]))) throw InvalidInput("two points of a curve are too near to each other");
  }
  slopes_.assign(n, d[0]);
  if (n == 2) return;
  slopes_.front() = end_slope(h[0], h[1], d[0], d[1]);
  slopes_.back() = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  for (std::size_t i = 1; i + 1 < n; ++i) slopes_[i] = inner_slope(h[i - 1], h[i], d[i - 1], d[i]);
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

double ActuatorCurve::ratio(double asked, Branch which) const {
  const MonotoneCurve& curve = branch(which).ratio;
  if (asked >= curve.x().front() && asked <= curve.x().back()) return curve.value(asked);
  const bool pressure = input == CurveInput::pressure;
  const bool beyond_end = asked > curve.x().back() && !end.empty();
  throw InvalidInput(std::string(pressure ? "the gauge pressure " : "the voltage ") + number(asked) +
                     unit_of_input(input) + " is outside the " + branch_name(which) + " branch of curve " + file +
                     ", " + range_text(curve.x(), unit_of_input(input)) +
                     (beyond_end ? " (it ends there by " + end + ")" : ""));
}

}  // namespace softkin
