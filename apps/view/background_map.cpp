#include "background_map.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <utility>

namespace softkin::view {

BackgroundMap::BackgroundMap(const Model& model, const MapOptions& options, MapCallback at, Made made)
    : model_(model), options_(options), at_(std::move(at)), made_(std::move(made)), thread_([this] { work(); }) {}

BackgroundMap::~BackgroundMap() {
  stopped_ = true;
  thread_.join();
}

bool BackgroundMap::stop(double seconds) {
  stopped_ = true;
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return ended_; });
}

void BackgroundMap::work() {
  constexpr int least = 19;
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), least);  // of this thread alone
  try {
    const auto result = build_map(model_, options_, nullptr,
                                  [this](const MapProgress& progress) { return !stopped_ && at_(progress); });
    if (result && result->accurate)
      made_(&result->data, "");
    else if (result)
      made_(nullptr, result->remark);
  } catch (const std::exception& error) {
    made_(nullptr, error.what());
  }
  const std::lock_guard lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

}  // namespace softkin::view
