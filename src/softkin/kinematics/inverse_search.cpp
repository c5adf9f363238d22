#include <algorithm>
#include <cmath>
#include <softkin/kinematics/inverse_search.hpp>
#include <softkin/kinematics/inverse_step.hpp>
#include <utility>

namespace softkin::inverse {

namespace {

constexpr double first_radius = 0.5, min_radius = 1e-8;
constexpr double max_of_radius = 0.9;  // of a radius: a longer step is limited by it
constexpr int max_level = 5;
constexpr double enough = 1e-4, good = 0.75, poor = 0.25;  // actual reduction over that predicted
/// Slopes are updated instead of computed where the norm of the terms has fallen below this fraction.
constexpr double quick = 0.1;
constexpr double min_sideways = 0.1;  // of the preferred tolerance
/// A step whose predicted errors are below the fraction `meets` of the present ones meets the goals; the step after it
/// must be shorter by the factor `shrinks`.
constexpr double meets = 0.01, shrinks = 0.5;
constexpr double relative_slope = 1e-5;  // of the norm of the slopes: below it the pose is stationary

class Search {
 public:
  Search(Response& response, const Pose& start, const SearchSettings& settings)
      : response_(response), settings_(settings) {
    result_.pose = start;
    const Eigen::Index free = start.fractions.size();
    secant_.setZero(free, free);
    limits_.resolution_mm = settings.resolution_mm;
    limits_.radius = first_radius;
  }

  SearchResult run() {
    if (!renew()) return std::move(result_);
    if (pose().miss <= 1) compare();
    while (!finished()) {
      if (!response_.any_left()) {
        finish(SearchEnd::none_left);
      } else {
        advance();
      }
    }
    return std::move(result_);
  }

 private:
  Pose& pose() { return result_.pose; }
  [[nodiscard]] const Eigen::MatrixXd& curvature() const { return use_secant_ ? secant_ : none_; }

  /// Ends with the slopes of the pose itself.
  void finish(SearchEnd end) {
    if (pose().miss > 1 && best_.fractions.size() > 0) return_to_best();
    result_.end = fresh_ || renew() ? end : SearchEnd::stuck;
    finished_ = true;
  }

  bool renew() {
    fresh_ = response_.slopes(pose(), result_.slopes);
    none_.setZero(pose().fractions.size(), pose().fractions.size());
    if (fresh_) result_.slope = projected_slope(pose(), result_.slopes);
    return fresh_;
  }

  /// Finds the next step; true where none is needed. Updated slopes are sufficient for a step, not for termination.
  bool finished() {
    for (int look = 0; !finished_ && look < 2; ++look) {
      step_ = find_step(pose(), result_.slopes, curvature(), settings_.preferred, limits_);
      if (!(pose().miss <= 1 ? near_enough() : nothing_helps())) return false;
      if (fresh_) {
        finish(pose().miss <= 1 ? SearchEnd::reached : SearchEnd::stationary);
      } else {
        look_again();
      }
    }
    return finished_;
  }

  bool near_enough() const { return step_.sideways <= settings_.preferred_tolerance; }

  /// The direction of the error is known as well as the pose is.
  bool nothing_helps() {
    const double slope = fresh_ ? result_.slope : projected_slope(pose(), result_.slopes);
    const double known = settings_.accuracy_mm / pose().terms.norm();
    return slope <= std::max(relative_slope, known) * result_.slopes.terms.norm();
  }

  /// Extends a step that is to meet the goals: where the extrapolated errors after it are small, it is corrected for
  /// them.
  void look_ahead() {
    constexpr double little = 0.3;  // of the errors, and of the step
    if (!fresh_ || pose().miss <= 1 || !(step_.predicted_norm < meets * pose().terms.norm())) return;
    Pose ahead = pose();
    ahead.fractions += step_.move;
    if (!response_.extrapolate(ahead.fractions, pose(), ahead.terms)) return;
    if (!(ahead.terms.norm() < little * pose().terms.norm())) return;
    const InverseStep rest = find_step(ahead, result_.slopes, none_, ahead.fractions, limits_);
    if (rest.move.norm() < little * step_.move.norm()) step_.move += rest.move;
  }

