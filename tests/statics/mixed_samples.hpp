#pragma once

#include "model/round_mesh.hpp"
#include "statics/physical_samples.hpp"

namespace softkin::testing {

/// Elements with pressures as unknowns, of a law and order.
inline RobotSpec mixed(RobotSpec spec, double nu = 0.5, bool quadratic = true, Law law = Law::neo_hookean) {
  spec.mesh_options.quadratic = quadratic;
  for (MaterialSpec& material : spec.materials) {
    material.elastic = elastic(law, material.elastic->youngs_modulus.value_or(1), nu);
    material.mixed = true;
  }
  return spec;
}

/// An eighth of a ball around a hollow, between its planes of symmetry: radii 7 and 10 mm, blown by a pressure [kPa].
/// A marker is on the inner side.
inline RobotSpec blown_ball(int cuts, int layers, double kilopascals, double nu, bool quadratic) {
  constexpr double inner = 7, outer = 10;
  Mesh mesh = layered(cut_on_ball({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}}, cuts), layers,
                      [&](const Vec3& p, double across) { return Vec3((inner + across * (outer - inner)) * p); });
  Region hollow;
  hollow.name = "hollow";
  hollow.dimension = 2;
  for (const Triangle& t : boundary_of(mesh.tetrahedra, {}).triangles)
    if (std::all_of(t.begin(), t.end(), [&](Index v) { return mesh.vertices.row(v).norm() < inner + 1e-9; })) {
      hollow.triangles.push_back(mesh.triangles.size());
      mesh.triangles.push_back(t);
    }
  mesh.regions.push_back(std::move(hollow));
  RobotSpec spec = mixed(physical_robot(std::move(mesh)), nu, quadratic);
  if (quadratic) {
    spec.mesh_options.curve.emplace().smooth = false;
    for (const double radius : {inner, outer})
      spec.mesh_options.curve->surfaces.push_back({Sphere{{0, 0, 0}, radius}, {}});
  }
  spec.fixed.clear();
  for (int axis = 0; axis < 3; ++axis) {
    FixedSpec& plane = spec.fixed.emplace_back(FixedSpec{{Halfspace{1e-9 * Vec3::Unit(axis), -Vec3::Unit(axis)}, {}}});
    plane.axes = {axis == 0, axis == 1, axis == 2};
  }
  spec.loads.tractions = {{"air", {std::string("hollow"), {}}, true, {0, 0, 0}, kilopascals}};
  spec.markers.push_back({"inside", {Vec3(inner, 0, 0), {}}});
  return spec;
}

/// Cook's membrane as a slab between two planes: 48 mm long, 44 mm high where it is held and 16 mm at its end, which is
/// sheared by a force of its own on every mm^2 [MPa]. E is 240.565 MPa.
inline RobotSpec cook_membrane(int cells, double shear_MPa, double nu, bool quadratic) {
  Mesh mesh = block_mesh({cells, cells, 1}, {48, 1, 48.0 / cells});
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double fraction = mesh.vertices(v, 0) / 48, low = 44 * fraction, high = 44 + 16 * fraction;
    mesh.vertices(v, 1) = low + mesh.vertices(v, 1) * (high - low);
  }
  RobotSpec spec = mixed(physical_robot(std::move(mesh)), nu, quadratic);
  spec.materials[0].elastic = elastic(Law::neo_hookean, 240.565, nu);
  for (const char* side : {"z_low", "z_high"}) spec.fixed.push_back({{std::string(side), {}}, {false, false, true}});
  spec.loads.tractions = {{"shear", {std::string("x_high"), {}}, false, {0, 1e3 * shear_MPa, 0}, 0}};
  spec.markers = {{"tip", {Vec3(48, 60, 24.0 / cells), {}}}};
  return spec;
}

}  // namespace softkin::testing
