#include <exception>
#include <mutex>
#include <softkin/core/team.hpp>
#include <softkin/core/together.hpp>

namespace softkin {

void work_together(int threads, std::atomic<bool>& stopped, const std::function<bool()>& step) {
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&] {
    try {
      while (!stopped && step()) {
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      stopped = true;
    }
  };
  std::vector<std::thread> others = start_threads(threads - 1, work, [&] { stopped = true; });
  work();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace softkin
