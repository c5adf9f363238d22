#pragma once

#include <softkin/core/dense.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/model/model.hpp>
#include <utility>

namespace softkin::maps {

/// Moves the vertices of a mapped shape by as little as possible, so that its markers and the lengths, areas and
/// volumes of its actuators are the map's outputs, which are more accurate than the shape. The vertices that carry a
/// stem move as a rigid body.
class OutputCorrection {
 public:
  /// model must outlive the object; of data the names of outputs are read.
  OutputCorrection(const Model& model, const MapData& data);

  /// values     outputs of the map
  /// positions  #V by 3 [mm], changed
  void move_to(const Eigen::VectorXd& values, Points& positions) const;

  /// The same of the derivatives by the inputs, to first order.
  ///
  /// slopes     inputs by outputs
  /// positions  the shape, #V by 3 [mm]
  /// moves      its derivative by each input, #V by 3, changed
  void move_at(const RowMatrix& slopes, const Points& positions, std::vector<Points>& moves) const;

 private:
  /// Moves of some vertices.
  using Field = std::vector<std::pair<Index, Vec3>>;
  /// A length, area or volume that is an output.
  struct Ratio {
    Index actuator = -1, output = -1;
  };
  struct Linearised;

  [[nodiscard]] Index count() const;
  void add_rotations(const Points& positions, std::vector<Field>& fields) const;
  [[nodiscard]] Linearised linearised(const Points& positions) const;
  [[nodiscard]] Eigen::VectorXd missing(const Eigen::VectorXd& values, const Points& positions) const;

  const Model& model_;
  std::vector<Ratio> ratios_;
  std::vector<Field> marker_fields_;  // for each coordinate of each marker a field that moves it
};

}  // namespace softkin::maps
