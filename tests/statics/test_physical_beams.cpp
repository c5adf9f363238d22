#include <unistd.h>

#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <softkin/io/mesh/mesh_io.hpp>

#include "statics/physical_samples.hpp"

/// Beams under dead loads, against rods. nu = 0: a clamped section stiffens nothing.

namespace softkin {

namespace {

using namespace testing;

constexpr double beam_length = 100, beam_width = 4, beam_modulus = 2;
constexpr double beam_area = beam_width * beam_width, beam_inertia = beam_area * beam_area / 12;

RobotSpec beam(Law law = Law::st_venant_kirchhoff) {
  RobotSpec spec = physical_robot(block_mesh({25, 1, 1}, {beam_length, beam_width, beam_width}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].elastic = elastic(law, beam_modulus, 0);
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// Tip of the inextensible rod under a dead load across, P L^2 / (E I) = load: Runge-Kutta and shooting in the slope's
/// derivative at the clamp. theta'' = -load cos(theta), theta(0) = 0, theta'(1) = 0; deflection down is positive.
struct Rod {
  double x = 0, z = 0, angle = 0, curvature = 0;
};

Rod integrate(double load, double curvature) {
  Rod rod;
  rod.curvature = curvature;
  constexpr int steps = 2000;
  const auto rate = [&](const Rod& r) {
    return Rod{std::cos(r.angle), std::sin(r.angle), r.curvature, -load * std::cos(r.angle)};
  };
  const auto ahead = [](const Rod& r, const Rod& k, double h) {
    return Rod{r.x + h * k.x, r.z + h * k.z, r.angle + h * k.angle, r.curvature + h * k.curvature};
  };
  constexpr double h = 1.0 / steps;
  for (int i = 0; i < steps; ++i) {
    const Rod a = rate(rod), b = rate(ahead(rod, a, h / 2)), c = rate(ahead(rod, b, h / 2)), d = rate(ahead(rod, c, h));
    rod = ahead(ahead(ahead(ahead(rod, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
  }
  return rod;
}

Rod elastica(double load) {
  double low = 0, high = load;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (integrate(load, middle).curvature > 0 ? high : low) = middle;
  }
  return integrate(load, high);
}

}  // namespace

/// The known tip of the elastica under P L^2 / (E I) = 1 and 10 (Bisshopp and Drucker 1945): deflection 0.3017 and
/// 0.8106, and the same over L here. A beam 25 times as long as high is sheared by 1 / 25^2 of that.
TEST(PhysicalBeams, PayloadBendsACantileverAsTheElasticaSays) {
  EXPECT_NEAR(elastica(1).z, 0.3017, 1e-4);
  EXPECT_NEAR(elastica(10).z, 0.8106, 1e-4);
  for (const Law law : {Law::st_venant_kirchhoff, Law::neo_hookean})
    for (const double load : {0.5, 2.0, 6.0}) {
      RobotSpec spec = beam(law);
      spec.loads.forces.push_back({"payload",
                                   {std::string("x_high"), {}},
                                   {0, 0, -load * beam_modulus * beam_inertia / (beam_length * beam_length)}});
      const Model model = compile(spec);
      const Statics statics(model);
      const Vec3 tip = marker_at(model, solve_converged(statics, {}));
      const Rod rod = elastica(load);
      EXPECT_NEAR(tip[0], beam_length * rod.x, 0.004 * beam_length) << load;
      EXPECT_NEAR(tip[1], beam_width / 2, 0.02) << load;  // the mesh is not symmetric
      EXPECT_NEAR(beam_width / 2 - tip[2], beam_length * rod.z, 0.004 * beam_length) << load;
    }
}

/// Its own weight lengthens a hanging rod by rho g L^2 / (2 E).
TEST(PhysicalBeams, WeightStretchesAHangingRod) {
  RobotSpec spec = beam();
  spec.materials[0].density = 1100;
  spec.loads.gravity = {9.81e-2, 0, 0};
  const Model model = compile(spec);
  const Statics statics(model);
  const double stretch = 1100e-9 * 9.81e-2 * beam_length * beam_length / (2 * beam_modulus);
  EXPECT_NEAR(marker_at(model, solve_converged(statics, {}, tight(1e-12)))[0] - beam_length, stretch, 1e-3 * stretch);
}

/// q L^4 / (8 E I) and, by shear, q L^2 / (2 (5/6) G A).
TEST(PhysicalBeams, WeightBendsALyingRod) {
  RobotSpec spec = beam();
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 0, -9.81e-2};
  const Model model = compile(spec);
  const Statics statics(model);
  const double weight = 1100e-9 * 9.81e-2 * beam_area;
  const double bent = weight * std::pow(beam_length, 4) / (8 * beam_modulus * beam_inertia),
               sheared = weight * beam_length * beam_length / (2 * 5.0 / 6 * beam_modulus / 2 * beam_area);
  const Vec3 tip = marker_at(model, solve_converged(statics, {}, tight(1e-12)));
  EXPECT_NEAR(beam_width / 2 - tip[2], bent + sheared, 0.01 * bent);
}

/// Gravity and forces add up: the sum of supports' reactions is their sum, seen through the energy of a shifted clamp.
TEST(PhysicalBeams, AClampThatRisesLiftsTheWeight) {
  RobotSpec spec = beam();
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 0, -1};
  spec.loads.forces.push_back({"payload", {Vec3(beam_length, beam_width / 2, beam_width / 2), {}}, {0, 0, -1e-3}});
  const Model low = compile(spec);
  spec.fixed[0].displacement = {0, 0, 3};
  const Model high = compile(spec);
  const Statics low_statics(low), high_statics(high);
  const Equilibrium a = solve_converged(low_statics, {}), b = solve_converged(high_statics, {});
  const double weight = 1100e-9 * beam_area * beam_length + 1e-3;
  EXPECT_NEAR(b.report.energy - a.report.energy, 3 * weight, 1e-6 * weight);
  EXPECT_LT(distance(a.state.positions.rowwise() + Eigen::RowVector3d(0, 0, 3), b.state.positions), 1e-6);
}

namespace {

/// A mesh with nodes in the middles of its edges, numbered from the last tetrahedron on.
Mesh with_middles(Mesh mesh) {
  constexpr std::array<std::array<int, 2>, 6> edges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};  // VTK's order
  std::map<std::set<Index>, Index> middles;
  std::vector<Vec3> places;
  mesh.edge_nodes.resize(mesh.tetrahedra.size());
  for (std::size_t t = mesh.tetrahedra.size(); t-- > 0;)
    for (std::size_t e = 0; e < 6; ++e) {
      const Index from = mesh.tetrahedra[t][edges[e][0]], to = mesh.tetrahedra[t][edges[e][1]];
      const Index number = mesh.vertices.rows() + places.size();
      const auto [middle, is_new] = middles.try_emplace({from, to}, number);
      if (is_new) places.push_back(0.5 * (mesh.vertices.row(from) + mesh.vertices.row(to)).transpose());
      mesh.edge_nodes[t][e] = middle->second;
    }
  const Index corners = mesh.vertices.rows();
  mesh.vertices.conservativeResize(corners + std::ssize(places), 3);
  for (std::size_t i = 0; i < places.size(); ++i)
    mesh.vertices.row(corners + static_cast<Index>(i)) = places[i].transpose();
  return mesh;
}

}  // namespace

/// Order 2 read from a file is order 2 made from order 1.
TEST(PhysicalBeams, ElevatedIsTheSameAsRead) {
  RobotSpec made = bending_finger();
  const Index corners = made.mesh.vertices.rows();
  RobotSpec read = made;
  made.mesh_options.quadratic = true;
  const std::filesystem::path file = ::testing::TempDir() + "softkin_order_2_" + std::to_string(::getpid()) + ".msh";
  write_mesh(file, with_middles(read.mesh));
  read.mesh = read_mesh(file);
  std::filesystem::remove(file);
  const Model made_model = compile(made), read_model = compile(read);
  const Statics made_statics(made_model), read_statics(read_model);
  const Equilibrium a = solve_converged(made_statics, values({1.4})), b = solve_converged(read_statics, values({1.4}));
  ASSERT_EQ(a.state.positions.rows(), b.state.positions.rows());
  EXPECT_LT(distance(a.state.positions.topRows(corners), b.state.positions.topRows(corners)), 1e-8);
  EXPECT_GT(distance(a.state.positions, b.state.positions), 1) << "the nodes are numbered alike";
  EXPECT_NEAR(a.state.multipliers[0], b.state.multipliers[0], 1e-8 * a.state.multipliers[0]);
}

}  // namespace softkin
