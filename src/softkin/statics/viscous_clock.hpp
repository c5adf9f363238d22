#pragma once

#include <optional>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// The history of a viscous material along a path with times. Before its first time the robot has been at rest for
/// long, and reaches the first shape at once. Of other robots, and where there are no times, it changes nothing.
class ViscousClock {
 public:
  /// statics must outlive the object.
  explicit ViscousClock(const Statics& statics) : statics_(&statics) {}

  /// Does the time of a shape matter?
  [[nodiscard]] bool counts(const std::optional<double>& time_s) const { return time_s && statics_->viscous(); }

  /// Makes the options those of a solve for a shape at a time.
  void set(const std::optional<double>& time_s, StaticsOptions& options) const {
    if (!counts(time_s)) return;
    options.history = history_;
    options.elapsed_s = last_s_ ? *time_s - *last_s_ : 0;
  }

  /// Continues from an equilibrium at a time.
  ///
  /// returns  energy that the material lost since the last one [mJ]; none where it counts no time
  std::optional<double> pass(const std::optional<double>& time_s, const State& at) {
    if (!counts(time_s)) return std::nullopt;
    ViscousFlow flow = statics_->flow(at);
    history_ = std::move(flow.history);
    last_s_ = time_s;
    return flow.lost_mJ;
  }

  /// The same, of a shape that was solved for before: at is its actuation and positions alone.
  void recall(const std::optional<double>& time_s, State at) {
    if (!counts(time_s)) return;
    StaticsOptions options;
    set(time_s, options);
    at.history = options.history;
    at.elapsed_s = options.elapsed_s;
    (void)pass(time_s, at);
  }

 private:
  const Statics* statics_;
  std::shared_ptr<const ViscousHistory> history_{};
  std::optional<double> last_s_{};
};

}  // namespace softkin
