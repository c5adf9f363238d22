#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <softkin/model/joined.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

/// Threads cut into the pieces that elements carry along.

namespace softkin {

namespace {

using namespace testing;

FibreSpec thread(std::vector<Vec3> path) {
  FibreSpec fibre;
  fibre.name = "thread";
  fibre.path = std::move(path);
  fibre.stiffness_N = 10;
  fibre.origin = line(7);
  return fibre;
}

FibreSpec coil() {
  FibreSpec fibre = thread({});
  fibre.path = Helix{{5, 6, 5}, {2, 0, 0}, {0, 3, 0}, 3, 4, 4.5};
  return fibre;
}

RobotSpec block(bool quadratic, Split split = Split::five) {
  RobotSpec spec = physical_robot(block_mesh({5, 3, 2}, {30, 12, 10}, split));
  spec.mesh_options.quadratic = quadratic;
  return spec;
}

double length_of(const Fibre& fibre) {
  double length = 0;
  for (const FibrePlace& place : fibre.places) length += place.length_mm;
  return length;
}

double length_of(const std::vector<Vec3>& path) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) length += (path[i + 1] - path[i]).norm();
  return length;
}

/// Stretch of the whole in a shape.
double stretch_of(const Fibre& fibre, const Points& positions) {
  double length = 0;
  for (const FibrePlace& place : fibre.places) {
    Vec3 along = Vec3::Zero();
    for (std::size_t i = 0; i < place.vertices.size(); ++i)
      along += place.slopes[i] * vertex_at(positions, place.vertices[i]);
    length += place.length_mm * along.norm();
  }
  return length / length_of(fibre);
}

}  // namespace

/// Of an affine shape F x every straight piece t is stretched to |F t|, whatever elements it crosses; also along edges
/// and faces of the mesh, and outside.
TEST(CompileFibres, StraightOnesStretchAsTheShapeDoes) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> within(0, 1);
  const auto drawn = [&] { return Vec3(30 * within(engine), 12 * within(engine), 10 * within(engine)); };
  std::vector<std::vector<Vec3>> paths{{{0, 0, 0}, {30, 0, 0}},
                                       {{0, 4, 5}, {30, 4, 5}},
                                       {{0, 0, 5}, {30, 12, 5}},
                                       {{2, 3, 10.5}, {25, 9, 10.5}},
                                       {{15, -0.4, 3}, {15, 12.4, 3}}};
  for (int i = 0; i < 20; ++i) paths.push_back({drawn(), drawn()});
  Mat3 shape;
  shape << 1.3, 0.2, -0.4, -0.1, 0.8, 0.3, 0.5, 0.1, 1.1;
  for (const auto& [quadratic, split] :
       {std::pair{false, Split::five}, std::pair{true, Split::five}, std::pair{false, Split::prisms}})
    for (const std::vector<Vec3>& path : paths) {
      RobotSpec spec = block(quadratic, split);
      spec.fibres = {thread(path)};
      const Model model = compile(spec);
      const Fibre& fibre = model.reinforcement.fibres.at(0);
      EXPECT_NEAR(length_of(fibre), length_of(path), 1e-9);
      const Vec3 t = (path[1] - path[0]).normalized();
      EXPECT_NEAR(stretch_of(fibre, model.rest * shape.transpose()), (shape * t).norm(), 1e-9);
      EXPECT_NEAR(stretch_of(fibre, model.rest), 1, 1e-9);
      for (std::size_t k = 0; k < 2; ++k)
        EXPECT_LT(((k == 0 ? fibre.knots.front() : fibre.knots.back()).at(model.rest) - path[k]).norm(), 1e-9);
    }
}

/// In a shape that is quadratic in the place, elements of order 2 know each piece's stretch: the length of the curve
/// that a thread becomes, integrated finely.
TEST(CompileFibres, OrderTwoFollowsCurvedShapes) {
  RobotSpec spec = block(true);
  const Vec3 from(1, 2, 3), to(29, 9, 8);
  spec.fibres = {thread({from, to})};
  const Model model = compile(spec);
  const auto bent = [](const Vec3& p) {
    return Vec3(p.x(), p.y() + 0.01 * p.x() * p.z(), p.z() + 0.02 * p.x() * p.x());
  };
  Points positions = model.rest;
  for (Index v = 0; v < positions.rows(); ++v) positions.row(v) = bent(vertex_at(model.rest, v)).transpose();
  double length = 0;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i)
    length += (bent(from + (i + 1.0) / steps * (to - from)) - bent(from + double(i) / steps * (to - from))).norm();
  EXPECT_NEAR(stretch_of(model.reinforcement.fibres[0], positions) * (to - from).norm(), length, 1e-4 * length);
}

TEST(CompileFibres, Helices) {
  for (const bool left : {false, true}) {
    RobotSpec spec = block(false);
    FibreSpec fibre = coil();
    std::get<Helix>(fibre.path).left_handed = left;
    spec.fibres = {fibre};
    const Model model = compile(spec);
    const double turn = 2 * std::numbers::pi * 3;
    EXPECT_NEAR(length_of(model.reinforcement.fibres[0]), 4.5 * std::hypot(turn, 4), 2e-4 * 4.5 * turn);
    std::size_t quarter = 0;  // the knot nearest to a quarter of a turn
    const Vec3 expected(6, 6, left ? 2 : 8);
    const auto& knots = model.reinforcement.fibres[0].knots;
    for (std::size_t k = 0; k < knots.size(); ++k)
      if ((knots[k].at(model.rest) - expected).norm() < (knots[quarter].at(model.rest) - expected).norm()) quarter = k;
    EXPECT_LT((knots[quarter].at(model.rest) - expected).norm(), 0.3);
    EXPECT_LT((knots.back().at(model.rest) - Vec3(5 + 18, 3, 5)).norm(), 1e-9);
  }
}

