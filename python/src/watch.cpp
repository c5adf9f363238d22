#include "watch.hpp"

#include <algorithm>
#include <vector>

namespace softkin::python {

using Clock = std::chrono::steady_clock;

Watch::Watch(const ProgressFunction& on_progress)
    : report_(on_progress), next_((Clock::now() + between_looks).time_since_epoch().count()) {}

ProgressCallback Watch::callback() {
  return [this](const Progress& progress) {
    if (stopped_) return false;
    const auto now = Clock::now().time_since_epoch().count();
    auto next = next_.load();
    if (now < next || !next_.compare_exchange_strong(next, (Clock::now() + between_looks).time_since_epoch().count()))
      return true;
    const nb::gil_scoped_acquire gil;
    return look(&progress);
  };
}

bool Watch::look(const Progress* progress) {
  try {
    if (PyErr_CheckSignals() != 0) nb::raise_python_error();
    if (!report_ || progress == nullptr) return true;
    const nb::object answer =
        (*report_)(progress->iteration, progress->step_mm, progress->tolerance_mm, progress->fraction);
    if (answer.is(nb::bool_(false))) stopped_ = true;
  } catch (nb::python_error& error) {
    const std::lock_guard lock(mutex_);
    if (!raised_) raised_.emplace(std::move(error));
    stopped_ = true;
  }
  return !stopped_;
}

void Watch::rethrow() {
  if (!raised_) return;
  nb::python_error error = std::move(*raised_);
  raised_.reset();
  throw error;
}

void Watch::watch(const std::function<void()>& work, const std::function<void()>& tick) {
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr failure;
  {
    nb::gil_scoped_release released;
    std::thread thread([&] {
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      done = true;
      ended.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, between_looks, [&] { return done; })) {
      lock.unlock();
      {
        const nb::gil_scoped_acquire gil;
        try {
          if (look(nullptr) && tick) tick();
        } catch (nb::python_error& error) {
          if (!raised_) raised_.emplace(std::move(error));
          stopped_ = true;
        }
      }
      lock.lock();
    }
    lock.unlock();
    thread.join();
  }
  rethrow();
  if (failure) std::rethrow_exception(failure);
  if (tick) tick();
}

namespace {

struct Left {
  std::thread thread;
  std::shared_ptr<std::atomic<bool>> ended;
};
std::mutex left_mutex;
std::vector<Left> left;

}  // namespace

void Abandoned::take(std::thread thread, std::shared_ptr<std::atomic<bool>> ended) {
  const std::lock_guard lock(left_mutex);
  for (Left& each : left)
    if (*each.ended) each.thread.join();
  std::erase_if(left, [](const Left& each) { return !each.thread.joinable(); });
  left.push_back({std::move(thread), std::move(ended)});
}

void Abandoned::join() {
  const std::lock_guard lock(left_mutex);
  for (Left& each : left) each.thread.join();
  left.clear();
}

}  // namespace softkin::python
