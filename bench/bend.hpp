#pragma once

#include <softkin/statics/statics.hpp>

namespace softkin::bench {

/// How far the tip face has turned about y [degrees], unwrapped from one shape to the next: they must be less than 180
/// degrees apart.
class Bend {
 public:
  /// rest: #V by 3; face: vertices of the tip face, at least three that are not in a line
  Bend(const Points& rest, std::vector<Index> face);

  /// Best-fit rotation of the face (Kabsch), as an angle; positive towards the floor.
  double follow(const Points& positions);
  [[nodiscard]] double degrees() const { return degrees_; }

 private:
  std::vector<Index> face_;
  Points rest_;  // of the face, centred
  double degrees_ = 0;
};

/// A shape of which the bend is known.
struct BentShape {
  State state;
  double ratio = 1;     // volume of the chamber over that at rest [-]
  double pressure = 0;  // multiplier of the chamber [kPa]; target-shape: 0
  double degrees = 0;
  Vec3 tip{0, 0, 0};  // marker 0 [mm]
};

/// The converged shapes that are bent by given angles, found with Newton's method along the way from rest.
///
/// angles   ascending [degrees], > 0
/// face     vertices of the tip face
/// returns  a shape within 0.05 degrees of each angle; fewer where the finger does not bend so far below the largest
///          ratio of its actuator, or where Newton's method does not converge
[[nodiscard]] std::vector<BentShape> find_bends(const Model& model, const Statics& statics,
                                                const std::vector<Index>& face, const std::vector<double>& angles,
                                                const StaticsOptions& options = {});

}  // namespace softkin::bench
