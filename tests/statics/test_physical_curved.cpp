#include <cmath>
#include <numbers>

#include "model/turned_body.hpp"
#include "statics/physical_samples.hpp"

/// Round bodies of few elements with straight and with curved edges, against beams and Lame's solutions.

namespace softkin {

namespace {

using namespace testing;

constexpr double round_pi = std::numbers::pi;
constexpr double round_modulus = 1;

/// Linear in the load: small loads, St Venant and Kirchhoff's law.
RobotSpec round_robot(Mesh mesh, double poisson_ratio, bool curved) {
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.fixed.clear();
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(Law::st_venant_kirchhoff, round_modulus, poisson_ratio);
  if (curved) spec.mesh_options.curve.emplace().smooth = true;
  return spec;
}

Model compiled_round(const RobotSpec& spec) {
  const Model model = compile(spec);
  const bool warns = std::any_of(model.warnings.begin(), model.warnings.end(), [](const std::string& warning) {
    return warning.find("The edges are straight") != std::string::npos;
  });
  EXPECT_EQ(warns, !spec.mesh_options.curve) << "of straight edges alone there is a warning";
  return model;
}

/// Deflection of a cantilever of 100 mm length and 5 mm radius under a force at its end, over that of Timoshenko's
/// beam, P L^3 / (3 E I) + P L / (0.9 G A); nu = 0.
double bent_rod(int corners, int layers, bool curved) {
  constexpr double length = 100, radius = 5, force = 1e-5;
  RobotSpec spec = round_robot(rod_mesh(corners, 1, layers, radius, length), 0, curved);
  spec.fixed.push_back({{Halfspace{{1e-6, 0, 0}, {-1, 0, 0}}, {}}});
  Region end;
  end.name = "end";
  end.dimension = 2;
  for (const Triangle& t : boundary_of(spec.mesh.tetrahedra, {}).triangles)
    if (std::all_of(t.begin(), t.end(), [&](Index v) { return spec.mesh.vertices(v, 0) == length; })) {
      end.triangles.push_back(spec.mesh.triangles.size());
      spec.mesh.triangles.push_back(t);
    }
  spec.mesh.regions.push_back(end);
  spec.loads.forces.push_back({"load", {std::string("end"), {}}, {0, 0, -force}});
  spec.markers.push_back({"tip", {std::string("end"), {}}});
  const Model model = compiled_round(spec);
  const Statics statics(model);
  const double area = round_pi * radius * radius, inertia = area * radius * radius / 4;
  const double expected =
      force * std::pow(length, 3) / (3 * round_modulus * inertia) + force * length / (0.9 * round_modulus / 2 * area);
  return -marker_at(model, solve_converged(statics, {}, tight(1e-11)))[2] / expected;
}

constexpr double blown_MPa = 1e-5, inner_mm = 7, outer_mm = 10, round_nu = 0.3;

ActuatorSpec round_air() {
  ActuatorSpec air = actuator("air", PneumaticSpec{}, 0, 1, true);
  air.control = Control::load;
  air.rest = 0;
  return air;
}

void hold_vertex(RobotSpec& spec, Index vertex, const std::array<bool, 3>& axes) {
  spec.fixed.push_back({{VertexList{{vertex}}, {}}, axes});
}

/// Returns by how much more a chamber grows than in Lame's solution [mm^3].
double growth_over(const RobotSpec& spec, double expected) {
  const Model model = compiled_round(spec);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, values({1e3 * blown_MPa}), tight(1e-11));
  const Actuator& chamber = model.actuators[0];
  return (achieved_ratio(model, chamber, found.state.positions) - 1) * chamber.rest_measure / expected;
}

/// A tube in plane strain around a chamber of elements; nothing but rigid motions is held.
double blown_tube(int corners, bool curved) {
  constexpr double length = 8;
  Mesh mesh = rod_mesh(corners, 2, 2, outer_mm, length);
  mesh.regions.assign(2, {});
  mesh.regions[0].name = "wall";
  mesh.regions[1].name = "chamber";
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Tetrahedron& all = mesh.tetrahedra[t];
    const bool inside = std::all_of(all.begin(), all.end(),
                                    [&](Index v) { return mesh.vertices.row(v).tail<2>().norm() < 0.6 * outer_mm; });
    mesh.regions[inside ? 1 : 0].tetrahedra.push_back(t);
  }
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices.row(v).tail<2>().norm() < 0.6 * outer_mm)
      mesh.vertices.row(v).tail<2>() *= 2 * inner_mm / outer_mm;
  RobotSpec spec = round_robot(std::move(mesh), round_nu, curved);
  spec.actuators = {round_air()};
  spec.actuators[0].as<PneumaticSpec>()->region = "chamber";
  spec.fixed.push_back({{std::string("wall"), {}}, {true, false, false}});
  hold_vertex(spec, 1, {false, true, true});
  hold_vertex(spec, 1 + corners / 2, {false, false, true});
  const double ratio2 = outer_mm * outer_mm / (inner_mm * inner_mm);
  const double widened =
      (1 + round_nu) * blown_MPa * inner_mm / round_modulus / (ratio2 - 1) * (1 - 2 * round_nu + ratio2);
  return growth_over(spec, 2 * round_pi * inner_mm * length * widened);
}

