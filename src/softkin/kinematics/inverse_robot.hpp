#pragma once

#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/inverse_response.hpp>

namespace softkin::inverse {

/// A robot's equilibria for a search: Eq. (11) as a function of the actuation.
///
/// A slack cable is replaced by one that is as long as its path: the shape is the same, and from there it can be
/// tightened.
class RobotResponse : public Response {
 public:
  /// All but the callback must outlive the object. free: actuators whose fractions are searched.
  RobotResponse(const Statics& statics, const std::vector<Goal>& goals, const InverseOptions& options,
                std::vector<Index> free, const ProgressCallback& progress);

  /// The pose of an equilibrium. taut: slack cables are shortened to their paths.
  [[nodiscard]] Pose pose_of(Equilibrium equilibrium, bool taut) const;
  /// Returns the error of each goal in a known equilibrium [mm].
  [[nodiscard]] Eigen::VectorXd errors_at(const State& state) const;
  [[nodiscard]] const std::vector<Exertion>& exertions_at(const State& state) const;
  [[nodiscard]] Eigen::VectorXd fractions_of(const Actuation& actuation) const;
  /// Returns an actuation that is inside the ranges in spite of rounding.
  [[nodiscard]] Actuation actuation_of(const Eigen::VectorXd& fractions, const Actuation& others) const;

  /// Solves for one more equilibrium, counts and records it. Returns false where it did not converge; found is the last
  /// shape.
  bool solve(const Actuation& actuation, const State& from, Equilibrium& found);

  Outcome go(const Eigen::VectorXd& fractions, const Pose& from, Pose& to) override;
  bool extrapolate(const Eigen::VectorXd& fractions, const Pose& from, Eigen::VectorXd& terms) override;
  bool slopes(const Pose& at, Slopes& slopes) override;
  [[nodiscard]] bool any_left() const override { return static_cast<int>(history_.size()) < max_; }

  /// Slackens cables of a pose that reaches its goals, where their tension is small and their preferred length longer.
  /// Returns true where the pose has changed.
  bool release(Pose& pose, const Slopes& slopes, const Eigen::VectorXd& preferred, double resolution_mm);

  [[nodiscard]] bool interrupted() const { return interrupted_; }
  [[nodiscard]] const std::vector<InverseTrial>& history() const { return history_; }
  [[nodiscard]] const std::vector<Index>& free() const { return free_; }
  /// Sets the state from which every equilibrium is solved for: with cable friction an equilibrium depends on its path.
  void come_from(State state) { origin_ = std::move(state); }
  /// Keeps slack cables slack, as in Algorithm 2; newton treats them as taut ones.
  void keep_slack() { taut_ = false; }

 private:
  [[nodiscard]] bool pulls(Index actuator) const;
  void tauten(Pose& pose) const;
  [[nodiscard]] double width(Index actuator) const;

  const Model& model_;
  const Statics& statics_;
  const std::vector<Goal>& goals_;
  const InverseOptions& options_;
  std::vector<Index> free_;
  std::vector<Index> cables_;  // indices into free_ of cables
  const ProgressCallback& progress_;
  std::vector<InverseTrial> history_;
  std::optional<State> origin_;  // none: of the pose before
  struct Last {
    Points positions;
    std::vector<Exertion> exertions;
  };
  mutable Last last_;  // equilibrium whose forces were computed: each is needed several times
  bool any_force_;
  double min_error_;  // [mm]
  int max_;
  bool interrupted_ = false, taut_ = true;
};

}  // namespace softkin::inverse
