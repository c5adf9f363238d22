#pragma once

#include <memory>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimator.hpp>

namespace softkin::estimate {

struct Survey;

/// The damping that a step adds to the diagonal (Levenberg and Marquardt): it falls after a step that reduces the cost
/// and grows after one that does not.
class Damping {
 public:
  /// first  the smallest damping above zero
  explicit Damping(double first) : first_(first) {}

  [[nodiscard]] double value() const { return value_; }
  void relax() { value_ = value_ > first_ ? value_ / 16 : 0; }
  /// Returns false where the maximum is exceeded.
  bool tighten() { return (value_ = value_ == 0 ? first_ : 8 * value_) <= most; }

 private:
  static constexpr double most = 1e9;
  double first_, value_ = 0;
};

/// The unknowns that fit readings best, near where the search began.
struct Fit {
  Guess at;                                // the last equilibrium
  std::shared_ptr<const Nearby> nearby{};  // of a guess so near that steps by it still converge
  /// The minimum of the cost that `nearby` predicts, without an equilibrium; `at` where its error may exceed the
  /// accuracy.
  Guess estimated{};
  Eigen::MatrixXd slopes{};                // of readings, there
  Normal normal{};                         // the same
  std::shared_ptr<const Survey> around{};  // of all places, at a shape nearby; null: none was made
  bool converged = false;
  bool interrupted = false;
  bool anew = false;  // without the information of earlier readings
  int iterations = 0;
};

/// Finds the least cost near a guess.
class Fitter {
 public:
  /// All must outlive the object.
  Fitter(const Problem& problem, const EstimatorOptions& options, const ProgressCallback& progress)
      : problem_(problem), options_(options), progress_(progress), lost_before_(problem.lost()) {}

  /// How it begins.
  struct Start {
    std::shared_ptr<const Nearby> nearby{};  // of a guess nearby: it is used as long as it is good enough
    const Actuation* before = nullptr;       // commands of the guess, where these are others; nearby is known then
    int max_iterations = 0;
  };
  /// Each step leads to the minimum of the cost that `nearby` predicts, with the damping of Levenberg and Marquardt.
  /// The error after the last step is estimated from how the steps shrank.
  ///
  /// from  a guess that is solved
  [[nodiscard]] Fit refine_by(Guess from, const Readings& readings, const Start& start) const;
  [[nodiscard]] Fit refine(Guess from, const Readings& readings, std::shared_ptr<const Nearby> nearby,
                           const Actuation* before = nullptr) const;
  /// Returns the minimum of the predicted cost, without an equilibrium.
  [[nodiscard]] Fit predict(Guess from, const Readings& readings, std::shared_ptr<const Nearby> nearby,
                            const Actuation& before) const;
  /// Have so many solves failed that a fit ends at its first failure?
  [[nodiscard]] bool exhausted() const;

 private:
  [[nodiscard]] Eigen::VectorXd step_of(const Guess& at, const Normal& normal, double damping) const;
  [[nodiscard]] Guess least(const Fit& fit, const Readings& readings, double holding) const;
  [[nodiscard]] Guess stepped(const Fit& fit, const Readings& readings, const Actuation& elsewhere, double reach) const;
  void renew(Fit& fit) const;
  [[nodiscard]] Fit begin(Guess from, const Readings& readings, const Start& start, Actuation& elsewhere) const;
  void set_normal(Fit& fit, const Readings& readings) const;

  const Problem& problem_;
  const EstimatorOptions& options_;
  const ProgressCallback& progress_;
  int lost_before_;  // equilibria
};

}  // namespace softkin::estimate
