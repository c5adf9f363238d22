#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace softkin {

/// The progress report of a long computation.
struct Progress {
  int iteration = 0;        // how many were done
  double step_mm = 0;       // largest move of a vertex in the last iteration [mm]
  double tolerance_mm = 0;  // the step at which it stops [mm]
  double fraction = -1;     // of the path to the requested state, at the last equilibrium on it [-]; < 0: unknown
};

/// Called now and then; returning false stops the computation, which then reports status interrupted.
using ProgressCallback = std::function<bool(const Progress&)>;

/// When work has to come to an end, with what it has by then.
class Deadline {
 public:
  Deadline() = default;  // never
  /// So many seconds from now, > 0. Throws InvalidInput on another number; infinity: never
  explicit Deadline(double budget_s);

  [[nodiscard]] bool passed() const { return std::chrono::steady_clock::now() >= end_; }           // is it over
  [[nodiscard]] bool any() const { return end_ != std::chrono::steady_clock::time_point::max(); }  // will it ever be
  [[nodiscard]] double budget_s() const { return budget_s_; }  // as it was given [s]; infinity: never
  /// "the budget of 5 s was spent"
  [[nodiscard]] std::string spent() const;

 private:
  std::chrono::steady_clock::time_point end_ = std::chrono::steady_clock::time_point::max();
  double budget_s_ = std::numeric_limits<double>::infinity();
};

/// Estimates the time left from the recent rate of progress, so that it follows work that slows down.
class TimeLeft {
 public:
  /// seconds  since the work began
  /// fraction  of it that is done, 0 to 1
  /// returns  [s]; none before there is a pace, and where the work stands still
  [[nodiscard]] std::optional<double> at(double seconds, double fraction);

 private:
  std::deque<std::pair<double, double>> seen_;
};

}  // namespace softkin
