#include <algorithm>
#include <array>
#include <softkin/io/mesh/length_unit.hpp>

namespace softkin {

const std::vector<std::string>& length_units() {
  static const std::vector<std::string> units{"mm", "cm", "m", "um", "in"};
  return units;
}

double mm_per(const std::string& unit) {
  constexpr std::array<double, 5> mm{1, 10, 1000, 0.001, 25.4};
  const auto found = std::find(length_units().begin(), length_units().end(), unit);
  return mm.at(static_cast<std::size_t>(found - length_units().begin()));
}

}  // namespace softkin
