#pragma once

#include <softkin/kinematics/estimate/patch.hpp>
#include <softkin/kinematics/estimator.hpp>

namespace softkin::estimate {

/// A number that is told.
struct Variable {
  Index actuator = -1;             // whose command it is; -1: of none
  Index material = -1;             // whose stiffness it is, over that of the robot; -1: of none
  Index force = -1;                // index into Variables::forces where its place is not known; else -1
  double mean = 0, deviation = 0;  // before
  double low = 0, high = 0;
};

/// Of its command; "materials.REGION.stiffness".
[[nodiscard]] std::string name_of(const Model& model, const Variable& variable);
[[nodiscard]] ToldNumber told_number(const Model& model, const Variable& variable, double value, double deviation);

/// A force of unknown place.
struct FreeForce {
  std::string name;
  std::unique_ptr<Patch> patch;
  std::array<Index, 3> variables{-1, -1, -1};  // along each axis; -1: none
  Index first_command = -1;                    // of the nodes of the patch: three each, in Variables::model
};

/// The unknowns, and the robot with a command for each force on a node of a patch: a force anywhere on it is a few of
/// these.
class Variables {
 public:
  /// throws  InvalidInput as Estimator does
  Variables(const Model& model, const std::vector<EstimatedUnknown>& unknowns);

  [[nodiscard]] const Model& model() const { return *model_; }
  [[nodiscard]] const std::vector<Variable>& all() const { return variables_; }
  [[nodiscard]] const std::vector<FreeForce>& forces() const { return forces_; }
  [[nodiscard]] Index numbers() const { return variables_.size(); }
  /// Of the numbers, then two tangents of each place.
  [[nodiscard]] Index columns() const { return numbers() + 2 * std::ssize(forces_); }

  /// Of the extended robot. commands: of the robot
  [[nodiscard]] Actuation actuation(const Actuation& commands, const Eigen::VectorXd& values,
                                    const std::vector<Place>& places) const;
  /// What it is of near some places, `base`, to first order in the way from them: a sum of parts, which are the
  /// numbers, and of each component of a force of unknown place its products with both tangents' ways. So it is linear
  /// in the force wherever that acts.
  [[nodiscard]] Eigen::VectorXd parts(const Eigen::VectorXd& values, const std::vector<Place>& places,
                                      const std::vector<Place>& base) const;
  /// Derivatives of the parts by the columns.
  [[nodiscard]] Eigen::MatrixXd part_slopes(const Eigen::VectorXd& values, const std::vector<Place>& places,
                                            const std::vector<Place>& base) const;
  /// How it changes with each part.
  [[nodiscard]] std::vector<Actuation> part_changes(const std::vector<Place>& base) const;
  /// By a force at some place of a patch, along the axes that are told.
  [[nodiscard]] std::vector<Actuation> changes_at(std::size_t force, const Place& place) const;

  [[nodiscard]] Index own_actuators() const { return own_actuators_; }
  /// Commands that are told.
  [[nodiscard]] std::vector<Index> told_actuators() const;
  /// Is the stiffness of a material a number?
  [[nodiscard]] bool stiffens() const;
  /// The robot with these numbers: whatever makes a material resist a change of shape is so many times as stiff.
  [[nodiscard]] Model stiffened(const Eigen::VectorXd& values) const;

  /// Commands of the robot that are measured and can change a shape smoothly: neither told nor held nor moved.
  [[nodiscard]] std::vector<Index> measured() const;

  [[nodiscard]] Eigen::VectorXd means() const;
  [[nodiscard]] Eigen::VectorXd clamped(Eigen::VectorXd values) const;

 private:
  void add(const EstimatedUnknown& unknown);
  void add_variable(const EstimatedUnknown& unknown, Index actuator, Index force);
  void add_stiffness(const EstimatedUnknown& unknown, const std::string& region);
  void add_patch(const EstimatedUnknown& unknown, const std::vector<Index>& commands);
  void add_node_commands(FreeForce& force);

  std::unique_ptr<Model> model_;
  Index own_actuators_;
  std::vector<Variable> variables_;
  std::vector<FreeForce> forces_;
};

}  // namespace softkin::estimate
