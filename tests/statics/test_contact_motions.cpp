#include <cmath>

#include "statics/contact_scenes.hpp"
#include "statics/physical_samples.hpp"

/// Motions to shapes that lie on something: numbers of iterations, and which contacts or supports hold the shapes.

namespace softkin {

namespace {

using namespace testing;

/// A soft, heavy plate right over a smooth floor: what is held of it, and by how much that is lifted.
struct PlateOnFloor {
  static constexpr double side = 100, height = 1, gap = 0.01, distance = 0.005, density = 1000;
  std::vector<FixedSpec> fixed{};
  bool quadratic = false;
  double friction = 0;

  [[nodiscard]] static Mesh mesh() { return block_mesh({16, 16, 1}, {side, side, height}); }
  [[nodiscard]] static double weight() { return 1e-9 * density * 9.81 * side * side * height; }

  [[nodiscard]] RobotSpec robot() const {
    RobotSpec spec = physical_robot(mesh());
    spec.materials[0].elastic = elastic(Law::neo_hookean, 1, 0);
    spec.materials[0].density = density;
    spec.loads.gravity = {0, 0, -9.81};
    spec.fixed = fixed;
    spec.mesh_options.quadratic = quadratic;
    spec.contact = contact_below(distance);
    spec.contact->friction = friction;
    spec.contact->obstacles.push_back({"floor", Halfspace{{0, 0, -gap}, {0, 0, 1}}, std::nullopt, {}});
    return spec;
  }
};

/// Vertices of the plate up to a height.
FixedSpec held(double up_to, const std::array<bool, 3>& axes, const Vec3& displacement, const auto& where) {
  const Points at = PlateOnFloor::mesh().vertices;
  VertexList list;
  for (Index v = 0; v < at.rows(); ++v)
    if (at(v, 2) <= up_to && where(at(v, 0), at(v, 1))) list.vertices.push_back(v);
  return {{std::move(list), {}}, axes, displacement};
}

void expect_held(const PlateOnFloor& plate, std::size_t lifted) {
  const Model model = compile(plate.robot());
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, {});
  EXPECT_LE(found.report.iterations, 60);
  const ElementDeformation measured = statics.measured(found.state);
  ASSERT_TRUE(measured.contacts);
  ASSERT_EQ(measured.contacts->pairs.size(), 1u);
  const double held = reaction_of(model, statics, found, lifted).z();
  EXPECT_GT(held, 0.01 * PlateOnFloor::weight());
  EXPECT_NEAR(held + measured.contacts->pairs[0].normal_N, PlateOnFloor::weight(), 1e-5 * PlateOnFloor::weight());
}

}  // namespace

TEST(ContactMotions, PlateLiftedAtAnEdge) {
  const double side = PlateOnFloor::side;
  const FixedSpec back =
      held(PlateOnFloor::height, {true, true, false}, Vec3::Zero(), [](double x, double) { return x == 0; });
  const FixedSpec edge = held(0, {false, false, true}, {0, 0, 2}, [&](double x, double) { return x == side; });
  for (const bool quadratic : {false, true}) expect_held({{back, edge}, quadratic}, 1);
}

/// All of the plate makes contact at once and sticks; the floor carries its weight, except for the part of the support.
TEST(ContactMotions, PlateLaidDownOnARoughFloor) {
  const FixedSpec back =
      held(PlateOnFloor::height, {true, true, true}, Vec3::Zero(), [](double x, double) { return x == 0; });
  expect_held({{back}, false, 0.4}, 0);
}

TEST(ContactMotions, PlateLiftedAtACorner) {
  const double side = PlateOnFloor::side;
  const FixedSpec back = held(PlateOnFloor::height, {true, true, false}, Vec3::Zero(),
                              [](double x, double y) { return x == 0 && y == 0; });
  const FixedSpec beside =
      held(0, {false, true, false}, Vec3::Zero(), [&](double x, double y) { return x == side && y == 0; });
  const FixedSpec corner =
      held(0, {false, false, true}, {0, 0, 2}, [&](double x, double y) { return x == side && y == side; });
  expect_held({{back, beside, corner}}, 2);
}

}  // namespace softkin
