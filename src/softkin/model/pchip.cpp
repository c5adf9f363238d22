#include <algorithm>
#include <softkin/model/pchip.hpp>

namespace softkin {

namespace {

/// Slope at the end of the first of two intervals of widths h and secants d that is not shared.
double end_slope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  return std::clamp(slope, std::min(0.0, 3 * d0), std::max(0.0, 3 * d0));
}

/// Weighted harmonic mean of the secants on both sides; 0 where the curve turns.
double inner_slope(double h0, double h1, double d0, double d1) {
  if (d0 == 0 || d1 == 0 || (d0 > 0) != (d1 > 0)) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

}  // namespace

std::vector<double> pchip_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> h(n - 1), d(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x[i + 1] - x[i];
    d[i] = (y[i + 1] - y[i]) / h[i];
  }
  std::vector<double> slopes(n, d[0]);
  if (n == 2) return slopes;
  slopes.front() = end_slope(h[0], h[1], d[0], d[1]);
  slopes.back() = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  for (std::size_t i = 1; i + 1 < n; ++i) slopes[i] = inner_slope(h[i - 1], h[i], d[i - 1], d[i]);
  return slopes;
}

}  // namespace softkin
