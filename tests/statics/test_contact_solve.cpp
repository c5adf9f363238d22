#include <Eigen/Geometry>
#include <cstdio>

#include "statics/contact_scenes.hpp"
#include "support/degenerate_scenes.hpp"
#include "support/exact_crossing.hpp"
#include "support/random_drops.hpp"

/// Equilibria of robots that touch themselves or obstacles.

namespace softkin {
namespace {

using namespace testing;

/// Stress under a uniform compression: von Mises' of every element, beside that of the force over the area.
struct Uniformity {
  double pressure = 0;  // [MPa]
  double error = 0;     // largest deviation over the pressure
};

Uniformity uniformity_of(const StackedBlocks& blocks) {
  const Model model = compile(blocks.robot());
  const Statics statics(model);
  const Equilibrium found = settled(statics, {});
  const auto at = [&](Index v) { return Vec3(found.state.positions.row(v)); };
  double wide[2] = {0, 0};  // of the upper block
  for (Index v = 0; v < model.robot_vertices(); ++v)
    for (int axis = 0; axis < 2; ++axis)
      if (model.rest(v, axis) == StackedBlocks::size && model.rest(v, 2) > StackedBlocks::size + blocks.gap)
        wide[axis] = std::max(wide[axis], at(v)[axis]);
  Uniformity out;
  out.pressure = -reaction_of(model, statics, found, 1).z() / (wide[0] * wide[1]);
  for (const double stress : statics.measured(found.state).stress.von_mises)
    out.error = std::max(out.error, std::abs(stress / out.pressure - 1));
  std::printf("%-9s distance %8g: pressure %.6f MPa, largest deviation %.2e, %d iterations, %.2f s\n",
              blocks.quadratic ? "quadratic" : "linear", blocks.distance, out.pressure, out.error,
              found.report.iterations, found.report.seconds);
  return out;
}

TEST(ContactSolve, PatchOfMeshesThatDoNotMatch) {
  for (const bool quadratic : {false, true})
    for (const double share : {0.02, 0.005, 0.00125}) {
      const double distance = share * StackedBlocks::size;
      const Uniformity found = uniformity_of({distance, 2.5 * distance, 2.5 * distance + 2, quadratic});
      EXPECT_LT(std::abs(found.error), 0.01) << quadratic << " " << share;
    }
}

std::vector<Index> bottom_of(const Model& model, double height) {
  std::vector<Index> bottom;
  for (Index v = 0; v < model.robot_vertices(); ++v)
    if (std::abs(model.rest(v, 2) - height) < 1e-9) bottom.push_back(v);
  return bottom;
}

TEST(ContactSolve, AFloorBearsWhatPressesOnIt) {
  for (const bool quadratic : {false, true}) {
    const BlockOnFloor block{0.2, 0.1, 1, quadratic};
    RobotSpec spec = block.robot();
    const double load = 7;
    spec.forces = {{"weight", {std::string("z_low"), {}}, {0, 0, -load}}};
    const Model model = compile(spec);
    const Statics statics(model);
    const Equilibrium found = settled(statics, {});
    const std::vector<Index> bottom = bottom_of(model, block.gap);
    const Eigen::VectorXd push = push_of_floor(model, found.state.positions, bottom);
    const double held = -reaction_of(model, statics, found, 0).z();
    EXPECT_NEAR(push.sum(), held + load, 1e-6 * push.sum());
    std::printf("floor, %s: bears %.9g N of %.9g\n", quadratic ? "quadratic" : "linear", push.sum(), held + load);
  }
}

TEST(ContactSolve, PressureOnAFloorIsUniform) {
  for (const bool quadratic : {false, true}) {
    const BlockOnFloor block{0.1, 0.05, 1, quadratic};
    const Model model = compile(block.robot());
    const Statics statics(model);
    const Equilibrium found = settled(statics, {});
    double low = 1e9, high = 0;
    for (const Index v : bottom_of(model, block.gap)) {
      low = std::min(low, found.state.positions(v, 2));
      high = std::max(high, found.state.positions(v, 2));
    }
    double least = 1e9, most = 0;
    for (const double stress : statics.measured(found.state).stress.von_mises) {
      least = std::min(least, stress);
      most = std::max(most, stress);
    }
    std::printf("floor, %s: gaps %.9g to %.9g mm, stress %.9g to %.9g MPa\n", quadratic ? "quadratic" : "linear", low,
                high, least, most);
    EXPECT_GT(low, 0);
    EXPECT_LT((high - low) / high, quadratic ? 0.1 : 1e-6);
    EXPECT_LT((most - least) / most, quadratic ? 0.01 : 1e-6);
  }
}

/// Clamped at its top, pressed on a floor and pushed aside, all turned and moved.
RobotSpec turned_block(const Mat3& turn, const Vec3& shift) {
  Mesh mesh = block_mesh({3, 2, 2}, {24, 20, 16});
  VertexList top;
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices(v, 2) == 16) top.vertices.push_back(v);
  const auto moved = [&](const Vec3& p) { return Vec3(turn * p + shift); };
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    mesh.vertices.row(v) = moved(mesh.vertices.row(v).transpose()).transpose();
  RobotSpec spec = physical_robot(std::move(mesh));
  spec.fixed = {{{top, {}}, {true, true, true}, turn * Vec3(1, 2, -1.5)}};
  spec.forces = {{"push", {moved({24, 10, 8}), {}}, turn * Vec3(0.5, 0.3, -1)}};
  spec.contact = contact_below(0.2);
  spec.contact->obstacles.push_back({"floor", Halfspace{moved({3, 4, -0.1}), turn * Vec3(0, 0, 1)}, std::nullopt, {}});
  return spec;
}

TEST(ContactSolve, TurnsWithEverythingAround) {
  const auto solved = [](const Mat3& turn, const Vec3& shift) {
    const Model model = compile(turned_block(turn, shift));
    const Statics statics(model);
    return Points(settled(statics, {}, tight(1e-10)).state.positions.topRows(model.robot_vertices()));
  };
  const Points straight = solved(Mat3::Identity(), Vec3::Zero());
  for (const Vec3& axis : {Vec3(1, 2, 3), Vec3(0, 1, 0), Vec3(-3, 1, 0.2)}) {
    const Mat3 turn = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
    const Vec3 shift = 10 * axis;
    const Points turned = solved(turn, shift);
    const Points back = (turned.rowwise() - shift.transpose()) * turn;
    const double error = distance(back, straight) / 35;
    std::printf("turned: %.2e of the diagonal\n", error);
    EXPECT_LT(error, 1e-9);
  }
}

}  // namespace
}  // namespace softkin
