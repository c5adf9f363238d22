#pragma once

#include <chrono>
#include <softkin/kinematics/estimator.hpp>
#include <softkin/runs/force_pictures.hpp>

#include "live_messages.hpp"

namespace softkin::view {

/// The unknowns to estimate, and the columns that may be read.
struct EstimateSetup {
  std::vector<EstimatedUnknown> unknowns;
  std::vector<PoseColumn> columns;
  Eigen::VectorXd deviations;  // of the columns, in their units
  EstimatorOptions how;
};

/// Returns the setup for a robot: its columns of the kinds of reading whose deviation is given.
///
/// deviations  of each kind, in its unit; 0: not given
/// options     that give them, for messages
/// throws      InvalidInput where no deviation is given, or the robot has nothing of those kinds that could be read
[[nodiscard]] EstimateSetup estimate_setup(const Model& model, std::vector<EstimatedUnknown> unknowns,
                                           const std::array<double, readings>& deviations,
                                           const std::array<std::string, readings>& options, EstimatorOptions how);

/// Estimates unknowns from readings, each time starting from the last estimate. For one thread at a time. Its estimator
/// has the columns of the kinds that were read so far only: other columns would rule out the faster methods that apply
/// to markers and sensors alone.
class LiveEstimator {
 public:
  /// model must outlive the object. throws InvalidInput as Estimator does
  LiveEstimator(const Model& model, EstimateSetup setup);

  [[nodiscard]] const std::vector<PoseColumn>& columns() const { return setup_.columns; }
  [[nodiscard]] std::vector<Index> reported_actuators() const { return estimator_.reported_actuators(); }
  /// Must every reading have its time?
  [[nodiscard]] bool fades() const { return setup_.how.fade_s > 0; }
  /// Returns what the page needs in order to send readings, as JSON: "columns" with "name", "group", "axis", "unit" and
  /// "deviation", "told" (the estimated actuators), "fade_s".
  [[nodiscard]] std::string page_text() const { return page_text_; }

  /// asker: where it differs from the last one (another clock, perhaps another scene), the last estimate is discarded
  [[nodiscard]] const Estimate& send(std::uint64_t asker, const ReadingsRequest& request,
                                     const ProgressCallback& progress);
  /// Returns an estimate as JSON for the page; numbers, places and forces only where it converged.
  [[nodiscard]] std::string reported_text(const Estimate& reported) const;

 private:
  using Clock = std::chrono::steady_clock;
  using Kinds = std::array<bool, readings>;

  [[nodiscard]] std::string text_for_page() const;
  /// Takes readings of all columns; rebuilds the estimator where it lacks a kind that was read.
  void have(const Eigen::VectorXd& values);

  const Model& model_;
  EstimateSetup setup_;
  Estimator estimator_;
  std::string page_text_;
  Kinds read_{}, has_{};             // kinds that the asker has read; those of the estimator
  std::vector<PoseColumn> columns_;  // of the estimator
  Eigen::VectorXd values_;           // of these, in the last readings
  runs::ForcePictures pictures_;
  std::uint64_t asker_ = 0;
  std::optional<double> last_s_{};  // time of the last readings
  Clock::time_point last_{};        // the same, of readings without a time
};

/// Returns one line for the writer of the readings: "t_s", the entries of reported_text() except those for pictures
/// alone, and "passed_over", the number of lines without an estimate since the one before.
[[nodiscard]] std::string stream_line(const std::string& reported, const std::optional<double>& time_s,
                                      std::uint64_t passed_over);
/// Returns the counterpart of reported_text() where no estimate is possible.
[[nodiscard]] std::string nothing_reported_text(const std::string& why);

}  // namespace softkin::view
