#pragma once

#include <array>
#include <map>
#include <softkin/calibration/maxwell_element.hpp>
#include <softkin/model/measurements.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// Names of a law's constants, as scenes have them: c10; c10, c01; c10, c20, c30; shear_modulus, jm.
///
/// throws  InvalidInput on a law that is none of neo-hookean, mooney-rivlin, yeoh and gent
[[nodiscard]] std::vector<std::string> constant_names(Law law);

/// The law of these constants, in the order of their names.
[[nodiscard]] IncompressibleLaw law_of_constants(Law law, const std::vector<double>& values);

/// The imposed and the measured history of a run: stretch [-] and nominal stress [MPa], or stress and stretch.
[[nodiscard]] History imposed_in(const RelaxationRun& run);
[[nodiscard]] Eigen::VectorXd answer_in(const RelaxationRun& run);
/// Returns the computed response of a run. None where no stretch balances a stress, or a stretch exceeds the law's
/// limit.
[[nodiscard]] std::optional<Eigen::VectorXd> answer_of(const MaxwellElement& element, const RelaxationRun& run);

/// Constants of a law and branches by least squares in what answered. The unknowns are the constants that are not held,
/// jm as ln(jm - what I1 - 3 comes to in the runs), and of every branch its modulus and ln(relaxation time).
class RelaxationProblem {
 public:
  /// held    constants by name that are not fitted
  /// times   between which relaxation times stay [s]
  /// throws  InvalidInput on a name that is none of the law's, or where a held jm is below what the runs come to
  RelaxationProblem(std::vector<RelaxationRun> runs, Law law, const std::map<std::string, double>& held,
                    std::array<double, 2> times);

  [[nodiscard]] const std::vector<RelaxationRun>& runs() const { return runs_; }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// None: it is fitted.
  [[nodiscard]] const std::optional<double>& held(std::size_t constant) const { return held_[constant]; }
  [[nodiscard]] double max_excess() const { return max_excess_; }  // I1 - 3 [-]
  [[nodiscard]] Eigen::Index rows() const { return rows_; }

  /// Residuals are over these: deviations of stresses [MPa] and stretches [-], or what is in proportion to them.
  void set_scales(double stress_MPa, double stretch) { scales_ = {stress_MPa, stretch}; }
  [[nodiscard]] double scale(bool load_imposed) const { return scales_[load_imposed ? 1 : 0]; }

  [[nodiscard]] Eigen::VectorXd unknowns(const std::vector<double>& constants,
                                         const std::vector<ViscousBranch>& branches) const;
  [[nodiscard]] std::vector<double> constants(const Eigen::VectorXd& unknowns) const;
  [[nodiscard]] MaxwellElement element(const Eigen::VectorXd& unknowns) const;
  /// Before the unknowns of the branches.
  [[nodiscard]] Eigen::Index free_constants() const { return free_constants_; }
  /// Lowest and highest value of an unknown.
  [[nodiscard]] std::array<double, 2> bounds(Eigen::Index unknown) const;
  /// Of the constant, modulus or time by its unknown.
  [[nodiscard]] double slope(const Eigen::VectorXd& unknowns, Eigen::Index unknown) const;
  [[nodiscard]] bool is_modulus(Eigen::Index unknown) const;  // else a logarithm

  /// Do the stretches of the runs determine the constants that are not fixed?
  [[nodiscard]] bool tells_constants(const std::vector<double>& constants) const;

  /// Answers less what was measured, over the scales, run after run. None as of answer_of.
  [[nodiscard]] std::optional<Eigen::VectorXd> residuals(const Eigen::VectorXd& unknowns) const;
  /// Derivatives of the residuals, rows x unknowns: exact but for the integration's tolerance.
  [[nodiscard]] Eigen::MatrixXd slopes(const Eigen::VectorXd& unknowns) const;

  /// All runs as if their stretches were imposed, which makes the stress linear in all constants but jm and in the
  /// moduli: a column for each of those constants that is not held, and the stress that is left for columns; over the
  /// scale of stresses.
  struct Linear {
    Eigen::MatrixXd columns;
    Eigen::VectorXd right;
    Eigen::Index signless = 0;  // columns, the first, that may count negative: c20 and c30
    std::vector<std::size_t> constants;
  };
  [[nodiscard]] Linear linear(const std::vector<double>& constants) const;
  /// The column of a branch.
  [[nodiscard]] Eigen::VectorXd column(double time_s) const;

 private:
  using Part = Eigen::Ref<Eigen::MatrixXd>;
  void fill_stress_slopes(const RelaxationRun& run, const Eigen::VectorXd& unknowns, Part part) const;
  void fill_stretch_slopes(const RelaxationRun& run, const Eigen::VectorXd& unknowns, Part part) const;
  [[nodiscard]] Eigen::VectorXd law_slopes(const Eigen::VectorXd& unknowns, double stretch) const;
  [[nodiscard]] Eigen::VectorXd law_stress(const RelaxationRun& run, const std::vector<double>& constants) const;

  std::vector<RelaxationRun> runs_;
  Law law_;
  std::vector<std::string> names_;
  std::vector<std::optional<double>> held_;
  std::array<double, 2> times_;
  std::array<double, 2> scales_{1, 1};
  Eigen::Index rows_ = 0, free_constants_ = 0;
  double max_excess_ = 0;
};

/// Where a search for the least squares ended.
struct Minimum {
  Eigen::VectorXd unknowns;
  double squares = 0;          // of the residuals
  Eigen::VectorXd deviations;  // of the unknowns, if those of the residuals are 1; NaN: at a bound or not determined
};

/// Minimises by Levenberg-Marquardt within the bounds. None where the start has no response.
///
/// enough  a step that reduces the squares by no more than this fraction is the last
[[nodiscard]] std::optional<Minimum> minimise(const RelaxationProblem& problem, const Eigen::VectorXd& start,
                                              double enough = 1e-7);

}  // namespace softkin::calibration
