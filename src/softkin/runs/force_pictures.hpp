#pragma once

#include <softkin/kinematics/estimator.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin::runs {

/// Of half axes of an ellipse over standard deviations: it holds what is normally distributed with a probability of
/// 90 %. Of one number: the same of an interval. source: quantiles of chi-square for 2 and 1 freedoms
constexpr double ellipse_90 = 2.14596602628935, interval_90 = 1.64485362695147;

/// A force that was told, as it is drawn: an arrow at its place, a cone around it, and an ellipse at the place.
struct ForcePicture {
  std::string name;
  Vec3 at{0, 0, 0};      // where it acts, in the shape that was told [mm]
  Vec3 force{0, 0, 0};   // [N]; what no command says of it, as components without a range, is not in it
  double deviation = 0;  // standard, of its size [N]
  // Half axes of what holds the arrow's tip with 90 %, across the arrow [N], the longer first: of an ellipse, or where
  // one component alone across it is told, of an interval, and the other is 0. Of a force of 0: its longest ones.
  std::array<Vec3, 2> across{Vec3::Zero(), Vec3::Zero()};
  // The same of its place in the surface of the shape that was told [mm]; none: the place is known.
  std::optional<std::array<Vec3, 2>> place{};
};

/// Pictures of what a model's estimates tell.
class ForcePictures {
 public:
  /// model must outlive the object
  explicit ForcePictures(const Model& model);

  /// Of each force one of whose components was told; from the covariance as if all were normally distributed.
  [[nodiscard]] std::vector<ForcePicture> of(const Estimate& told) const;

 private:
  [[nodiscard]] std::array<Vec3, 2> place_axes(const ToldPlace& place, const Points& positions) const;

  const Model& model_;
  std::vector<Triangle> triangles_;
  SurfaceTree surface_;
};

}  // namespace softkin::runs
