#pragma once

#include <softkin/kinematics/estimate/patch.hpp>
#include <softkin/kinematics/estimator.hpp>

namespace softkin::estimate {

/// A number that is estimated.
struct Variable {
  Index actuator = -1;             // whose command it is; -1: of none
  Index material = -1;             // whose stiffness it is, over that of the robot; -1: of none
  Index force = -1;                // index into Variables::forces where its place is not known; else -1
  double mean = 0, deviation = 0;  // before
  double low = 0, high = 0;
};

/// Returns the name of its command, or "materials.REGION.stiffness".
[[nodiscard]] std::string name_of(const Model& model, const Variable& variable);
[[nodiscard]] EstimatedNumber reported_number(const Model& model, const Variable& variable, double value,
                                              double deviation);

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
  /// Returns the number of columns: the numbers, then two tangents of each place.
  [[nodiscard]] Index columns() const { return numbers() + 2 * std::ssize(forces_); }

  /// Returns the actuation of the extended robot. commands: of the robot
  [[nodiscard]] Actuation actuation(const Actuation& commands, const Eigen::VectorXd& values,
                                    const std::vector<Place>& places) const;
  /// Returns the parts in which the actuation near some places, `base`, is linear to first order in the displacement
  /// from them: the numbers, and for each component of a force of unknown place its products with the displacements
  /// along both tangents. So the actuation is linear in the force at any place.
  [[nodiscard]] Eigen::VectorXd parts(const Eigen::VectorXd& values, const std::vector<Place>& places,
                                      const std::vector<Place>& base) const;
  /// Derivatives of the parts by the columns.
  [[nodiscard]] Eigen::MatrixXd part_slopes(const Eigen::VectorXd& values, const std::vector<Place>& places,
                                            const std::vector<Place>& base) const;
  /// Returns the derivative of the actuation by each part.
  [[nodiscard]] std::vector<Actuation> part_changes(const std::vector<Place>& base) const;
  /// Returns the derivatives of the actuation by a force at a place of a patch, along the axes that are estimated.
  [[nodiscard]] std::vector<Actuation> changes_at(std::size_t force, const Place& place) const;

  [[nodiscard]] Index own_actuators() const { return own_actuators_; }
  /// Returns the commands that are estimated.
  [[nodiscard]] std::vector<Index> reported_actuators() const;
  /// Is the stiffness of a material a number?
  [[nodiscard]] bool stiffens() const;
  /// Returns the robot with these numbers: all stiffnesses of a material are multiplied by its number.
  [[nodiscard]] Model stiffened(const Eigen::VectorXd& values) const;

  /// Returns the measured commands on which a shape depends smoothly: all but those that are estimated and those that
  /// hold or move something.
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
