#pragma once

#include <atomic>
#include <mutex>
#include <softkin/core/progress.hpp>
#include <softkin/kinematics/map_build.hpp>

namespace softkin::maps {

/// Threads that solve the equilibria of a map's making, with its desk and its progress.
class Crew {
 public:
  /// desk: null: nothing is kept. All must outlive the object.
  Crew(int threads, MapDesk* desk, const MapCallback& progress) : threads_(threads), desk_(desk), progress_(progress) {}

  /// work(i) for every i below count, on any thread; what it counts up in `from` is told. False where something stopped
  /// it.
  bool each(Index count, const MapProgress& from, Index MapProgress::*counted, const std::function<bool(Index)>& work);
  [[nodiscard]] const MapProgress& told() const { return told_; }

  /// What the desk knows, else what `solve` makes, which the desk keeps then; nothing where that was stopped.
  ///
  /// key  of a piece, or of a round of checks
  [[nodiscard]] std::optional<Sample> found(Index key, Index number, const Eigen::VectorXd& commands,
                                            const std::function<std::optional<Sample>()>& solve);

  /// For the solver.
  [[nodiscard]] ProgressCallback patience();

 private:
  int threads_;
  MapDesk* desk_;
  const MapCallback& progress_;
  MapProgress told_;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
};

}  // namespace softkin::maps
