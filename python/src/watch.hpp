#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <softkin/core/progress.hpp>

namespace softkin::python {

namespace nb = nanobind;

/// Lets Python have its say while C++ works without the GIL: signals such as Ctrl-C, and a function of the user's.
class Watch {
 public:
  /// tell: called with (iteration, step_mm, tolerance_mm, share) at most 20 times a second; False stops the work; or None
  explicit Watch(nb::object tell);

  /// For work that is done on the calling thread. The watch must outlive it.
  [[nodiscard]] ProgressCallback callback();
  /// Throws what was raised: KeyboardInterrupt, or what `tell` raised. With the GIL.
  void rethrow();

  /// Does work without the GIL on a thread of its own, and looks for signals meanwhile; calls tick, with the GIL, as
  /// often. go_on() is false once something was raised.
  void watch(const std::function<void()>& work, const std::function<void()>& tick);
  [[nodiscard]] bool go_on() const { return !stopped_; }

 private:
  [[nodiscard]] bool look(const Progress& progress);

  nb::object tell_;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::chrono::steady_clock::rep> next_;
  std::mutex mutex_;
  std::optional<nb::python_error> raised_;
};

/// Calls work without the GIL, then throws what was raised meanwhile.
template <class Work>
auto watched(nb::object tell, const Work& work) {
  Watch watch(std::move(tell));
  auto result = [&] {
    nb::gil_scoped_release released;
    return work(watch.callback());
  }();
  watch.rethrow();
  return result;
}

}  // namespace softkin::python
