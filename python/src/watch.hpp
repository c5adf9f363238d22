#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <softkin/core/progress.hpp>
#include <thread>
#include <utility>

namespace softkin::python {

namespace nb = nanobind;

/// Python's progress callback: iteration, step [mm], tolerance [mm], fraction; or None.
using ProgressFunction = std::optional<nb::typed<nb::callable, nb::object(int, double, double, double)>>;

/// Serves Python while C++ works without the GIL: signals such as Ctrl-C, and a progress callback of the user's.
class Watch {
 public:
  /// on_progress: called with (iteration, step_mm, tolerance_mm, fraction) at most 20 times a second; False stops the
  /// work; or None
  explicit Watch(const ProgressFunction& on_progress);

  /// For work that is done on the calling thread. The watch must outlive it.
  [[nodiscard]] ProgressCallback callback();
  /// Throws the exception that was raised: KeyboardInterrupt, or one of `on_progress`. Call it with the GIL.
  void rethrow();

  /// Does work without the GIL on a thread of its own, and looks for signals meanwhile; calls tick, with the GIL, as
  /// often. go_on() is false once something was raised.
  void watch(const std::function<void()>& work, const std::function<void()>& tick);
  [[nodiscard]] bool go_on() const { return !stopped_; }

  static constexpr std::chrono::milliseconds between_looks{50};
  /// Call it with the GIL. Returns false where the work is to stop. progress: to report; null: nothing new
  [[nodiscard]] bool look(const Progress* progress);
  [[nodiscard]] bool has_raised() const { return raised_.has_value(); }

 private:
  ProgressFunction report_;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::chrono::steady_clock::rep> next_;
  std::mutex mutex_;
  std::optional<nb::python_error> raised_;
};

/// Threads whose results are not needed any more; they end by themselves. They are joined before Python ends.
class Abandoned {
 public:
  static void take(std::thread thread, std::shared_ptr<std::atomic<bool>> ended);
  static void join();
};

/// Calls work without the GIL, then throws what was raised meanwhile.
template <class Work>
auto watched(const ProgressFunction& on_progress, const Work& work) {
  Watch watch(on_progress);
  auto result = [&] {
    nb::gil_scoped_release released;
    return work(watch.callback());
  }();
  watch.rethrow();
  return result;
}

/// The same on a thread of its own, for work that polls seldom: an exception does not wait for it. The callback then
/// stops the work, which owns all that it uses; none of it is Python's.
template <class Work>
auto watched_apart(const ProgressFunction& on_progress, Work work) -> decltype(work(ProgressCallback())) {
  using Result = decltype(work(ProgressCallback()));
  struct Shared {
    std::mutex mutex;
    std::condition_variable news;
    std::optional<Result> result;
    std::exception_ptr failure;
    std::optional<Progress> progress;  // not reported yet
    bool done = false;
    std::atomic<bool> stopped = false;
  };
  const auto shared = std::make_shared<Shared>();
  const auto ended = std::make_shared<std::atomic<bool>>(false);
  Watch watch(on_progress);
  std::thread thread([shared, ended, work = std::optional<Work>(std::move(work))]() mutable {
    try {
      Result result = (*work)([&shared](const Progress& progress) {
        const std::lock_guard lock(shared->mutex);
        shared->progress = progress;
        return !shared->stopped;
      });
      const std::lock_guard lock(shared->mutex);
      shared->result = std::move(result);
    } catch (...) {
      shared->failure = std::current_exception();
    }
    work.reset();
    const std::lock_guard lock(shared->mutex);
    shared->done = *ended = true;
    shared->news.notify_one();
  });
  {
    nb::gil_scoped_release released;
    std::unique_lock lock(shared->mutex);
    while (!shared->news.wait_for(lock, Watch::between_looks, [&] { return shared->done; })) {
      const std::optional<Progress> progress = std::exchange(shared->progress, std::nullopt);
      lock.unlock();
      {
        const nb::gil_scoped_acquire gil;
        if (!watch.go_on() || !watch.look(progress ? &*progress : nullptr)) shared->stopped = true;
      }
      lock.lock();
      if (watch.has_raised()) break;
    }
  }
  if (watch.has_raised()) {
    Abandoned::take(std::move(thread), ended);
    watch.rethrow();
  }
  thread.join();
  if (shared->failure) std::rethrow_exception(shared->failure);
  return std::move(*shared->result);
}

}  // namespace softkin::python
