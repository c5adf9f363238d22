#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/io/plot/svg_axis.hpp>

namespace softkin {

namespace {

constexpr double around = 0.04;    // of the data's extent, left free on either side
constexpr double rounding = 1e-9;  // of a value: below it an extent is noise

/// digit * 10^exponent, exact where a decimal number can be.
struct RoundNumber {
  int digit = 1, exponent = 0;

  [[nodiscard]] double times(double count) const {
    const double power = std::pow(10, std::abs(exponent));
    return exponent < 0 ? count * digit / power : count * digit * power;
  }
  void grow() {
    if (digit == 5) ++exponent;
    digit = digit == 1 ? 2 : digit == 2 ? 5 : 1;
  }
};

/// Multiples of a step in a range, as counts.
struct Multiples {
  double first = 0, last = 0;

  Multiples(const AxisRange& range, const RoundNumber& step) {
    const double slack = 1e-9;
    first = std::ceil(range.low / step.times(1) - slack);
    last = std::floor(range.high / step.times(1) + slack);
  }
  [[nodiscard]] double count() const { return last - first + 1; }
};

std::string without_zeros(std::string exponent) {
  const std::size_t at = exponent.find('e') + 1;
  const bool negative = exponent[at] == '-';
  const std::size_t digits = std::min(exponent.find_first_not_of("+-0", at), exponent.size() - 1);
  return exponent.substr(0, at) + (negative ? "-" : "") + exponent.substr(digits);
}

std::string label_of(double value, double largest, const RoundNumber& step) {
  char text[64];
  if (value == 0) return "0";
  if (largest < 1e6 && step.exponent >= -5) {
    std::snprintf(text, sizeof text, "%.*f", std::max(0, -step.exponent), value);
    return text;
  }
  const int digits = static_cast<int>(std::floor(std::log10(std::abs(value)) + rounding)) - step.exponent;
  std::snprintf(text, sizeof text, "%.*e", std::clamp(digits, 0, 16), value);
  return without_zeros(text);
}

}  // namespace

AxisRange range_around(double low, double high, bool logarithmic) {
  if (logarithmic) {
    AxisRange range{std::floor(std::log10(low) + rounding), std::ceil(std::log10(high) - rounding)};
    if (!(range.low < range.high)) {
      range.low -= 1;
      range.high += 1;
    }
    const double beside = around * (range.high - range.low);  // or marks at the ends would be cut
    return {std::pow(10, range.low - beside), std::pow(10, range.high + beside)};
  }
  const double size = std::max(std::abs(low), std::abs(high));
  if (high - low > rounding * size) return {low - around * (high - low), high + around * (high - low)};
  const double half = size > 0 ? 0.05 * size : 1;
  const double middle = low + (high - low) / 2;
  return {middle - half, middle + half};
}

AxisTicks round_ticks(const AxisRange& range, int most, bool whole) {
  RoundNumber step{1, static_cast<int>(std::floor(std::log10((range.high - range.low) / most)))};
  if (whole && step.exponent < 0) step = {1, 0};
  while (Multiples(range, step).count() > most) step.grow();
  const Multiples multiples(range, step);
  AxisTicks ticks;
  for (double i = multiples.first; i <= multiples.last; ++i) ticks.values.push_back(i == 0 ? 0.0 : step.times(i));
  double largest = 0;
  for (const double value : ticks.values) largest = std::max(largest, std::abs(value));
  for (const double value : ticks.values) ticks.labels.push_back(label_of(value, largest, step));
  return ticks;
}

AxisTicks decade_ticks(const AxisRange& range, int most) {
  const int low = static_cast<int>(std::ceil(std::log10(range.low) - rounding));
  const int high = static_cast<int>(std::floor(std::log10(range.high) + rounding));
  const int every = (high - low) / most + 1;
  AxisTicks ticks;
  for (int exponent = low; exponent <= high; exponent += every) {
    ticks.values.push_back(std::pow(10, exponent));
    char text[32];
    std::snprintf(text, sizeof text, "%.*f", std::max(0, -exponent), ticks.values.back());
    ticks.labels.emplace_back(std::abs(exponent) > 3 ? "1e" + std::to_string(exponent) : std::string(text));
  }
  return ticks;
}

double AxisScale::at(double value) const {
  const double fraction = logarithmic ? std::log(value / range.low) / std::log(range.high / range.low)
                                      : (value - range.low) / (range.high - range.low);
  return begin + fraction * (end - begin);
}

}  // namespace softkin
