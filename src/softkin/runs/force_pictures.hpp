#pragma once

#include <softkin/kinematics/estimator.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin::runs {

/// Half axes of an ellipse over standard deviations: it contains a normally distributed point with a probability of
/// 90 %. The same of an interval and a number. source: quantiles of chi-square for 2 and 1 degrees of freedom
constexpr double ellipse_90 = 2.14596602628935, interval_90 = 1.64485362695147;

/// An estimated force as it is drawn: an arrow at its place, a cone around it, and an ellipse at the place.
struct ForcePicture {
  std::string name;
  Vec3 at{0, 0, 0};      // where it acts, in the estimated shape [mm]
  Vec3 force{0, 0, 0};   // [N]; without the components that no command has, such as those without a range
  double deviation = 0;  // standard, of its size [N]
  // Half axes of the region that contains the arrow's tip with 90 %, across the arrow [N], the longer first: of an
  // ellipse or, where a single component across it is estimated, of an interval, and the other is 0. Of a force of 0:
  // the longest.
  std::array<Vec3, 2> across{Vec3::Zero(), Vec3::Zero()};
  // The same of its place on the surface of the estimated shape [mm]; none: the place is given.
  std::optional<std::array<Vec3, 2>> place{};
};

/// Makes pictures of the forces in a model's estimates.
class ForcePictures {
 public:
  /// model must outlive the object
  explicit ForcePictures(const Model& model);

  /// Returns the pictures of all forces with an estimated component; from the covariance, as if all were normally
  /// distributed.
  [[nodiscard]] std::vector<ForcePicture> of(const Estimate& reported) const;

 private:
  [[nodiscard]] std::array<Vec3, 2> place_axes(const EstimatedPlace& place, const Points& positions) const;

  const Model& model_;
  std::vector<Triangle> triangles_;
  SurfaceTree surface_;
};

}  // namespace softkin::runs