/// A ball around a hollow, its only empty space.
double blown_ball(int cuts, int layers, bool curved) {
  RobotSpec spec = round_robot(shell_mesh(cuts, layers, inner_mm, outer_mm), round_nu, curved);
  spec.actuators = {round_air()};
  hold_vertex(spec, 0, {true, true, true});
  hold_vertex(spec, 1, {false, true, true});
  hold_vertex(spec, 2, {false, false, true});
  const double ratio3 = std::pow(outer_mm / inner_mm, 3);
  const double widened =
      blown_MPa * inner_mm / round_modulus / (ratio3 - 1) * (1 - 2 * round_nu + (1 + round_nu) * ratio3 / 2);
  return growth_over(spec, 4 * round_pi * inner_mm * inner_mm * widened);
}

/// How far the top of a half ball on a smooth floor sinks under its weight [mm]: it bends at its rim, which is free to
/// widen.
double sinking_dome(int sides, int cuts, int layers, bool curved) {
  Mesh mesh = layered(dome_surface(sides, cuts), layers, [](const Vec3& p, double across) {
    return Vec3((inner_mm + across * (outer_mm - inner_mm)) * p);
  });
  RobotSpec spec = round_robot(std::move(mesh), round_nu, curved);
  if (curved) {
    spec.mesh_options.curve->smooth = false;
    for (const double radius : {inner_mm, outer_mm})
      spec.mesh_options.curve->surfaces.push_back({Sphere{{0, 0, 0}, radius}, {}});
  }
  spec.materials[0].density = 1;
  spec.loads.gravity = {0, 0, -1};
  spec.fixed.push_back({{Halfspace{{0, 0, 1e-9}, {0, 0, -1}}, {}}, {false, false, true}});
  hold_vertex(spec, 0, {true, true, false});
  hold_vertex(spec, 1, {true, false, false});
  spec.markers.push_back({"top", {Vec3(0, 0, outer_mm), {}}});
  const Model model = compiled_round(spec);
  const Statics statics(model);
  return outer_mm - marker_at(model, solve_converged(statics, {}, tight(1e-12)))[2];
}

bool has_curved_note(const Model& model) {
  return std::any_of(model.notes.begin(), model.notes.end(),
                     [](const std::string& note) { return note.find("'curve' moved") != std::string::npos; });
}

/// How far the end of a turned body that is held at x = 0 sinks and stretches under small forces [mm].
std::pair<double, double> moves_of(const TurnedBody& body, int finer, bool curved) {
  constexpr double force = 1e-5;
  RobotSpec spec = round_robot(body.mesh(1, finer), round_nu, curved);
  spec.fixed.push_back({{Halfspace{{1e-6, 0, 0}, {-1, 0, 0}}, {}}});
  const double length = spec.mesh.vertices.col(0).maxCoeff();
  Region end;
  end.name = "end";
  end.dimension = 2;
  for (const Triangle& t : boundary_of(spec.mesh.tetrahedra, {}).triangles)
    if (std::all_of(t.begin(), t.end(), [&](Index v) { return spec.mesh.vertices(v, 0) > length - 1e-9; })) {
      end.triangles.push_back(spec.mesh.triangles.size());
      spec.mesh.triangles.push_back(t);
    }
  spec.mesh.regions.push_back(end);
  spec.loads.forces.push_back({"load", {std::string("end"), {}}, {force, 0, -force}});
  spec.markers.push_back({"tip", {std::string("end"), {}}});
  const Model model = compile(spec);
  EXPECT_EQ(curved, has_curved_note(model));
  const Statics statics(model);
  const Vec3 moved =
      marker_at(model, solve_converged(statics, {}, tight(1e-11))) - model.markers[0].point.at(model.rest);
  return {-moved[2], moved[0]};
}

}  // namespace

