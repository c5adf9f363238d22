#pragma once

#include <softkin/kinematics/estimate/fit.hpp>

namespace softkin::estimate {

/// Readings by a force at each of some places, at an equilibrium.
struct Survey {
  Actuation commands;
  Guess at;
  std::shared_ptr<const Nearby> own;
  Eigen::MatrixXd theirs;     // readings by the force's components at each place
  std::vector<Place> places;  // none: no place is unknown
  bool whole = false;         // are they many, as they cost nothing
};

/// Finds unknowns without a start: from what was known before, each force of unknown place begun where a linear fit
/// ranks best.
class Searcher {
 public:
  /// All must outlive the object.
  ///
  /// kept  the survey of an earlier search, which serves for a shape nearby
  Searcher(const Problem& problem, const EstimatorOptions& options, const ProgressCallback& progress,
           std::optional<Survey>& kept)
      : problem_(problem), options_(options), progress_(progress), fitter_(problem, options, progress), kept_(kept) {}

  [[nodiscard]] Fit search(const Readings& readings) const;
  /// A fit, from where another place of its force promises more, if one does: as the shape that was found tells what
  /// forces anywhere do to the readings. Of one force of unknown place, and readings of markers and sensors.
  [[nodiscard]] Fit relocated(Fit fit, const Readings& readings) const;
  /// The second moments of the unknowns about what a fit tells, by its columns, of all places where the force may be:
  /// each by its weight, with the force that fits best there and its covariance. No columns where that is not known,
  /// and where the linear covariance tells as much, as the place is told to less than surveys tell apart.
  ///
  /// source  a mixture of normal distributions over a grid, each conditional on the place (Tierney, Kadane 1986)
  [[nodiscard]] Eigen::MatrixXd spread(const Fit& fit, const Readings& readings) const;
  /// The least cost that a linear fit foretells of that search; infinite where it cannot begin.
  [[nodiscard]] double forecast(const Readings& readings) const;

 private:
  struct Ranked {
    double cost;
    Eigen::VectorXd values;
    Place place;
    double reach;            // what the force moves a marker, about [mm]
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
