#include <algorithm>
#include <cmath>
#include <softkin/kinematics/inverse_gradient.hpp>

namespace softkin::inverse {

namespace {

constexpr double tau = 0.1;           // by which a step shrinks
constexpr double least_step = 1e-12;  // of every share
constexpr double least_difference = 1e-5, most_difference = 1e-2;

class Descent {
 public:
  Descent(RobotResponse& response, double diagonal_mm, double accuracy_mm, Pose& pose)
      : response_(response), diagonal_mm_(diagonal_mm), accuracy_mm_(accuracy_mm), pose_(pose) {}

  /// One iteration of Algorithm 2, a line search by Eq. (15); false where it leads nowhere.
  bool iterate(std::string& remark) {
    remark = "the interruption";
    if (!differences()) {
      remark = "an equilibrium beside the pose was not found";
      return false;
    }
    double step = 1;
    Pose best;
    while (!improves(step, pose_, best)) {
      if (response_.interrupted()) return false;
      step *= tau;
      if (step * gradient_.cwiseAbs().maxCoeff() < least_step) {
        remark = "no step along the gradient reduces the error";
        return false;
      }
    }
    const double increment = step;
    for (Pose farther; improves(step + increment, best, farther); step += increment) std::swap(best, farther);
    pose_ = std::move(best);
    return !response_.interrupted();
  }

 private:
  static double objective(const Pose& pose) { return pose.terms.squaredNorm(); }

  /// Is the pose a step down the gradient better than another one?
  bool improves(double step, const Pose& than, Pose& trial) {
    const Eigen::VectorXd shares = (pose_.shares - step * gradient_).cwiseMax(0).cwiseMin(1);
    if (shares == than.shares) return false;
    return response_.go(shares, than, trial) == Response::Outcome::arrived && objective(trial) < objective(than);
  }

  /// The gradient of Eq. (14), by shares; false where an equilibrium is missing.
  bool differences() {
    const double reach = std::cbrt(6 * accuracy_mm_ * pose_.terms.norm() / (diagonal_mm_ * diagonal_mm_));
    const double difference = std::clamp(reach, least_difference, most_difference);
    gradient_.resize(pose_.shares.size());
    for (Index i = 0; i < gradient_.size(); ++i) {
      Eigen::VectorXd high = pose_.shares, low = pose_.shares;
      high[i] = std::min(1.0, high[i] + difference);
      low[i] = std::max(0.0, low[i] - difference);
      Pose above, below;
      if (response_.go(high, pose_, above) != Response::Outcome::arrived ||
          response_.go(low, pose_, below) != Response::Outcome::arrived)
        return false;
      gradient_[i] = (objective(above) - objective(below)) / (high[i] - low[i]);
    }
    return gradient_.allFinite();
  }

  RobotResponse& response_;
  double diagonal_mm_, accuracy_mm_;
  Pose& pose_;
  Eigen::VectorXd gradient_;
};

}  // namespace

bool descend(RobotResponse& response, double diagonal_mm, double accuracy_mm, int max_iterations, Pose& pose,
             int& iterations, std::string& remark) {
  Descent descent(response, diagonal_mm, accuracy_mm, pose);
  for (iterations = 0; pose.miss > 1 && iterations < max_iterations; ++iterations)
    if (!descent.iterate(remark)) return false;
  if (pose.miss > 1) remark = "the limit of iterations was reached";
  return pose.miss <= 1;
}

}  // namespace softkin::inverse
