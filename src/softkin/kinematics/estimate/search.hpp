#pragma once

#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

/// The derivatives of readings by a force at each of several places, at an equilibrium.
struct Survey {
  Actuation commands;
  Guess at;
  std::shared_ptr<const Nearby> own;
  Eigen::MatrixXd theirs;     // readings by the force's components at each place
  std::vector<Place> places;  // none: no place is unknown
  bool whole = false;         // does it contain many places, as they cost nothing
};

/// Finds unknowns without a start: it begins with the prior means, and with each force of unknown place at the place
/// that a linear fit ranks best.
class Searcher {
 public:
  /// All must outlive the object.
  ///
  /// kept  the survey of an earlier search, which is reused for a nearby shape
  Searcher(const Problem& problem, const EstimatorOptions& options, const ProgressCallback& progress,
           std::optional<Survey>& kept)
      : problem_(problem), options_(options), progress_(progress), fitter_(problem, options, progress), kept_(kept) {}

  [[nodiscard]] Fit search(const Readings& readings) const;
  /// Fits again from another place of the force where the derivatives at the found shape predict a lower cost there;
  /// returns the better fit. It applies to one force of unknown place, and to readings of markers and sensors.
  [[nodiscard]] Fit relocated(Fit fit, const Readings& readings) const;
  /// Returns the second moments of the unknowns about the estimate of a fit, by its columns, over all places where the
  /// force may be: each with its weight, the force that fits best there, and the covariance of that force. The matrix
  /// is empty where it is not available, and where the linear covariance is sufficient, as the place is estimated more
  /// precisely than the distance between the places of the survey.
  ///
  /// source  a mixture of normal distributions over a grid, each conditional on the place (Tierney, Kadane 1986)
  [[nodiscard]] Eigen::MatrixXd spread(const Fit& fit, const Readings& readings) const;
  /// Returns the minimum cost that a linear fit predicts for that search; infinite where it cannot begin.
  [[nodiscard]] double forecast(const Readings& readings) const;

 private:
  struct Ranked {
    double cost;
    Eigen::VectorXd values;
    Place place;
    double reach;            // predicted displacement of a marker by the force [mm]
    Eigen::MatrixXd matrix;  // of the normal equations of the numbers
  };
  [[nodiscard]] const Survey& first(const Readings& readings) const;
  [[nodiscard]] Survey survey(std::size_t force, const Guess& at, std::shared_ptr<const Nearby> own) const;
  [[nodiscard]] std::vector<Ranked> rank(std::size_t force, const Survey& survey, const Readings& readings) const;
  [[nodiscard]] std::vector<Ranked> best_apart(std::size_t force, std::vector<Ranked> ranked) const;
  [[nodiscard]] std::optional<Fit> best_of(std::size_t force, const Survey& survey, const Readings& readings) const;
  [[nodiscard]] Guess begun(const Guess& at, const Ranked& ranked, std::size_t force, const Readings& readings) const;

  const Problem& problem_;
  const EstimatorOptions& options_;
  const ProgressCallback& progress_;
  Fitter fitter_;
  std::optional<Survey>& kept_;
};

}  // namespace softkin::estimate
