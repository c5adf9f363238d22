#include <Eigen/Geometry>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"
#include "statics/difference.hpp"
#include "statics/robots.hpp"

namespace softkin {

namespace {

using namespace testing;

MarkerSpec stem(const std::string& region, const Vec3& offset) {
  return {"tip", {region, {}}, offset, {}};
}

Marker tip_of(const MarkerSpec& marker) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 2}, {30, 20, 10}));
  spec.markers = {marker};
  return compile(spec).markers[0];
}

}  // namespace

/// Whatever turns and moves the body as a whole takes the end of the stem along.
TEST(Marker, AStemTurnsWithItsRegion) {
  const Vec3 offset(4, -7, 11);
  const Marker marker = tip_of(stem("x_high", offset));
  const Points rest = grid_points({3, 2, 2}, {30, 20, 10});
  EXPECT_LT((marker.at(rest) - (Vec3(30, 10, 5) + offset)).norm(), 1e-12);
  for (const double angle : {0.3, 1.9, 3.1}) {
    const Mat3 rotation = Eigen::AngleAxisd(angle, Vec3(1, 2, -1).normalized()).toRotationMatrix();
    const Vec3 slide(5, 6, -7);
    const Points moved = (rest * rotation.transpose()).rowwise() + slide.transpose();
    EXPECT_LT((marker.at(moved) - (rotation * (Vec3(30, 10, 5) + offset) + slide)).norm(), 1e-12);
  }
  // whatever the region does, the stem keeps its length
  const Points stretched = rest * Vec3(1.2, 1.3, 0.9).asDiagonal();
  EXPECT_NEAR((marker.at(stretched) - Vec3(36, 13, 4.5)).norm(), offset.norm(), 1e-12);
}

TEST(Marker, ItsVelocityIsThatOfDifferences) {
  const Marker marker = tip_of(stem("x_high", {4, -7, 11}));
  const Points rest = grid_points({3, 2, 2}, {30, 20, 10});
  const Points shape = rest + noise(rest.rows(), 2, 3);
  for (const unsigned seed : {5u, 6u, 7u}) {
    const Points moves = noise(rest.rows(), 1, seed);
    constexpr double reach = 1e-5;
    const Vec3 slope = (marker.at(shape + reach * moves) - marker.at(shape - reach * moves)) / (2 * reach);
    EXPECT_LT((marker.velocity(shape, moves) - slope).norm(), 1e-8 * slope.norm());
  }
}

TEST(Marker, AStemByThePointWhereItEnds) {
  const Marker by_point = tip_of({"tip", {Vec3(34, 3, 16), {}}, {}, std::string("x_high")});
  EXPECT_LT((by_point.stem - Vec3(4, -7, 11)).norm(), 1e-12);
}

TEST(Marker, StemsAreRefusedWithAReason) {
  const auto refused = [](const MarkerSpec& bad, const std::string& why) {
    try {
      (void)tip_of(bad);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  refused(stem("x_high", {1000, 0, 0}), "longer than the robot is from corner to corner");
  refused(stem("x_high", {std::nan(""), 0, 0}), "is not finite");
  refused(stem("nowhere", {1, 0, 0}), "nowhere");
  RobotSpec spec = physical_robot(block_mesh({3, 2, 2}, {30, 20, 10}));
  spec.regions.push_back({"edge", VertexList{{0, 1, 2, 3}}, {}});
  spec.markers = {stem("edge", {0, 0, 3})};
  EXPECT_THROW((void)compile(spec), InvalidInput) << "vertices on a line";
}

}  // namespace softkin