TEST(PhysicalCurved, ARodBendsAsABeam) {
  for (const int corners : {10, 12, 14}) {
    const double straight = bent_rod(corners, 12, false), curved = bent_rod(corners, 12, true);
    EXPECT_NEAR(curved, 1, 0.01) << corners;
    EXPECT_GT(straight, 1.05) << corners;
    RecordProperty("rod_" + std::to_string(corners), std::to_string(straight) + " " + std::to_string(curved));
  }
}

TEST(PhysicalCurved, ATubeWidensAsLameSays) {
  for (const int corners : {8, 9, 10}) {
    const double straight = blown_tube(corners, false), curved = blown_tube(corners, true);
    EXPECT_NEAR(curved, 1, 0.01) << corners;
    EXPECT_GT(std::abs(straight - 1), 0.05) << corners;
    RecordProperty("tube_" + std::to_string(corners), std::to_string(straight) + " " + std::to_string(curved));
  }
}

TEST(PhysicalCurved, ABallWidensAsLameSays) {
  for (const auto& [cuts, layers] : {std::pair(1, 1), std::pair(1, 2), std::pair(1, 3)}) {
    const double straight = blown_ball(cuts, layers, false), curved = blown_ball(cuts, layers, true);
    EXPECT_NEAR(curved, 1, 0.01) << cuts << layers;
    EXPECT_GT(std::abs(straight - 1), 0.05) << cuts << layers;
    RecordProperty("ball_" + std::to_string(cuts) + std::to_string(layers),
                   std::to_string(straight) + " " + std::to_string(curved));
  }
}

/// Grooves, shoulders and beads that the mesh resolves: ends move as those of meshes of eight times as many elements.
TEST(PhysicalCurved, TurnedBodiesBendAndStretchAsThoseOfFinerMeshes) {
  const ProfilePiece before = profile_line({0, 10}, {15, 10}, 3);
  std::vector<TurnedBody> bodies(3);
  bodies[0].pieces = {before, profile_arc_piece({21, 16}, 6 * std::numbers::sqrt2, 1.25 * round_pi, 1.75 * round_pi, 4),
                      profile_line({27, 10}, {35, 10}, 2)};
  bodies[1].pieces = {before, profile_arc_piece({18, 8}, 3, round_pi, 1.5 * round_pi, 3),
                      profile_line({18, 5}, {35, 5}, 3)};
  const double angle = 0.05 * round_pi, across = 5 * std::cos(angle), radius = 6 + 5 * std::sin(angle);
  bodies[2].pieces = {profile_line({0, radius}, {20 - across, radius}, 3),
                      profile_arc_piece({20, 6}, 5, round_pi - angle, angle, 5),
                      profile_line({20 + across, radius}, {35, radius}, 2)};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto fine = moves_of(bodies[i], 2, true), straight = moves_of(bodies[i], 1, false),
               curved = moves_of(bodies[i], 1, true);
    EXPECT_LT(std::abs(curved.first / fine.first - 1), 0.25 * std::abs(straight.first / fine.first - 1)) << i;
    EXPECT_LT(std::abs(curved.second / fine.second - 1), 0.25 * std::abs(straight.second / fine.second - 1)) << i;
  }
}

/// Against a mesh of eight times as many elements, whose half differs by a third of a percent.
TEST(PhysicalCurved, ADomeBendsAsOneOfAFinerMesh) {
  const double fine = sinking_dome(4, 3, 2, true);
  EXPECT_NEAR(sinking_dome(4, 3, 1, true), fine, 4e-3 * fine);
  for (const int sides : {4, 5, 6}) {
    const double straight = sinking_dome(sides, 2, 1, false) / fine, curved = sinking_dome(sides, 2, 1, true) / fine;
    EXPECT_NEAR(curved, 1, 0.01) << sides;
    EXPECT_GT(std::abs(straight - 1), 0.05) << sides;
    RecordProperty("dome_" + std::to_string(sides), std::to_string(straight) + " " + std::to_string(curved));
  }
}

}  // namespace softkin
