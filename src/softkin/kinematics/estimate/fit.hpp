#pragma once

#include <softkin/kinematics/estimate/problem.hpp>

namespace softkin::estimate {

/// The unknowns that fit readings best, near where the search began.
struct Fit {
  Guess at;
  Slopes slopes{};  // of a guess so near that steps by them still converge
  Normal normal{};  // there
  bool converged = false;
  bool interrupted = false;
  int iterations = 0;
};

/// Finds the least cost, of readings under the same commands.
class Fitter {
 public:
  /// All must outlive the object.
  Fitter(const Problem& problem, const EstimatorOptions& options, const ProgressCallback& progress)
      : problem_(problem), options_(options), progress_(progress) {}

  /// By Gauss' and Newton's method, damped as Levenberg and Marquardt do.
  ///
  /// from    a guess that is solved, under these commands or, where slopes are known, under others nearby: `before`
  /// slopes  of a guess nearby: they are used as long as they are good enough; null: none are known
  /// before  null: these
  [[nodiscard]] Fit refine(Guess from, const Readings& readings, const Slopes* slopes,
                           const Actuation* before = nullptr) const;

  /// Without a start, under the same commands each time: from what was known before, each force of unknown place begun
  /// where a linear fit ranks best.
  [[nodiscard]] Fit search(const Readings& readings) const;
  /// The least cost that a linear fit foretells of that search; infinite where it cannot begin.
  [[nodiscard]] double forecast(const Readings& readings) const;

 private:
  /// Readings by a force at each of some places, at a guess.
  struct Survey {
    Guess at;
    Slopes own, theirs;
    std::vector<Place> places;
  };
  struct Ranked {
    double cost;
    Eigen::VectorXd values;
    Place place;
  };
  [[nodiscard]] Eigen::VectorXd step_of(const Guess& at, const Normal& normal, double damping) const;
  [[nodiscard]] Fit refine_by(Guess from, const Readings& readings, const Slopes* slopes, const Actuation* before,
                              int most_iterations) const;
  [[nodiscard]] const Survey& first(const Readings& readings) const;
  [[nodiscard]] Survey survey(std::size_t force, const Guess& at) const;
  [[nodiscard]] std::vector<Ranked> rank(std::size_t force, const Survey& survey, const Readings& readings) const;
  [[nodiscard]] std::optional<Fit> best_of(std::size_t force, const Survey& survey, const Readings& readings) const;
  [[nodiscard]] Guess begun(const Guess& at, const Ranked& ranked, std::size_t force, const Readings& readings) const;

  const Problem& problem_;
  const EstimatorOptions& options_;
  const ProgressCallback& progress_;
  mutable std::optional<Survey> first_;  // of the first search, as all begin there
};

}  // namespace softkin::estimate
