#pragma once

#include <atomic>
#include <mutex>
#include <softkin/core/progress.hpp>
#include <softkin/kinematics/map_build.hpp>

namespace softkin::maps {

/// The threads that solve the equilibria of a map, with its desk and its progress.
class Crew {
 public:
  /// desk: null: nothing is kept. All must outlive the object.
  Crew(int threads, MapDesk* desk, const MapCallback& progress) : threads_(threads), desk_(desk), progress_(progress) {}

  /// Calls work(i) for every i below count, on any thread, and reports progress, `from` with `counted` incremented.
  /// Returns false where it was stopped.
  bool each(Index count, const MapProgress& from, Index MapProgress::*counted, const std::function<bool(Index)>& work);
  [[nodiscard]] const MapProgress& reported() const { return reported_; }

  /// Returns the sample that the desk has stored, else the one that `solve` returns, which the desk then stores;
  /// nothing where the solve was stopped.
  ///
  /// key  of a piece, or of a round of checks
  [[nodiscard]] std::optional<Sample> found(Index key, Index number, const Eigen::VectorXd& commands,
                                            const std::function<std::optional<Sample>()>& solve);

  /// Returns the progress callback for the solver.
  [[nodiscard]] ProgressCallback patience();

 private:
  int threads_;
  MapDesk* desk_;
  const MapCallback& progress_;
  MapProgress reported_;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
};

}  // namespace softkin::maps
