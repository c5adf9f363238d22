#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>
#include <string>

namespace softkin::bench {

/// The finger that every benchmark bends: a bellows of 120 x 25 x 25 mm along x, held at x = 0, with seven folds of
/// plane walls in its sides and top, a chamber inside, solid ends and a flat floor of 2 mm towards which it bends.
///
/// cell_mm  about the edge of a cell in the wall [mm], 0.3 <= cell_mm <= 10; every cell is five tetrahedra
/// returns  lengths in mm, elements positive and conforming, mirror image of itself in y = 0. Regions: volumes "body"
///          and "chamber", surfaces "fixed" (x = 0), "tip" (x = 120) and "cavity_wall", vertex "tip_marker" in the
///          middle of the tip's lower edge
/// throws   InvalidInput on a size outside its range
[[nodiscard]] Mesh bellows_finger(double cell_mm);

/// Returns the cell size whose finger has the number of body tetrahedra nearest to the requested one.
///
/// throws  InvalidInput where no size in its range gives half to twice as many
[[nodiscard]] double cell_for(double body_tetrahedra);

/// Body tetrahedra of bellows_finger(cell_mm).
[[nodiscard]] std::int64_t body_tetrahedra(double cell_mm);

enum class FingerKind { target_shape, physical, physical_quadratic };

/// The finger of a mesh with the regions named above (cavity_wall is not needed; tip_marker may be missing: then the
/// middle of the tip's lower edge) as a robot. Actuator 0 is its chamber's volume ratio; marker 0 is the tip.
///
/// kind     target_shape: R_omega = 1, chamber elements of weight 5, the paper's; physical: St. Venant-Kirchhoff,
///          E = 12 MPa, nu = 0.4, the volume as a constraint, tetrahedra of order 1 or 2
/// origin   of the mesh, for messages
/// throws   InvalidInput where a region is missing
[[nodiscard]] RobotSpec finger_robot(Mesh mesh, FingerKind kind, const std::string& origin);

/// Vertices of the region "tip", ascending. throws InvalidInput where it is missing
[[nodiscard]] std::vector<Index> tip_face(const Mesh& mesh, const std::string& origin);

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

/// Finds the converged shapes that are bent by given angles with Newton's method, along a path from rest.
///
/// angles   ascending [degrees], > 0
/// face     vertices of the tip face
/// returns  a shape within 0.05 degrees of each angle; fewer where the finger does not bend so far below the largest
///          ratio of its actuator, or where Newton's method does not converge
[[nodiscard]] std::vector<BentShape> find_bends(const Model& model, const Statics& statics,
                                                const std::vector<Index>& face, const std::vector<double>& angles,
                                                const StaticsOptions& options = {});

}  // namespace softkin::bench
