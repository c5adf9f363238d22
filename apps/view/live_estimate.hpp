#pragma once

#include <chrono>
#include <softkin/kinematics/estimator.hpp>
#include <softkin/runs/force_pictures.hpp>

#include "live_messages.hpp"

namespace softkin::view {

/// What is to be told, and what may be read.
struct EstimateSetup {
  std::vector<EstimatedUnknown> unknowns;
  std::vector<PoseColumn> columns;
  Eigen::VectorXd deviations;  // of the columns, in their units
  EstimatorOptions how;
};

/// The setup of what may be read of a robot: the columns of kinds whose deviation is given.
///
/// deviations  of each kind, in its unit; 0: not given
/// options     that give them, for messages
/// throws      InvalidInput where no deviation is given, or the robot has nothing of those kinds that could be read
[[nodiscard]] EstimateSetup estimate_setup(const Model& model, std::vector<EstimatedUnknown> unknowns,
                                           const std::array<double, readings>& deviations,
                                           const std::array<std::string, readings>& options, EstimatorOptions how);

/// Tells what readings say, each time from the last estimate. For one thread at a time. Its estimator has the columns
/// of the kinds that were read so far: those of others would keep it from what markers and sensors alone let it do.
class LiveEstimator {
 public:
  /// model must outlive the object. throws InvalidInput as Estimator does
  LiveEstimator(const Model& model, EstimateSetup setup);

  [[nodiscard]] const std::vector<PoseColumn>& columns() const { return setup_.columns; }
  [[nodiscard]] std::vector<Index> told_actuators() const { return estimator_.told_actuators(); }
  /// Must every reading have its time?
  [[nodiscard]] bool fades() const { return setup_.how.fade_s > 0; }
  /// What the page must know to ask for readings, JSON: "columns" with "name", "group", "axis", "unit" and "deviation",
  /// "told" actuators, "fade_s".
  [[nodiscard]] std::string page_text() const { return page_text_; }

  /// asker: where it is another than before, another clock and perhaps another scene, the last estimate is forgotten
  [[nodiscard]] const Estimate& tell(std::uint64_t asker, const ReadingsRequest& request,
                                     const ProgressCallback& progress);
  /// What was told last, as JSON for the page; numbers, places and forces only where it converged.
  [[nodiscard]] std::string told_text(const Estimate& told) const;

 private:
  using Clock = std::chrono::steady_clock;
  using Kinds = std::array<bool, readings>;

  [[nodiscard]] std::string text_for_page() const;
  /// Takes readings of all columns; the estimator is made anew where these are of a kind that it does not have.
  void have(const Eigen::VectorXd& values);

  const Model& model_;
  EstimateSetup setup_;
  Estimator estimator_;
  std::string page_text_;
  Kinds read_{}, has_{};             // by who asks now; of the estimator
  std::vector<PoseColumn> columns_;  // the same
  Eigen::VectorXd values_;           // of these, that were told from last
  runs::ForcePictures pictures_;
  std::uint64_t asker_ = 0;
  std::optional<double> last_s_{};  // time of what was told last
  Clock::time_point last_{};        // the same, of readings that tell none
};

/// One line to who streamed the readings: "t_s", what told_text() has but for what only pictures need, and
/// "passed_over", how many lines were not told since the one before.
[[nodiscard]] std::string stream_line(const std::string& told, const std::optional<double>& time_s,
                                      std::uint64_t passed_over);
/// What told_text() has where nothing could be told.
[[nodiscard]] std::string nothing_told_text(const std::string& why);

}  // namespace softkin::view
