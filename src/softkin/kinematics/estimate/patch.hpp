#pragma once

#include <softkin/model/mesh/surface_tree.hpp>
#include <softkin/model/model.hpp>

namespace softkin::estimate {

/// A place on a patch: a face, and the second and third barycentric coordinate in it.
struct Place {
  Index face = 0;
  double u = 1.0 / 3, v = 1.0 / 3;
};

/// A part of the body's surface on which a force may act anywhere: faces with linear or quadratic nodes.
class Patch {
 public:
  /// faces  at least one
  Patch(const Model& model, std::vector<CavityFace> faces);

  /// Of all faces, ascending.
  [[nodiscard]] const std::vector<Index>& nodes() const { return nodes_; }

  /// The nodes that carry a force at a place, by their index in nodes(), each with its fraction of it. The force is
  /// distributed over a spot whose radius is 1.5 times the longest edge of the patch. The resultant force and moment
  /// are those of a force at the place, and shapes are smooth functions of the place, also across the edges of faces.
  ///
  /// source  moving least squares (Lancaster, Salkauskas 1981) of degree 1 in the tangent plane, weights
  ///         (1 - r^2 / R^2)^3
  struct Fractions {
    std::vector<Index> nodes;
    Eigen::VectorXd fractions;
    Eigen::MatrixXd slopes;                // nodes by 2: of fractions, along the tangents [1/mm at rest]
    Eigen::Matrix<double, 3, 2> tangents;  // orthonormal, at rest
  };
  [[nodiscard]] Fractions fractions(const Place& place) const;
  /// Orthonormal, in the flat face at rest.
  [[nodiscard]] Eigen::Matrix<double, 3, 2> tangents(const Place& place) const;

  /// Where it is in a shape, #V by 3 [mm].
  [[nodiscard]] Vec3 at(const Place& place, const Points& positions) const;
  /// The place whose flat face, through the corners at rest, is nearest to a point [mm].
  [[nodiscard]] Place nearest(const Vec3& at_rest) const;
  /// Returns at most `most` centroids of faces, spread over the patch: the first is the one nearest to the middle of
  /// the patch, each further one the farthest from those before it.
  [[nodiscard]] std::vector<Place> spread(std::size_t most) const;

  /// Moments of the area at rest: the mean place [mm], and the covariance of a place that may be anywhere [mm^2].
  [[nodiscard]] double area() const { return area_; }  // [mm^2]
  [[nodiscard]] const Vec3& middle() const { return middle_; }
  [[nodiscard]] const Mat3& covariance() const { return covariance_; }

 private:
  void measure();

  const Model& model_;
  std::vector<CavityFace> faces_;
  std::vector<Index> nodes_;
  std::vector<std::vector<Index>> of_face_;  // nodes of each face, by their place in nodes_
  SurfaceTree tree_;
  double radius_ = 0, area_ = 0;  // of a spot [mm], of all faces [mm^2]
  Vec3 middle_{0, 0, 0};
  Mat3 covariance_ = Mat3::Zero();
};

}  // namespace softkin::estimate
