#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/node_loads.hpp>

namespace softkin::physical {

/// A liquid at rest around the robot: on each piece of its outer surface a pressure along the present normal,
/// p = max(0, b . (x - x0)) at the present place x, with b the density times gravity and x0 a place of the level. It
/// grows with the load factor.
///
/// Its energy is the integral of p over the displaced volume, taken on the surface: of (p^2 / 2) b / b^2, whose
/// divergence is p. Forces are p n, face by face; they are the gradient of that energy where the surface is closed, or
/// open only along edges that cannot move. Else their derivative has a part that is not symmetric: a response.
///
/// A face that the level cuts is cut along it: exactly where it is flat, else after eight by eight pieces. As p is 0
/// there, the derivative of where it is cut is of no account.
class Hydrostatics : public NodeLoads {
 public:
  /// model  must outlive the object; of its tractions those are taken whose pressure grows with depth
  explicit Hydrostatics(const Model& model);

  [[nodiscard]] static bool acts(const Model& model);

  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;
  [[nodiscard]] bool conservative() const override { return closed_; }
  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Term::Scratch& scratch,
                  Points& force, Team& team) const override;

 private:
  struct Face {
    std::vector<Index> nodes;
    double fraction = 1;
    Vec3 deeper{0, 0, 0};  // b [MPa/mm]
    Vec3 level{0, 0, 0};   // x0 [mm]
  };
  /// A wet quadrature point of a face: shape functions of its nodes and their derivatives, the tangents of the surface,
  /// and its weight.
  struct Place {
    Eigen::Matrix<double, 6, 1> shape, along_u, along_v;
    Vec3 u = Vec3::Zero(), v = Vec3::Zero();  // [mm]
    double weight = 0;
    double pressure = 0;  // [MPa]
  };
  struct Depths;
  void find_rims();
  /// visit(place, its area vector [mm^2])
  template <class Visit>
  static void each_place(const Face& face, const Points& positions, const Visit& visit);
  [[nodiscard]] std::size_t parts() const override { return faces_.size(); }
  [[nodiscard]] const std::vector<Index>& nodes_of_part(std::size_t face) const override { return faces_[face].nodes; }
  [[nodiscard]] Blocks slopes(std::size_t face, const Points& positions) const override;

  const Model& model_;
  std::vector<Face> faces_;
  bool closed_ = true;
};

}  // namespace softkin::physical
