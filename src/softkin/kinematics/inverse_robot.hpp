#pragma once

#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/inverse_response.hpp>

namespace softkin::inverse {

/// A robot's equilibria as a search asks for them: Eq. (11) as a function of the actuation.
///
/// A slack cable is taken for one that is as long as its path: the shape is the same, and from there it can be pulled.
class RobotResponse : public Response {
 public:
  /// All but the callback must outlive the object. free: actuators whose shares are searched.
  RobotResponse(const Statics& statics, const std::vector<Goal>& goals, const InverseOptions& options,
                std::vector<Index> free, const ProgressCallback& progress);

  /// The pose of an equilibrium. taut: slack cables are shortened to their paths.
  [[nodiscard]] Pose pose_of(Equilibrium equilibrium, bool taut) const;
  /// Of each goal of an equilibrium that is known [mm].
  [[nodiscard]] Eigen::VectorXd errors_at(const State& state) const;
  [[nodiscard]] const std::vector<Exertion>& exertions_at(const State& state) const;
  [[nodiscard]] Eigen::VectorXd shares_of(const Actuation& actuation) const;
  /// In the ranges, whatever rounding does.
  [[nodiscard]] Actuation actuation_of(const Eigen::VectorXd& shares, const Actuation& others) const;

  /// One more equilibrium; counts and records it. False where it did not converge; found is what was reached.
  bool solve(const Actuation& actuation, const State& from, Equilibrium& found);

  Outcome go(const Eigen::VectorXd& shares, const Pose& from, Pose& to) override;
  bool foresee(const Eigen::VectorXd& shares, const Pose& from, Eigen::VectorXd& terms) override;
  bool slopes(const Pose& at, Slopes& slopes) override;
  [[nodiscard]] bool any_left() const override { return static_cast<int>(history_.size()) < most_; }

  /// Of a pose that reaches its goals: lets go of cables that hardly pull and are preferred longer. True where the pose
  /// is another one then.
  bool release(Pose& pose, const Slopes& slopes, const Eigen::VectorXd& preferred, double resolution_mm);

  [[nodiscard]] bool interrupted() const { return interrupted_; }
  [[nodiscard]] const std::vector<InverseTrial>& history() const { return history_; }
  [[nodiscard]] const std::vector<Index>& free() const { return free_; }
  /// Every equilibrium is one on the way from this state: where cables rub each is told by its way.
  void come_from(State state) { origin_ = std::move(state); }
  /// Newton's poses treat slack cables as taut ones; Algorithm 2 knows no such thing.
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
  std::vector<Index> cables_;  // places in free_ of what only pulls
  const ProgressCallback& progress_;
  std::vector<InverseTrial> history_;
  std::optional<State> origin_;  // none: of the pose before
  struct Last {
    Points positions;
    std::vector<Exertion> exertions;
  };
  mutable Last last_;  // equilibrium whose forces were measured: each is asked for several times
  bool any_force_;
  double least_error_;  // [mm]
  int most_;
  bool interrupted_ = false, taut_ = true;
};

}  // namespace softkin::inverse
