#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <softkin/kinematics/map_build.hpp>
#include <string>
#include <thread>

namespace softkin::view {

/// Builds a kinematic map on a thread of its own, of the lowest priority.
class BackgroundMap {
 public:
  /// A map of the whole shape, or why there is none.
  using Made = std::function<void(const MapData*, const std::string& why)>;

  /// made, at: called by the thread. The model must outlive the object.
  BackgroundMap(const Model& model, const MapOptions& options, MapCallback at, Made made);
  ~BackgroundMap();
  BackgroundMap(const BackgroundMap&) = delete;
  BackgroundMap& operator=(const BackgroundMap&) = delete;

  /// Ends it. false: the solver has not ended within so many seconds, and the object cannot be destroyed before it
  /// does.
  bool stop(double seconds);

 private:
  void work();

  const Model& model_;
  MapOptions options_;
  MapCallback at_;
  Made made_;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace softkin::view
