#pragma once

#include <memory>
#include <optional>
#include <softkin/model/measured_poses.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// What is to be told: a command that was not measured; a force or a wrench that the scene gives a range, of up to six
/// commands; where on its region a force acts; or how stiff a material is, over what the scene says.
struct EstimatedUnknown {
  std::string name;                           // of the command or of the force; materials.REGION.stiffness
  bool somewhere = false;                     // of a force on a region of faces: where on it is not known
  std::optional<double> mean{}, deviation{};  // known before; none: the value where no command says another, half of
                                              // the range
  std::string option{};                       // that asks for it, for messages
};

/// "NAME" or "NAME:place", then "" or "=MEAN+-DEVIATION".
///
/// throws  InvalidInput naming option and text
[[nodiscard]] EstimatedUnknown parse_unknown(const std::string& option, const std::string& text);

/// How an Estimator searches.
struct EstimatorOptions {
  StaticsOptions statics{};     // of each equilibrium
  int max_iterations = 40;      // >= 1
  double accuracy = 0.1;        // what it may leave to the least cost, over the deviation of what is told, > 0
  bool leave_out = true;        // readings that contradict the others
  double fade_s = 0;            // time in which what pushes may become anything else, so that readings go on from the
                                // last estimate as far as it still holds; 0: each time they tell by themselves
  std::size_t candidates = 80;  // places of a force that a search begins with, >= 1
  int starts = 2;               // of these that are followed, >= 1
};

/// A number that was told.
struct ToldNumber {
  std::string name;                            // of the command; materials.REGION.stiffness
  std::string unit;                            // "": over what the scene says
  double value = 0, deviation = 0;             // its most probable value, and its standard deviation
  double known_mean = 0, known_deviation = 0;  // before
  int at_bound = 0;                            // -1: low, 1: high end of its range
  Index actuator = -1;                         // of the model; -1: it is no command
};

/// Where a force was told to act.
struct ToldPlace {
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

/// What readings tell: the most probable numbers and places, how well they are known, and the robot's shape.
struct Estimate {
  Status status = Status::not_converged;  // of the search
  std::string remark{};                   // why it is not converged
  std::vector<ToldNumber> numbers{};      // in the order of the unknowns
  std::vector<ToldPlace> places{};        // of the forces whose place was unknown
  Eigen::MatrixXd covariance{};           // of the numbers, then two tangents of each place
  Eigen::MatrixXd near_covariance{};      // the same to first order near what is told, of shapes and readings
  Eigen::VectorXd computed{};             // readings
  Eigen::VectorXd deviations{};           // of the computed ones, as the estimate leaves them
  double chi_square = 0;                  // of the readings that were used
  double freedoms = 0;                    // which it is to be compared with: readings less what they had to tell
  std::vector<std::size_t> left_out{};    // groups
  State state{};                          // of the model; multipliers included
  Actuation actuation{};                  // with what was told
  std::vector<Points> moves{};            // of the vertices by each column of the covariance [mm per unit]
  int iterations = 0, equilibria = 0;     // that the search took
  double seconds = 0;                     // that it took [s]

  /// By how many standard deviations the chi-square is too large; negative: it is small.
  ///
  /// source  Wilson, Hilferty 1931
  [[nodiscard]] double misfit() const;
  /// Standard deviation of a vertex' place [mm], along each axis.
  [[nodiscard]] Vec3 vertex_deviation(Index vertex) const;
};

/// Tells what pushes a robot, and its shape, from a few readings: the unknowns of the largest posterior, by Gauss' and
/// Newton's method through equilibria, from its last estimate. For one thread at a time.
///
/// minimises  sum over readings of ((computed - read) / deviation)^2 + sum over unknowns of
///            ((value - mean) / deviation)^2; a place is known before by the mean and covariance of its region
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

  /// What readings tell, from the last estimate on; the first one, and where that is far off, after a search.
  ///
  /// commands  m values; those of unknowns are not read
  /// values    of the columns; NaN: not read
  /// elapsed_s since the last readings [s], >= 0; read where what was told fades
  /// throws    InvalidInput on sizes, values that are infinite, commands outside their ranges
  [[nodiscard]] const Estimate& update(const Actuation& commands, const Eigen::VectorXd& values, double elapsed_s = 0,
                                       const ProgressCallback& progress = {});
  /// The last estimate is forgotten.
  void forget();

  /// The readings by what they are of; Estimate::left_out has places among these.
  [[nodiscard]] const std::vector<ReadingGroup>& groups() const;
  /// Actuators of the model that are told, so that a table need not have them.
  [[nodiscard]] std::vector<Index> told_actuators() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Columns by what they are of: a marker's coordinates, a support's force, a direction; else each by itself.
[[nodiscard]] std::vector<ReadingGroup> reading_groups(const Model& model, const std::vector<PoseColumn>& columns);

/// What an estimate says, in words: what readings hardly tell, what they contradict.
[[nodiscard]] std::vector<std::string> estimate_words(const Estimate& estimate,
                                                      const std::vector<ReadingGroup>& groups);

}  // namespace softkin
