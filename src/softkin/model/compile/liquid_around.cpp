#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/boundary.hpp>

namespace softkin {

namespace {

using Sorted = std::array<Index, 3>;

Sorted sorted_corners(Triangle corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Faces of the body's surface that no liquid reaches: walls of chambers and of empty spaces.
class DryFaces {
 public:
  explicit DryFaces(Compilation& c) {
    for (const Actuator& actuator : c.model.actuators)
      if (const auto* chamber = actuator.as<ChamberDrive>())
        for (const CavityFace& face : chamber->cavity) dry_.insert(sorted_corners(face.corners));
    for (const EmptySpace& space : empty_spaces(c))
      for (const Triangle& triangle : space.triangles) dry_.insert(sorted_corners(triangle));
    for (const Tetrahedron& t : c.chamber_tetrahedra)
      for (const auto& face : tetrahedron_faces) dry_.insert(sorted_corners({t[face[0]], t[face[1]], t[face[2]]}));
  }

  [[nodiscard]] bool has(const Triangle& corners) const { return dry_.count(sorted_corners(corners)) > 0; }
  /// Of which one half may be there, cut along either diagonal.
  [[nodiscard]] bool has(const Quad& q) const {
    for (std::size_t i = 0; i < 4; ++i)
      if (has(Triangle{q[i], q[(i + 1) % 4], q[(i + 2) % 4]})) return true;
    return false;
  }

 private:
  std::set<Sorted> dry_;
};

void check_liquid(const LiquidAroundSpec& spec, const Vec3& gravity) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(spec.origin, "the liquid around the robot " + why);
  };
  if (!(spec.density > 0 && std::isfinite(spec.density)))
    refuse("needs a density above 0 kg/m^3, not " + number(spec.density));
  if (!spec.surface.allFinite()) refuse("has a surface that is not finite");
  if (gravity.isZero(0)) refuse("needs gravity: without it there is no pressure in it");
}

/// A chamber that no faces of the mesh close stands open to the liquid.
void check_chambers(const Compilation& c) {
  for (const Actuator& actuator : c.model.actuators)
    if (const auto* chamber = actuator.as<ChamberDrive>(); chamber && !chamber->surface.empty())
      throw InvalidInput(c.spec.loads.liquid_around->origin,
                         "the liquid around the robot would be in the chamber of actuator '" + actuator.name +
                             "', whose surface bounds no empty space of the mesh: close it in the mesh");
}

}  // namespace

void compile_liquid_around(Compilation& c) {
  if (!c.spec.loads.liquid_around) return;
  const LiquidAroundSpec& spec = *c.spec.loads.liquid_around;
  check_liquid(spec, c.spec.loads.gravity);
  check_chambers(c);
  const Boundary boundary = boundary_of(c.model.elements.tetrahedra, c.model.elements.prisms);
  const DryFaces dry(c);
  FollowingTraction liquid;
  constexpr double cubic_metres_per_mm3 = 1e-9;
  liquid.deeper_MPa_mm = spec.density * cubic_metres_per_mm3 * c.spec.loads.gravity;
  liquid.level_mm = spec.surface;
  for (const Triangle& t : boundary.triangles)
    if (!dry.has(t)) liquid.faces.push_back(loaded_face(c, t, 1));
  for (const Quad& q : boundary.quads)
    if (!dry.has(q))
      for (int i = 0; i < 4; ++i) liquid.faces.push_back(loaded_face(c, {q[i], q[(i + 1) % 4], q[(i + 2) % 4]}, 0.5));
  c.model.notes.push_back("A liquid of " + number(spec.density) +
                          " kg/m^3 presses on the outer surface; walls of chambers and of empty spaces are dry.");
  c.model.loads.tractions.push_back(std::move(liquid));
}

}  // namespace softkin
