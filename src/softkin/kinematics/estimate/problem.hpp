#pragma once

#include <softkin/kinematics/estimate/knowledge.hpp>

namespace softkin::estimate {

/// Unknowns, and the equilibrium under them.
struct Guess {
  Eigen::VectorXd values;  // of Variables' numbers
  std::vector<Place> places;
  Equilibrium equilibrium;   // of the extended robot
  Eigen::VectorXd computed;  // readings; no rows: there is no equilibrium
  [[nodiscard]] bool solved() const { return computed.size() > 0; }
};

/// How readings and shapes change at an equilibrium.
struct Slopes {
  Eigen::MatrixXd of_readings;    // by columns
  std::vector<Points> moves{};    // of the vertices, per column
  Eigen::MatrixXd multipliers{};  // of the actuators of the extended robot, by columns [N or kPa per unit]
};

/// Readings and shapes near an equilibrium, as functions of the unknowns that are linear in Variables::parts.
struct Nearby {
  std::vector<Place> base;  // of the parts
  Slopes parts;
  Slopes commands;  // by those that are measured, Variables::measured()
};

/// The readings at one time, and the prior.
struct Readings {
  const Actuation& commands;  // of the robot
  const Eigen::VectorXd& values;
  const Eigen::VectorXd& weights;  // 1 / deviation^2; 0: not read, or left out
  const Knowledge& known;
};

/// Normal equations of the readings and the prior.
struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double cost = 0;
};

/// The readings of a robot as functions of unknowns.
class Problem {
 public:
  /// Relative accuracy of derivatives: its effect is far below the noise of readings.
  static constexpr double enough = 1e-2;

  Problem(const Model& model, const std::vector<EstimatedUnknown>& unknowns, std::vector<PoseColumn> columns,
          const StaticsOptions& options, double slope_accuracy = enough);

  [[nodiscard]] const Variables& variables() const { return variables_; }
  [[nodiscard]] const std::vector<PoseColumn>& columns() const { return columns_; }
  /// Returns the solver of the robot with these numbers; a few are stored.
  [[nodiscard]] const Statics& statics(const Eigen::VectorXd& values) const;

  /// near      a guess from whose equilibrium the search begins; null: from rest
  /// predicted  where the equilibrium is about, from `near`; null: along the tangent there
  [[nodiscard]] Guess solve(const Actuation& commands, const Eigen::VectorXd& values, const std::vector<Place>& places,
                            const Guess* near, const ProgressCallback& progress,
                            const State* predicted = nullptr) const;
  [[nodiscard]] Nearby nearby(const Guess& at) const;
  /// Returns the derivatives of readings by the given changes of the commands.
  [[nodiscard]] Slopes slopes(const Guess& at, const std::vector<Actuation>& changes) const;

  /// Are all readings of markers and sensors?
  [[nodiscard]] bool reciprocal() const;
  /// Readings by forces on the nodes of a patch, three columns for each node; no columns where some reading is neither
  /// of a marker nor of a sensor, or the stiffness is not symmetric.
  [[nodiscard]] Eigen::MatrixXd by_node_forces(const Guess& at, std::size_t force) const;

  [[nodiscard]] Normal normal(const Guess& at, const Eigen::MatrixXd& slopes, const Readings& read) const;
  [[nodiscard]] double cost(const Guess& at, const Readings& read) const;
  /// Adds the information of readings, linearised near a guess, to a memory.
  void remember(const Nearby& nearby, const Guess& at, const Readings& read, Memory& memory) const;
  /// A step from a guess: numbers within their ranges, places along their surfaces.
  void move(const Guess& from, const Eigen::VectorXd& step, Eigen::VectorXd& values, std::vector<Place>& places) const;

  /// Returns the difference of the unknowns of two guesses, in the columns at `from`.
  [[nodiscard]] Eigen::VectorXd path(const Guess& from, const Guess& to) const;
  /// Readings by the columns, and how the vertices move.
  [[nodiscard]] Eigen::MatrixXd slopes(const Nearby& nearby, const Guess& at) const;
  [[nodiscard]] std::vector<Points> moves(const Nearby& nearby, const Guess& at) const;
  /// Adds the predicted change from one guess to another and to other commands to the readings and the shape.
  ///
  /// commands  change of those of the robot; no rows: none
  /// state     null: not requested. Its actuation stays as it is
  void follow(const Nearby& nearby, const Guess& from, const Guess& to, const Actuation& commands,
              Eigen::VectorXd& computed, State* state) const;
  /// Returns the largest displacement of a vertex from one guess to the other [mm].
  [[nodiscard]] double largest_move(const Nearby& nearby, const Guess& from, const Guess& to) const;

  /// Returns the number of equilibria that were solved for.
  [[nodiscard]] int solves() const { return solves_; }
  /// Returns the number of equilibria that were not found.
  [[nodiscard]] int lost() const { return lost_; }

 private:
  [[nodiscard]] bool reads_supports() const;
  [[nodiscard]] Slopes slopes_of(const Guess& at, ParameterSensitivity found) const;
  void set_stiffness_slopes(const Guess& at, Slopes& parts) const;

  Variables variables_;
  std::vector<PoseColumn> columns_;
  StaticsOptions options_;
  double slope_accuracy_;
  Statics statics_;
  /// A robot whose materials have the requested stiffnesses.
  struct Stiffened {
    Eigen::VectorXd values;
    std::unique_ptr<const Model> model;
    std::unique_ptr<const Statics> statics;
  };
  mutable std::vector<Stiffened> stiffened_;  // the last one requested at the end
  mutable int solves_ = 0, lost_ = 0;
};

}  // namespace softkin::estimate
