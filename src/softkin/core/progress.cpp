#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/progress.hpp>
#include <softkin/core/text.hpp>

namespace softkin {

Deadline::Deadline(double budget_s) : budget_s_(budget_s) {
  if (!(budget_s > 0)) throw InvalidInput("a budget must be more than 0 s, not " + number(budget_s) + " s");
  constexpr double longest_s = 1e9;  // within the range of a clock
  if (budget_s > longest_s) return;
  end_ = std::chrono::steady_clock::now() +
         std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(budget_s));
}

std::string Deadline::spent() const {
  return "the budget of " + number(budget_s_) + " s was spent";
}

std::optional<double> TimeLeft::at(double seconds, double fraction) {
  constexpr double min_fraction = 0.02, min_window = 5, window_fraction = 0.25;
  const double window = std::max(min_window, window_fraction * seconds);
  if (seen_.empty()) seen_.emplace_back(0, 0);
  if (seconds - seen_.back().first >= window / 100) seen_.emplace_back(seconds, fraction);
  while (seen_.size() > 2 && seen_[1].first <= seconds - window) seen_.pop_front();
  const double done = fraction - seen_.front().second, time = seconds - seen_.front().first;
  if (fraction < min_fraction || !(done > 0) || !(time > 0)) return std::nullopt;
  return time * (1 - fraction) / done;
}

}  // namespace softkin
