#include <gtest/gtest.h>

#include <softkin/model/compile/closing.hpp>
#include <softkin/model/mesh/mesh_order.hpp>

#include "model/compile_testing.hpp"
#include "model/open_walls.hpp"
#include "model/physical_robots.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

constexpr double cell = 6;  // [mm]
constexpr int cells = 3;
constexpr double side = cell * cells;

using Chosen = std::function<bool(int, int, int)>;  // is a cell, by its numbers along x, y and z, of the chamber

/// Moves points of the block along its faces and inside of it, its corners nowhere.
Points warped(Points points, double by) {
  for (Index v = 0; v < points.rows(); ++v) {
    const Vec3 p = points.row(v).transpose() / side;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = p[axis] * (1 - p[axis]), other = p[(axis + 1) % 3], third = p[(axis + 2) % 3];
      points(v, axis) += side * by * along * (1 + other - 2 * third * other);
    }
  }
  return points;
}

/// A block, fixed at x = 0 and a plane of symmetry at every other side, with a chamber of cells.
RobotSpec block_with_chamber(const Chosen& is_chamber, bool quadratic) {
  Mesh mesh = block_mesh({cells, cells, cells}, {side, side, side});
  add_volume_region(mesh, "chamber", [&](const Vec3& p) {
    return is_chamber(static_cast<int>(p.x() / cell), static_cast<int>(p.y() / cell), static_cast<int>(p.z() / cell));
  });
  if (quadratic) {
    mesh = elevated(mesh);
    mesh.vertices = warped(mesh.vertices, 0.15);  // edges are curved, those of openings too
  }
  RobotSpec spec = physical_robot(std::move(mesh));
  for (const char* face : {"x_high", "y_low", "y_high", "z_low", "z_high"}) {
    FixedSpec& fixed = spec.fixed.emplace_back();
    fixed.where = named(face);
    fixed.axes = {face[0] == 'x', face[0] == 'y', face[0] == 'z'};
  }
  spec.actuators = {chamber("chamber")};
  return spec;
}

/// The same robot with the chamber empty, and given by those of its faces that are the body's.
RobotSpec with_wall(RobotSpec spec) {
  add_open_wall(spec.mesh, "chamber");
  spec.voids = {named("chamber")};
  spec.actuators[0].as<PneumaticSpec>()->region.reset();
  spec.actuators[0].as<PneumaticSpec>()->wall = "wall";
  return spec;
}

const std::vector<CavityFace>& cavity_of(const Model& model) {
  return model.actuators[0].as<ChamberDrive>()->cavity;
}

/// The volume of the chamber is that of its elements, at rest and as the block is bent.
void expect_same_volumes(const Chosen& is_chamber, bool quadratic) {
  const RobotSpec spec = block_with_chamber(is_chamber, quadratic);
  const Model whole = compile(spec), walled = compile(with_wall(spec));
  const double volume = enclosed_volume(whole.rest, cavity_of(whole));
  ASSERT_GT(volume, cell * cell * cell / 2);
  EXPECT_NEAR(walled.actuators[0].rest_measure, volume, 1e-10 * volume);
  EXPECT_NEAR(enclosed_volume(walled.rest, cavity_of(walled)), volume, 1e-10 * volume);
  for (const double by : {0.2, -0.3}) {
    const double moved = enclosed_volume(warped(whole.rest, by), cavity_of(whole));
    EXPECT_NEAR(enclosed_volume(warped(walled.rest, by), cavity_of(walled)), moved, 1e-10 * moved);
  }
}

/// Which cells of an axis a chamber takes: the first, the middle one, the last, or all.
bool takes(int choice, int number) {
  return choice == 3 || choice == number;
}

TEST(OpenWalls, ChambersThatEndAtAnyPlanesOfABlockHaveTheVolumeOfTheirElements) {
  int turn = 0;
  for (int x = 0; x < 4; ++x)
    for (int y = x; y < 4; ++y)
      for (int z = y; z < 4; ++z) {
        if (y == 3 && z == 3 && x != 1) continue;  // all of the block, or all of one of its sides
        ++turn;                                    // so that every axis has every kind of end
        for (const bool quadratic : {false, true}) {
          SCOPED_TRACE(std::to_string(x) + std::to_string(y) + std::to_string(z) + (quadratic ? ", order 2" : ""));
          const auto is_chamber = [=](std::array<int, 3> at) {
            std::rotate(at.begin(), at.begin() + turn % 3, at.end());
            return takes(x, at[0]) && takes(y, at[1]) && takes(z, at[2]);
          };
          expect_same_volumes([=](int i, int j, int k) { return is_chamber({i, j, k}); }, quadratic);
        }
      }
}

