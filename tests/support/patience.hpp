#pragma once

#include <algorithm>
#include <chrono>

namespace softkin::testing {

/// Is the program one of the address sanitizer, ten times as slow?
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SOFTKIN_INSTRUMENTED
#endif
#endif
#if defined(SOFTKIN_INSTRUMENTED)
inline constexpr bool instrumented = true;
#else
inline constexpr bool instrumented = false;
#endif

/// How many times as long as usual a job takes on this machine, beside what else it does; at least 1.
template <class Job>
double times_slower(double usual_s, const Job& job) {
  const auto begin = std::chrono::steady_clock::now();
  job();
  return std::max(1.0, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / usual_s);
}

/// A limit on wall time [s] as it holds on an idle machine of 2023, made longer for slow and busy ones. Their speed is
/// measured once a program, by divisions each of which waits for the one before.
inline double patient(double seconds) {
  static const double slower = times_slower(0.04, [] {
    double root = 1;
    for (int i = 0; i < 4'000'000; ++i) root = 0.5 * (root + 2 / root) + 1e-9 * i;
    [[maybe_unused]] const volatile double kept = root;
  });
  return seconds * slower;
}

}  // namespace softkin::testing
