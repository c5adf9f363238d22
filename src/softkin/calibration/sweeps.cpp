#include <algorithm>
#include <softkin/calibration/sweeps.hpp>

namespace softkin::calibration {

namespace {

constexpr double noise_share = 0.1;  // of the drive's range

Sweep sweep(std::size_t from, std::size_t to, double rise) {
  return {from, to + 1, rise > 0 ? Branch::loading : Branch::unloading};
}

/// Where the drive turns, with its first row and its last extreme.
std::vector<std::size_t> turns_of(const std::vector<double>& drive, double noise) {
  std::vector<std::size_t> turns{0};
  std::size_t extreme = 0;
  int direction = 0;  // not known yet
  for (std::size_t i = 1; i < drive.size(); ++i) {
    const double from_extreme = drive[i] - drive[extreme];
    if (direction == 0) {
      if (from_extreme > noise || from_extreme < -noise) {
        direction = from_extreme > 0 ? 1 : -1;
        extreme = i;
      }
    } else if (direction * from_extreme >= 0) {
      extreme = i;
    } else if (-direction * from_extreme > noise) {
      turns.push_back(extreme);
      direction = -direction;
      extreme = i;
    }
  }
  turns.push_back(extreme);
  return turns;
}

}  // namespace

std::vector<Sweep> sweeps_of(const std::vector<double>& drive) {
  if (drive.empty()) return {};
  const auto [low, high] = std::minmax_element(drive.begin(), drive.end());
  if (*low == *high) return {};
  std::vector<std::size_t> turns = turns_of(drive, noise_share * (*high - *low));
  std::vector<Sweep> sweeps;
  for (std::size_t t = 0; t + 1 < turns.size(); ++t)
    sweeps.push_back(sweep(turns[t], turns[t + 1], drive[turns[t + 1]] - drive[turns[t]]));
  sweeps.back().end = drive.size();  // what dwells at the last extreme belongs to the way there
  return sweeps;
}

}  // namespace softkin::calibration
