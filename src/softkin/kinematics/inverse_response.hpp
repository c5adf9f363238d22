#pragma once

#include <softkin/kinematics/goal.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/gap.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin::inverse {

/// The force of a force goal in an equilibrium; empty for other goals.
struct Exertion {
  Vec3 force = Vec3::Zero();  // [N]
  std::optional<Gap> gap;     // to the obstacle or body of the goal, where it has no contact
};

/// The derivative of an Exertion by the commands.
struct ExertionSlopes {
  Eigen::Matrix3Xd force;  // 3 by m [N per unit of command]
  Eigen::RowVectorXd gap;  // m, where there is one [mm per unit of command]
};

/// A robot at one actuation, as a search uses it: f actuators are free.
struct Pose {
  Eigen::VectorXd fractions;        // f: of each range, 0 at its low end, 1 at its high end
  Eigen::VectorXd terms;            // whose squares are summed [mm]
  double miss = 0;                  // largest error of a goal over the tolerance [-]; <= 1: reached
  Eigen::VectorXd tensions;         // of the cables, >= 0 [N]
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

/// The robot's response to actuations, for a search.
class Response {
 public:
  Response() = default;
  Response(const Response&) = delete;
  Response& operator=(const Response&) = delete;
  virtual ~Response() = default;

  /// arrived: `to` is the pose at the requested fractions, or one of the same shape. halfway: `to` is a pose on the
  /// path to it.
  enum class Outcome { arrived, halfway, failed, interrupted };
  virtual Outcome go(const Eigen::VectorXd& fractions, const Pose& from, Pose& to) = 0;

  /// Extrapolates the terms to second order, to fractions near a pose whose slopes were requested; go() from that pose
  /// to them or nearby is faster afterwards. Returns false where the extrapolation is not available.
  virtual bool extrapolate(const Eigen::VectorXd& fractions, const Pose& from, Eigen::VectorXd& terms) {
    (void)fractions, (void)from, (void)terms;
    return false;
  }

  /// Returns false where the pose has no regular slopes.
  virtual bool slopes(const Pose& at, Slopes& slopes) = 0;

  /// May go() be called once more?
  [[nodiscard]] virtual bool any_left() const = 0;
};

/// Returns the force of every goal in an equilibrium that solve() returned; empty where no goal is a force.
///
/// throws  InvalidInput where the statics have no forces, as a map replaces them
[[nodiscard]] std::vector<Exertion> exertions_of(const Statics& statics, const std::vector<Goal>& goals,
                                                 const State& at);

/// Returns the derivatives of a pose's exertions, of the same length, by the given sensitivity; a new sensitivity
/// replaces it where the reactions of supports have to be computed with it.
///
/// equation  of a part in contact: dF = -sum over its vertices of K_contact dx, with the change of friction by its
///           normal forces
[[nodiscard]] std::vector<ExertionSlopes> exertion_slopes(const Statics& statics, const std::vector<Goal>& goals,
                                                          const Pose& at, const StaticsOptions& options,
                                                          double accuracy, Sensitivity& sensitivity);

/// Are derivatives of reactions needed?
[[nodiscard]] bool any_on_support(const std::vector<Goal>& goals);

/// See goal_errors in goal.hpp. exertions: one per goal where a goal is a force.
[[nodiscard]] Eigen::VectorXd errors_of(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                        const std::vector<Exertion>& exertions);

/// Goals as terms whose squares are summed, Eq. (12): each coordinate's error times the root of its goal's weight [mm].
/// While the obstacle or body of a force goal has no contact, the remaining gap along the target force is added to the
/// missing force: there is no contact force yet whose derivative could guide the search.
///
/// The goals are checked already.
[[nodiscard]] Eigen::VectorXd goal_terms(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                         const std::vector<Exertion>& exertions = {});

/// Derivative of the terms by the commands, #terms by m [mm per unit of command].
[[nodiscard]] Eigen::MatrixXd goal_slopes(const Model& model, const std::vector<Goal>& goals, const Points& positions,
                                          const Sensitivity& sensitivity, const std::vector<Exertion>& exertions = {},
                                          const std::vector<ExertionSlopes>& slopes = {});

}  // namespace softkin::inverse
