#include <softkin/statics/worst_place.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using testing::air;
using testing::block_mesh;
using testing::cable_beam;
using testing::hollow_mesh;
using testing::physical_robot;

WorstPlace worst_of(const Model& model, const Points& positions) {
  return worst_place(model, positions, deformation_of(model, positions)).value();
}

/// The shape at rest with one vertex moved, which deforms the elements at it alone.
Points pulled(const Model& model, const Vec3& vertex, const Vec3& move) {
  Points positions = model.rest;
  Index nearest = 0;
  (positions.rowwise() - vertex.transpose()).rowwise().norm().minCoeff(&nearest);
  positions.row(nearest) += move.transpose();
  return positions;
}

TEST(WorstPlace, IsWhereTheShapeIsDeformedMostAndTellsWhatIsThere) {
  RobotSpec spec = cable_beam();
  testing::add_volume_region(spec.mesh, "hinge", [](const Vec3& p) { return p.x() > 25 && p.x() < 35; });
  const Model model = compile(spec);
  const WorstPlace end = worst_of(model, pulled(model, {60, 5, 10}, {2, 0, 2}));
  EXPECT_EQ(end.beside, "the end of cable 'top'");
  EXPECT_LT((end.at - Vec3(60, 5, 10)).norm(), 6);
  const WorstPlace middle = worst_of(model, pulled(model, {20, 5, 0}, {0, 0, -3}));
  EXPECT_EQ(middle.beside, "point 2 of cable 'bottom'");
}

TEST(WorstPlace, ChambersWallsAndWhatIsHeld) {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.actuators = {air("chamber")};
  const Model model = compile(spec);
  const WorstPlace wall = worst_of(model, pulled(model, {20, 20, 20}, {3, 3, 3}));
  EXPECT_EQ(wall.beside, "the wall of chamber 'chamber'");
  const Model bar = compile(physical_robot(block_mesh({6, 1, 1}, {60, 10, 10})));
  EXPECT_EQ(worst_of(bar, pulled(bar, {10, 0, 0}, {-3, 0, 0})).beside, "what is held");
  EXPECT_EQ(worst_of(bar, pulled(bar, {40, 0, 0}, {-3, 0, 0})).beside, "");
  const WorstPlace crushed = worst_of(bar, pulled(bar, {60, 10, 10}, {-9.9, 0, 0}));
  EXPECT_LT(crushed.volume_ratio, 0.05);
  EXPECT_GT(crushed.at.x(), 50);
}

TEST(WorstPlace, CrushedElementsComeBeforeStretchedOnes) {
  const Model bar = compile(physical_robot(block_mesh({6, 1, 1}, {60, 10, 10})));
  Points positions = pulled(bar, {60, 0, 0}, {40, 0, 0});  // 300 %
  const WorstPlace stretched = worst_of(bar, positions);
  EXPECT_GT(stretched.strain, 1);
  positions = positions + pulled(bar, {20, 10, 10}, {-9, 0, 0}) - bar.rest;
  const WorstPlace crushed = worst_of(bar, positions);
  EXPECT_LT(crushed.at.x(), 40);
  EXPECT_LT(crushed.volume_ratio, 0.2);
}

}  // namespace
}  // namespace softkin
