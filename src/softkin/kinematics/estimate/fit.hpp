#pragma once

#include <memory>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimator.hpp>

namespace softkin::estimate {

struct Survey;

/// What a step adds to the diagonal (Levenberg and Marquardt): less after one that helps, more after one that does not.
class Damping {
 public:
  /// first  the least above none
  explicit Damping(double first) : first_(first) {}

  [[nodiscard]] double value() const { return value_; }
  void relax() { value_ = value_ > first_ ? value_ / 16 : 0; }
  /// False where more leads nowhere.
  bool tighten() { return (value_ = value_ == 0 ? first_ : 8 * value_) <= most; }

 private:
  static constexpr double most = 1e9;
  double first_, value_ = 0;
};

/// The unknowns that fit readings best, near where the search began.
struct Fit {
  Guess at;                                // the last equilibrium
  std::shared_ptr<const Nearby> nearby{};  // of a guess so near that steps by it still converge
  /// The least cost as `nearby` has it, without an equilibrium; where that may be off by more than the accuracy, `at`.
  Guess told{};
  Eigen::MatrixXd slopes{};                // of readings, there
  Normal normal{};                         // the same
  std::shared_ptr<const Survey> around{};  // of all places, at a shape nearby; null: none was made
  bool converged = false;
  bool interrupted = false;
  bool anew = false;  // without what earlier readings tell
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
    int most_iterations = 0;
  };
  /// Each step leads to the least cost of `nearby`; damped as Levenberg and Marquardt do. What the last step leaves is
  /// foretold by how the steps shrank.
  ///
  /// from  a guess that is solved
  [[nodiscard]] Fit refine_by(Guess from, const Readings& readings, const Start& start) const;
  [[nodiscard]] Fit refine(Guess from, const Readings& readings, std::shared_ptr<const Nearby> nearby,
                           const Actuation* before = nullptr) const;
  /// The least cost as it is foretold, without an equilibrium.
  [[nodiscard]] Fit foretell(Guess from, const Readings& readings, std::shared_ptr<const Nearby> nearby,
                             const Actuation& before) const;
  /// Were so many equilibria not found that fits end at the first that is not?
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
