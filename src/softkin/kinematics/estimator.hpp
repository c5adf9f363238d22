#pragma once

#include <memory>
#include <optional>
#include <softkin/model/measured_poses.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// An unknown that is to be estimated: a command that was not measured; a force or a wrench that has a range in the
/// scene, of up to six commands; the place on its region where a force acts; or the stiffness of a material relative to
/// that of the scene.
struct EstimatedUnknown {
  std::string name;                           // of the command or of the force; materials.REGION.stiffness
  bool somewhere = false;                     // of a force on a region of faces: where on it is not known
  std::optional<double> mean{}, deviation{};  // prior; none: the value without a command, and half of the range
  std::string option{};                       // that requests it, for messages
};

/// "NAME" or "NAME:place", then "" or "=MEAN+-DEVIATION".
///
/// throws  InvalidInput naming option and text
[[nodiscard]] EstimatedUnknown parse_unknown(const std::string& option, const std::string& text);

/// How an Estimator searches.
struct EstimatorOptions {
  StaticsOptions statics{};     // of each equilibrium
  int max_iterations = 40;      // >= 1
  double accuracy = 0.1;        // distance to the minimum, over the standard deviation of the estimate, > 0
  bool leave_out = true;        // readings that contradict the others
  double fade_s = 0;            // time constant with which the information of earlier readings fades [s]; 0: each
                                // estimate uses its own readings alone
  std::size_t candidates = 80;  // places of a force that a search begins with, >= 1
  int starts = 2;               // of these that are refined, >= 1
};

/// A number that was estimated.
struct EstimatedNumber {
  std::string name;                            // of the command; materials.REGION.stiffness
  std::string unit;                            // "": relative to the value of the scene
  double value = 0, deviation = 0;             // its most probable value, and its standard deviation
  double known_mean = 0, known_deviation = 0;  // before
  int at_bound = 0;                            // -1: low, 1: high end of its range
  Index actuator = -1;                         // of the model; -1: it is no command
};

/// The place where a force acts, as estimated.
struct EstimatedPlace {
  std::string force;                        // its name
  Vec3 at_rest{0, 0, 0}, present{0, 0, 0};  // [mm]
  Mat3 covariance = Mat3::Zero();           // of at_rest, in the surface [mm^2]
  Mat3 known_covariance = Mat3::Zero();     // before
};

/// Readings that belong together, as a marker's coordinates do.
struct ReadingGroup {
  std::string name;            // of the marker, the support or the sensor
  std::vector<Index> columns;  // of the readings, by their places
};

/// An estimate from readings: the most probable numbers and places, their covariance, and the robot's shape.
struct Estimate {
  Status status = Status::not_converged;   // of the search
  std::string remark{};                    // why it is not converged
  std::vector<EstimatedNumber> numbers{};  // in the order of the unknowns
  std::vector<EstimatedPlace> places{};    // of the forces whose place was unknown
  Eigen::MatrixXd covariance{};            // of the numbers, then two tangents of each place
  Eigen::MatrixXd near_covariance{};       // the same to first order near the estimate, for shapes and readings
  Eigen::VectorXd computed{};              // readings
  Eigen::VectorXd deviations{};            // of the computed ones, as the estimate leaves them
  double chi_square = 0;                   // of the readings that were used
  double freedoms = 0;                     // degrees of freedom: readings less the unknowns that they determine
  std::vector<std::size_t> left_out{};     // groups
  State state{};                           // of the model; multipliers included
  Actuation actuation{};                   // with the estimated commands
  std::vector<Points> moves{};             // of the vertices by each column of the covariance [mm per unit]
  int iterations = 0, equilibria = 0;      // that the search took
  double seconds = 0;                      // that it took [s]

  /// By how many standard deviations the chi-square is too large; negative: it is small.
  ///
  /// source  Wilson, Hilferty 1931
  [[nodiscard]] double misfit() const;
  /// Standard deviation of a vertex' place [mm], along each axis.
  [[nodiscard]] Vec3 vertex_deviation(Index vertex) const;
};

/// Estimates the forces on a robot, other unknowns and its shape from a few readings: the unknowns of maximum posterior
/// probability, by the Gauss-Newton method through equilibria, from its last estimate. For one thread at a time.
///
/// minimises  sum over readings of ((computed - read) / deviation)^2 + sum over unknowns of
///            ((value - mean) / deviation)^2; the prior of a place is the mean and covariance of its region
/// covariance of the normal equations at the end
class Estimator {
 public:
  /// model       must outlive the object; physical
  /// columns     the readings
  /// deviations  of each, > 0, in its unit
  /// throws      InvalidInput: target shapes, friction, unknowns that the robot does not have or that are given twice,
  ///             deviations that are not above 0
  Estimator(const Model& model, const std::vector<EstimatedUnknown>& unknowns, const std::vector<PoseColumn>& columns,
            Eigen::VectorXd deviations, EstimatorOptions options = {});
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  /// Estimates the unknowns from readings, starting at the last estimate; a search without a start precedes the first
  /// estimate and those far from the last one.
  ///
  /// commands  m values; those of unknowns are not read
  /// values    of the columns; NaN: not read
  /// elapsed_s since the last readings [s], >= 0; read where estimates fade
  /// throws    InvalidInput on sizes, values that are infinite, commands outside their ranges
  [[nodiscard]] const Estimate& update(const Actuation& commands, const Eigen::VectorXd& values, double elapsed_s = 0,
                                       const ProgressCallback& progress = {});
  /// The last estimate is forgotten.
  void forget();

  /// Returns the readings in groups; Estimate::left_out has indices into these.
  [[nodiscard]] const std::vector<ReadingGroup>& groups() const;
  /// Returns the actuators of the model that are estimated, so that a table need not have them.
  [[nodiscard]] std::vector<Index> reported_actuators() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Groups columns: a marker's coordinates, a support's force, a direction; else each by itself.
[[nodiscard]] std::vector<ReadingGroup> reading_groups(const Model& model, const std::vector<PoseColumn>& columns);

/// Returns remarks on an estimate: numbers that the readings hardly determine, and readings that contradict others.
[[nodiscard]] std::vector<std::string> estimate_words(const Estimate& estimate,
                                                      const std::vector<ReadingGroup>& groups);

}  // namespace softkin
