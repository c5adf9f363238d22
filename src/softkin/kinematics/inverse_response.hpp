#pragma once

#include <softkin/kinematics/goal.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/sensitivity.hpp>

namespace softkin::inverse {

/// A robot at one actuation, as a search sees it: f actuators are free.
struct Pose {
  Eigen::VectorXd shares;    // f: of each range, 0 at its low end, 1 at its high end
  Eigen::VectorXd terms;     // whose squares are summed [mm]
  double miss = 0;           // largest error of a goal over the tolerance [-]; <= 1: reached
  Eigen::VectorXd tensions;  // of what only pulls, >= 0 [N]
  Eigen::VectorXd idle;      // f: 1 where the actuator is a slack cable, commanded as long as its path, else 0
  Equilibrium equilibrium;
};

/// First-order change of a pose.
struct Slopes {
  Eigen::MatrixXd terms;     // #terms by f [mm per range]
  Eigen::MatrixXd tensions;  // #tensions by f [N per range]; of a slack cable, as it is pulled
  Sensitivity sensitivity;
};

/// What a search may ask.
class Response {
 public:
  Response() = default;
  Response(const Response&) = delete;
  Response& operator=(const Response&) = delete;
  virtual ~Response() = default;

  /// arrived: to is the pose at the shares asked for, or one of the same shape. halfway: to is a pose on the way there.
  enum class Outcome { arrived, halfway, failed, interrupted };
  virtual Outcome go(const Eigen::VectorXd& shares, const Pose& from, Pose& to) = 0;

  /// The terms at shares near a pose whose slopes were asked for, by second order; go() from there to them or near by
  /// is quicker then. False where that is not to be had.
  virtual bool foresee(const Eigen::VectorXd& shares, const Pose& from, Eigen::VectorXd& terms) {
    (void)shares, (void)from, (void)terms;
    return false;
  }

  /// False where the pose has no regular slopes.
  virtual bool slopes(const Pose& at, Slopes& slopes) = 0;

  /// May go() be called once more?
  [[nodiscard]] virtual bool any_left() const = 0;
};

/// Goals as terms whose squares are summed, Eq. (12): each coordinate's error times the root of its goal's weight [mm].
///
/// The goals are checked already.
[[nodiscard]] Eigen::VectorXd goal_terms(const Model& model, const std::vector<Goal>& goals, const Points& positions);

/// Derivative of the terms by the commands, #terms by m [mm per unit of command].
[[nodiscard]] Eigen::MatrixXd goal_slopes(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                          const Sensitivity& sensitivity);

}  // namespace softkin::inverse
