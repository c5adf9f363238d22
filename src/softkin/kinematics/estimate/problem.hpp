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

/// How readings change with the unknowns, near a guess.
struct Slopes {
  Eigen::MatrixXd of_readings;    // by columns of Variables
  std::vector<Points> moves{};    // of the vertices, per column
  Eigen::MatrixXd by_commands{};  // of readings, by commands of the robot; 0 by those that are told, held or moved
};

/// What is read at one time, and what was known before.
struct Readings {
  const Actuation& commands;  // of the robot
  const Eigen::VectorXd& values;
  const Eigen::VectorXd& weights;  // 1 / deviation^2; 0: not read, or left out
  const Knowledge& known;
};

/// Normal equations of the readings and of what was known before.
struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double cost = 0;
};

/// The readings of a robot as functions of unknowns.
class Problem {
 public:
  /// Of derivatives, relative: far below what readings tell.
  static constexpr double enough = 1e-6;

  Problem(const Model& model, const std::vector<EstimatedUnknown>& unknowns, std::vector<PoseColumn> columns,
          const StaticsOptions& options, double slope_accuracy = enough);

  [[nodiscard]] const Variables& variables() const { return variables_; }
  [[nodiscard]] const std::vector<PoseColumn>& columns() const { return columns_; }
  [[nodiscard]] const Statics& statics() const { return statics_; }

  /// near  a guess from whose equilibrium the search begins; null: from rest
  [[nodiscard]] Guess solve(const Actuation& commands, const Eigen::VectorXd& values, const std::vector<Place>& places,
                            const Guess* near, const ProgressCallback& progress) const;
  [[nodiscard]] Slopes slopes(const Guess& at) const;
  /// Of some changes of the commands: readings by changes.
  [[nodiscard]] Slopes slopes(const Guess& at, const std::vector<Actuation>& changes) const;

  [[nodiscard]] Normal normal(const Guess& at, const Eigen::MatrixXd& slopes, const Readings& read) const;
  [[nodiscard]] double cost(const Guess& at, const Readings& read) const;
  /// A step from a guess: numbers within their ranges, places along their surfaces.
  void move(const Guess& from, const Eigen::VectorXd& step, Eigen::VectorXd& values, std::vector<Place>& places) const;

  /// Equilibria that were solved.
  [[nodiscard]] int solves() const { return solves_; }

 private:
  [[nodiscard]] bool reads_supports() const;

  Variables variables_;
  std::vector<PoseColumn> columns_;
  StaticsOptions options_;
  double slope_accuracy_;
  Statics statics_;
  mutable int solves_ = 0;
};

}  // namespace softkin::estimate
