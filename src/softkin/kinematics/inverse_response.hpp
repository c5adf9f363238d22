#pragma once

#include <softkin/kinematics/goal.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/gap.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin::inverse {

/// What a force goal finds in an equilibrium; of other goals nothing.
struct Exertion {
  Vec3 force = Vec3::Zero();  // [N]
  std::optional<Gap> gap;     // to what is to be pressed and nothing touches
};

/// How it changes with the commands.
struct ExertionSlopes {
  Eigen::Matrix3Xd force;  // 3 by m [N per unit of command]
  Eigen::RowVectorXd gap;  // m, where there is one [mm per unit of command]
};

/// A robot at one actuation, as a search sees it: f actuators are free.
struct Pose {
  Eigen::VectorXd shares;           // f: of each range, 0 at its low end, 1 at its high end
  Eigen::VectorXd terms;            // whose squares are summed [mm]
  double miss = 0;                  // largest error of a goal over the tolerance [-]; <= 1: reached
  Eigen::VectorXd tensions;         // of what only pulls, >= 0 [N]
  std::vector<Exertion> exertions;  // per goal where a force is among them; else empty
  Eigen::VectorXd idle;             // f: 1 where the actuator is a slack cable, commanded as long as its path, else 0
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

/// Of every goal of an equilibrium that solve() returned; empty where no force is among them.
///
/// throws  InvalidInput where the statics know no forces: they are answered by a map
[[nodiscard]] std::vector<Exertion> exertions_of(const Statics& statics, const std::vector<Goal>& goals,
                                                 const State& at);

/// The derivatives of a pose's, of the same length, and the sensitivity with which they go: the one that is given, but
/// where the supports' reactions have to be asked for with it.
///
/// equation  of what is touched: dF = -sum over its vertices of K_contact dx, with what friction's normal forces change
[[nodiscard]] std::vector<ExertionSlopes> exertion_slopes(const Statics& statics, const std::vector<Goal>& goals,
                                                          const Pose& at, const StaticsOptions& options,
                                                          double accuracy, Sensitivity& sensitivity);

/// Are derivatives of reactions needed?
[[nodiscard]] bool any_on_support(const std::vector<Goal>& goals);

/// See goal_errors in goal.hpp. exertions: as long as the goals where a force is among them.
[[nodiscard]] Eigen::VectorXd errors_of(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                        const std::vector<Exertion>& exertions);

/// Goals as terms whose squares are summed, Eq. (12): each coordinate's error times the root of its goal's weight [mm].
/// While nothing touches what is to be pressed towards the way to it, what is left of that way counts with the missing
/// force, along which it leads: there is no force yet that could tell where to go.
///
/// The goals are checked already.
[[nodiscard]] Eigen::VectorXd goal_terms(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                         const std::vector<Exertion>& exertions = {});

/// Derivative of the terms by the commands, #terms by m [mm per unit of command].
[[nodiscard]] Eigen::MatrixXd goal_slopes(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                          const Sensitivity& sensitivity, const std::vector<Exertion>& exertions = {},
                                          const std::vector<ExertionSlopes>& slopes = {});

}  // namespace softkin::inverse
