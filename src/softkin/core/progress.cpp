#include <algorithm>
#include <softkin/core/progress.hpp>

namespace softkin {

std::optional<double> TimeLeft::at(double seconds, double share) {
  constexpr double least_share = 0.02, least_window = 5, window_share = 0.25;
  const double window = std::max(least_window, window_share * seconds);
  if (seen_.empty()) seen_.emplace_back(0, 0);
  if (seconds - seen_.back().first >= window / 100) seen_.emplace_back(seconds, share);
  while (seen_.size() > 2 && seen_[1].first <= seconds - window) seen_.pop_front();
  const double done = share - seen_.front().second, time = seconds - seen_.front().first;
  if (share < least_share || !(done > 0) || !(time > 0)) return std::nullopt;
  return time * (1 - share) / done;
}

}  // namespace softkin