  void advance() {
    ++result_.iterations;
    look_ahead();
    Pose trial;
    const auto outcome = response_.go(pose().fractions + step_.move, pose(), trial);
    if (outcome == Response::Outcome::interrupted) return end_at_once(SearchEnd::interrupted);
    if (outcome == Response::Outcome::failed) return shorten();
    const Eigen::VectorXd move = trial.fractions - pose().fractions;
    if (!(move.norm() > 0)) return shorten();
    if (pose().miss <= 1) return take(std::move(trial), move);
    const double predicted = predicted_reduction(pose(), result_.slopes, curvature(), move);
    const double actual = 0.5 * (pose().terms.squaredNorm() - trial.terms.squaredNorm());
    choose_model(move, actual);
    if (!(actual > 0) || !(actual >= enough * predicted)) {
      if (leads_on(trial)) return take(std::move(trial), move);
      if (!fresh_) return look_again();
      if (!unmeasurable()) return shorten();
      // the slopes still determine a step where the change of the error is below its accuracy
      if (level_++ < max_level && trial.terms.norm() <= pose().terms.norm() + settings_.accuracy_mm)
        return take(std::move(trial), move);
      return finish(SearchEnd::stationary);
    }
    const double length = move.cwiseAbs().maxCoeff();
    if (outcome == Response::Outcome::halfway || actual < poor * predicted) {
      limits_.radius = std::max(0.5 * length, 10 * min_radius);
    } else if (actual > good * predicted && length > max_of_radius * limits_.radius) {
      limits_.radius = std::min(1.0, 2 * limits_.radius);
    }
    take(std::move(trial), move);
  }

  /// Is the predicted reduction of the whole step below the accuracy of poses?
  [[nodiscard]] bool unmeasurable() const {
    return step_.predicted < settings_.accuracy_mm * result_.pose.terms.norm() &&
           step_.move.cwiseAbs().maxCoeff() < max_of_radius * limits_.radius;
  }

  /// Where actuators move the goals unequally far, the path to them is a narrow bend: a step that was to meet them and
  /// increases the errors is accepted if the step after it is much shorter (Deuflhard 2011: natural monotonicity).
  bool leads_on(const Pose& trial) {
    const double length = step_.move.norm();
    if (!fresh_ || !(step_.predicted_norm < meets * pose().terms.norm()) || !(length < max_bend_ * shrinks))
      return false;
    const InverseStep next = find_step(trial, result_.slopes, none_, trial.fractions, limits_);
    if (!(next.move.norm() < shrinks * length)) return false;
    max_bend_ = length;
    return true;
  }

  void end_at_once(SearchEnd end) {
    result_.end = end;
    finished_ = true;
  }

  void look_again() {
    if (!renew()) end_at_once(SearchEnd::stuck);
  }

  void shorten() {
    limits_.radius = 0.25 * std::min(limits_.radius, step_.move.cwiseAbs().maxCoeff());
    if (limits_.radius < min_radius) finish(pose().miss <= 1 ? SearchEnd::reached : SearchEnd::stuck);
  }

  /// Chooses the model that predicted the reduction better: with or without the curvature of the terms.
  void choose_model(const Eigen::VectorXd& move, double actual) {
    const double plain = predicted_reduction(pose(), result_.slopes, none_, move);
    const double full = predicted_reduction(pose(), result_.slopes, secant_, move);
    use_secant_ = std::abs(full - actual) < std::abs(plain - actual);
  }

  /// Continues from the trial, with updated slopes where the errors fall fast, else with new ones.
  void take(Pose trial, const Eigen::VectorXd& move) {
    const bool update = trial.miss <= 1 || trial.terms.norm() < quick * pose().terms.norm();
    const Pose from = std::exchange(pose(), std::move(trial));
    const Eigen::MatrixXd before = result_.slopes.terms;
    if (update) {
      const Eigen::VectorXd lack = pose().terms - from.terms - before * move;
      result_.slopes.terms += lack * move.transpose() / move.squaredNorm();
      fresh_ = false;
    } else {
      const bool known = fresh_;
      if (!renew()) return end_at_once(SearchEnd::stuck);
      if (known) learn(before, from.terms, move);
    }
    if (pose().miss <= 1) compare();
  }