/// A region's elements carry it alone; another robot's do not.
TEST(CompileFibres, RegionsAndRobots) {
  RobotSpec spec = block(false);
  add_volume_region(spec.mesh, "left", [](const Vec3& p) { return p.x() < 12; });
  spec.fibres = {thread({{1, 5, 5}, {13, 5, 5}})};
  spec.fibres[0].region = "left";
  const Model model = compile(spec);
  for (const FibrePlace& place : model.reinforcement.fibres[0].places)
    for (const Index v : place.vertices) EXPECT_LE(model.rest(v, 0), 12 + 1e-9);
  Placement moved;
  moved.translation = Vec3(0, 12, 0);
  moved.rotation = Vec3(1, -1, -1).asDiagonal();
  RobotSpec one = block(false);
  one.fibres = {coil()};
  const Model pair = compile(joined({{"a", one, {}, line(3)}, {"b", one, moved, line(4)}}, {"pair.yaml", {}, {}, {}}));
  ASSERT_EQ(pair.reinforcement.fibres.size(), 2u);
  EXPECT_EQ(pair.reinforcement.fibres[1].name, "b.thread");
  const Index half = pair.rest.rows() / 2;
  for (const FibrePlace& place : pair.reinforcement.fibres[0].places)
    for (const Index v : place.vertices) EXPECT_LT(v, half);
  for (const FibrePlace& place : pair.reinforcement.fibres[1].places)
    for (const Index v : place.vertices) EXPECT_GE(v, half);
  const auto end = [&](std::size_t f, const auto& of) {
    return Vec3(of(pair.reinforcement.fibres[f].knots).at(pair.rest));
  };
  const auto first = [](const auto& knots) { return knots.front(); };
  EXPECT_LT((end(1, first) - (moved.rotation * end(0, first) + moved.translation)).norm(), 1e-9);
}

TEST(CompileFibres, TargetShapesLeaveThemOut) {
  RobotSpec spec = block_robot(block_mesh({2, 1, 1}, {20, 10, 10}));
  spec.fibres = {thread({{1, 5, 5}, {13, 5, 5}})};
  const Model model = compile(spec);
  EXPECT_TRUE(model.reinforcement.fibres.empty());
  EXPECT_NE(model.notes.back().find("fibre is left out"), std::string::npos);
}

TEST(CompileFibres, Fingerprint) {
  RobotSpec spec = block(false);
  const std::string none = fingerprint_of(compile(spec));
  spec.fibres = {coil()};
  const std::string some = fingerprint_of(compile(spec));
  spec.fibres[0].stiffness_N = 11;
  EXPECT_NE(none, some);
  EXPECT_NE(some, fingerprint_of(compile(spec)));
}

TEST(CompileFibres, Refusals) {
  RobotSpec good = block(false);
  good.fibres = {thread({{1, 5, 5}, {13, 5, 5}})};
  const auto helix = [](const std::function<void(Helix&)>& change) {
    return [change](RobotSpec& spec) {
      spec.fibres = {coil()};
      change(std::get<Helix>(spec.fibres[0].path));
    };
  };
  expect_refused(good, {{"one point",
                         [](RobotSpec& s) {
                           s.fibres = {thread({{1, 5, 5}})};
                         },
                         "robot.yaml:7: fibre 'thread' needs at least"},
                        {"no length",
                         [](RobotSpec& s) {
                           s.fibres = {thread({{1, 5, 5}, {1, 5, 5}})};
                         },
                         "between points 0 and 1"},
                        {"not finite",
                         [](RobotSpec& s) {
                           s.fibres = {thread({{1, 5, 5}, {1, 5, NAN}})};
                         },
                         "not finite"},
                        {"far",
                         [](RobotSpec& s) {
                           s.fibres = {thread({{1, 5, 5}, {13, 5, 30}})};
                         },
                         "mm from the elements that carry it"},
                        {"twice", [](RobotSpec& s) { s.fibres.push_back(s.fibres[0]); }, "two fibres 'thread'"},
                        {"soft", [](RobotSpec& s) { s.fibres[0].stiffness_N = 0; }, "needs a stiffness above 0 N"},
                        {"nowhere", [](RobotSpec& s) { s.fibres[0].region = "tip"; }, "tip"},
                        {"faces", [](RobotSpec& s) { s.fibres[0].region = "x_low"; }, "no element of the body"},
                        {"thin", helix([](Helix& h) { h.radius = 0; }), "a radius above 0"},
                        {"turns", helix([](Helix& h) { h.turns = 0; }), "turns above 0"},
                        {"endless", helix([](Helix& h) { h.turns = 1e6; }), "too many turns"},
                        {"backwards", helix([](Helix& h) { h.pitch = -1; }), "a pitch of 0 or more"},
                        {"no axis", helix([](Helix& h) { h.axis.setZero(); }), "an axis with a direction"},
                        {"on its axis", helix([](Helix& h) { h.first = h.axis; }), "begins on its axis"}});
}

}  // namespace softkin