TEST(OpenWalls, SeveralOpeningsInOnePlaneAreClosed) {
  const std::vector<Chosen> shapes = {
      [](int i, int j, int k) { return j == 0 && (i != 1 || k != 1); },   // a ring around a column
      [](int i, int j, int k) { return j == 0 && std::max(i, k) == 1; },  // a quarter of such a ring
      [](int i, int j, int k) {
        return std::max({i, j, k}) == 1;
      },                                                                           // an eighth of a hollow ball
      [](int i, int j, int k) { return j == 0 && k == 1 && i != 1; },              // two separate chambers
      [](int i, int j, int k) { return j < 2 && (i != 1 || j == 1) && k == 1; }};  // a bent duct with two mouths
  for (const bool quadratic : {false, true})
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      SCOPED_TRACE(std::to_string(i) + (quadratic ? ", order 2" : ""));
      expect_same_volumes(shapes[i], quadratic);
    }
}

/// No command moves what closes the chamber: it has the vertices of the rim, and where three planes meet inside the
/// chamber one that is fixed.
TEST(OpenWalls, OnlyACornerInsideTheChamberIsAnotherVertex) {
  const RobotSpec quarter =
                      with_wall(block_with_chamber([](int i, int j, int k) { return i == 1 && j < 1 && k < 1; }, true)),
                  eighth =
                      with_wall(block_with_chamber([](int i, int j, int k) { return i < 1 && j < 1 && k < 1; }, true));
  const Model one = compile(quarter), other = compile(eighth);
  EXPECT_EQ(one.rest.rows(), quarter.mesh.vertices.rows());
  ASSERT_EQ(other.rest.rows(), eighth.mesh.vertices.rows() + 1);
  EXPECT_EQ(Vec3(other.rest.bottomRows(1).transpose()), Vec3(0, 0, 0));
  EXPECT_EQ(other.held.fixed.back(), (std::array{true, true, true}));
  EXPECT_FALSE(other.elements.used.back());
}

/// A plate need not be normal to an axis.
TEST(OpenWalls, APlateInAnyPlaneClosesAChamber) {
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = block_with_chamber([](int i, int j, int k) { return i < 2 && j == 1 && k == 1; }, quadratic);
    Eigen::Matrix3d tilt = Eigen::Matrix3d::Identity();
    tilt(0, 1) = 0.3;
    tilt(0, 2) = -0.2;
    spec.mesh.vertices = spec.mesh.vertices * tilt.transpose();
    spec.fixed.resize(1);  // x_low alone
    const Model whole = compile(spec), walled = compile(with_wall(spec));
    const double volume = enclosed_volume(whole.rest, cavity_of(whole));
    EXPECT_NEAR(walled.actuators[0].rest_measure, volume, 1e-10 * volume);
  }
}

TEST(OpenWalls, ARimThatNothingHoldsIsRefused) {
  const RobotSpec good =
      with_wall(block_with_chamber([](int i, int j, int k) { return i == 1 && j == 0 && k == 1; }, false));
  const auto drop = [](const char* face) {
    return [face](RobotSpec& s) {
      std::erase_if(s.fixed, [&](const FixedSpec& f) { return std::get<std::string>(f.where.region) == face; });
    };
  };
  expect_refused(good, {{"free plane", drop("y_low"),
                         "has a wall, region 'wall', that bounds no chamber: the surface is not closed: its rim of 4 "
                         "edges has its middle at (9, 0, 9) mm, and no plane that is held closes it: the edge from ("},
                        {"held along another axis",
                         [](RobotSpec& s) {
                           for (FixedSpec& f : s.fixed)
                             if (std::get<std::string>(f.where.region) == "y_low") f.axes = {true, false, false};
                         },
                         "mm is held along x; the region must hold every face"},
                        {"a face is missing", [](RobotSpec& s) { s.mesh.regions.back().triangles.pop_back(); },
                         "no plane that is held closes it"}});
}

/// The corner of an eighth stays where it is, so that its planes must, too.
TEST(OpenWalls, APlaneThatIsMovedClosesNoChamberWithACornerInIt) {
  RobotSpec spec = with_wall(block_with_chamber([](int i, int j, int k) { return std::max({i, j, k}) < 1; }, false));
  ASSERT_EQ(refusal(spec), "");
  for (FixedSpec& fixed : spec.fixed)
    if (std::get<std::string>(fixed.where.region) == "z_low") fixed.displacement.z() = 1;
  std::erase_if(spec.fixed, [](const FixedSpec& f) { return std::get<std::string>(f.where.region) == "x_low"; });
  spec.fixed.push_back({named("x_low"), {true, false, false}});
  EXPECT_NE(refusal(spec).find("has a chamber that is open"), std::string::npos) << refusal(spec);
}

}  // namespace