  /// Keeps, of the poses that reach the goals, the one nearest to the preferred actuation.
  void compare() {
    const double distance = distance_from(pose(), settings_.preferred);
    if (best_.fractions.size() == 0 || distance < best_distance_) {
      best_ = pose();
      best_slopes_ = result_.slopes;
      best_fresh_ = fresh_;
      best_distance_ = distance;
      return;
    }
    limits_.sideways = 0.25 * std::min(limits_.sideways, (pose().fractions - best_.fractions).cwiseAbs().maxCoeff());
    return_to_best();
    if (limits_.sideways < min_sideways * settings_.preferred_tolerance) finish(SearchEnd::reached);
  }

  void return_to_best() {
    pose() = best_;
    result_.slopes = best_slopes_;
    fresh_ = best_fresh_;
    if (fresh_) result_.slope = projected_slope(pose(), result_.slopes);
  }

  /// Updates the secant curvature of the terms, which is scaled down where their errors vanish.
  void learn(const Eigen::MatrixXd& before, const Eigen::VectorXd& terms_before, const Eigen::VectorXd& move) {
    const Eigen::MatrixXd& after = result_.slopes.terms;
    const Eigen::VectorXd bent = (after - before).transpose() * pose().terms;
    const Eigen::VectorXd turned = after.transpose() * pose().terms - before.transpose() * terms_before;
    const double along = turned.dot(move);
    if (!(std::abs(along) > 1e-12 * turned.norm() * move.norm())) return;
    const double had = move.dot(secant_ * move);
    if (had != 0) secant_ *= std::min(1.0, std::abs(move.dot(bent) / had));
    const Eigen::VectorXd lack = bent - secant_ * move;
    secant_ += (lack * turned.transpose() + turned * lack.transpose()) / along -
               lack.dot(move) / (along * along) * turned * turned.transpose();
  }

  Response& response_;
  const SearchSettings& settings_;
  SearchResult result_;
  StepLimits limits_;
  InverseStep step_;
  Eigen::MatrixXd secant_, none_;
  Pose best_;  // reaches the goals, nearest to the preferred actuation so far
  Slopes best_slopes_;
  double best_distance_ = 0;
  int level_ = 0;         // steps so far that gained less than can be measured
  double max_bend_ = 10;  // longest step that may increase the errors, norm of all fractions
  bool fresh_ = false, best_fresh_ = false, use_secant_ = false, finished_ = false;
};

constexpr double tau = 0.1;         // by which a step shrinks
constexpr double min_step = 1e-12;  // of every fraction
constexpr double min_difference = 1e-5, max_difference = 1e-2;

class Descent {
 public:
  Descent(RobotResponse& response, double diagonal_mm, double accuracy_mm, Pose& pose)
      : response_(response), diagonal_mm_(diagonal_mm), accuracy_mm_(accuracy_mm), pose_(pose) {}

  /// One iteration of Algorithm 2, a line search by Eq. (15); false where it fails.
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
      if (step * gradient_.cwiseAbs().maxCoeff() < min_step) {
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
    const Eigen::VectorXd fractions = (pose_.fractions - step * gradient_).cwiseMax(0).cwiseMin(1);
    if (fractions == than.fractions) return false;
    return response_.go(fractions, than, trial) == Response::Outcome::arrived && objective(trial) < objective(than);
  }

  /// Computes the gradient of Eq. (14), by fractions; false where an equilibrium is missing.
  bool differences() {
    const double reach = std::cbrt(6 * accuracy_mm_ * pose_.terms.norm() / (diagonal_mm_ * diagonal_mm_));
    const double difference = std::clamp(reach, min_difference, max_difference);
    gradient_.resize(pose_.fractions.size());
    for (Index i = 0; i < gradient_.size(); ++i) {
      Eigen::VectorXd high = pose_.fractions, low = pose_.fractions;
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

SearchResult search_inverse(Response& response, const Pose& start, const SearchSettings& settings) {
  return Search(response, start, settings).run();
}

bool descend(RobotResponse& response, double diagonal_mm, double accuracy_mm, int max_iterations, Pose& pose,
             int& iterations, std::string& remark) {
  Descent descent(response, diagonal_mm, accuracy_mm, pose);
  for (iterations = 0; pose.miss > 1 && iterations < max_iterations; ++iterations)
    if (!descent.iterate(remark)) return false;
  if (pose.miss > 1) remark = "the limit of iterations was reached";
  return pose.miss <= 1;
}

}  // namespace softkin::inverse
