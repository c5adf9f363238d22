#pragma once

#include <string>
#include <vector>

namespace softkin {

/// What an axis shows, low < high; logarithmic: 0 < low.
struct AxisRange {
  double low = 0, high = 1;
};

/// Range of an axis over data from low to high with 4 % around them; where they are one value (to rounding), that
/// value is in the middle. Logarithmic, 0 < low: 4 % around whole decades.
[[nodiscard]] AxisRange range_around(double low, double high, bool logarithmic);

struct AxisTicks {
  std::vector<double> values;  // ascending, inside the range
  std::vector<std::string> labels;
};

/// Round numbers: multiples of 1, 2 or 5 times a power of ten, at least 2 and at most `most` >= 5 of them; whole: of
/// whole numbers (then there may be fewer than 2). Labels have as many digits as are needed to distinguish them.
[[nodiscard]] AxisTicks round_ticks(const AxisRange& range, int most, bool whole);

/// Powers of ten, at most `most` >= 2 of them.
[[nodiscard]] AxisTicks decade_ticks(const AxisRange& range, int most);

/// From values to pixels; begin and end are the pixels of the range's ends.
struct AxisScale {
  AxisRange range;
  double begin = 0, end = 1;
  bool logarithmic = false;

  [[nodiscard]] double at(double value) const;
};

}  // namespace softkin
