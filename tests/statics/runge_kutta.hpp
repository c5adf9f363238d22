#pragma once

#include <vector>

namespace softkin::testing {

/// What flows while something imposed changes evenly from one value to another: the classical method of fourth order.
///
/// rate(value, flowed)  by time
template <class Rate>
void integrate(std::vector<double>& flowed, double from, double to, double time, int steps, const Rate& rate) {
  const double h = time / steps;
  const auto moved = [&](const std::vector<double>& rates, double by) {
    std::vector<double> result = flowed;
    for (std::size_t k = 0; k < result.size(); ++k) result[k] += by * rates[k];
    return result;
  };
  for (int i = 0; i < steps; ++i) {
    const auto at = [&](double fraction) { return from + (to - from) * (i + fraction) / steps; };
    const std::vector<double> a = rate(at(0), flowed), b = rate(at(0.5), moved(a, h / 2)),
                              c = rate(at(0.5), moved(b, h / 2)), d = rate(at(1), moved(c, h));
    for (std::size_t k = 0; k < flowed.size(); ++k) flowed[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
}

}  // namespace softkin::testing
