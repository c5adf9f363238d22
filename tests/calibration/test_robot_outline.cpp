#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <softkin/calibration/robot_problem.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/table/measured_outlines.hpp>
#include <softkin/io/table/measured_poses.hpp>
#include <softkin/model/mesh/mesh_order.hpp>

#include "calibration/arm_poses.hpp"
#include "calibration/outline_samples.hpp"

/// Numbers of a robot from its outline in pictures.

namespace softkin::calibration {

namespace {

using namespace softkin::testing;
using Eigen::Vector2d;

/// x to the right, z up: what a camera sees that looks along y.
const std::vector<GivenNumber> from_the_side{{"camera.rx", -90, "--given"}};

NumberedRobot seen_from_the_side(const Arm& arm, const std::vector<std::string>& numbers) {
  return arm.robot(numbers, from_the_side);
}

/// Returns the arm's poses, with commands scaled by `more`, with outlines and no other reading.
MeasuredPoses outlines_of(const Arm& arm, const std::vector<std::string>& numbers, double noise, unsigned seed = 1,
                          double more = 1) {
  MeasuredPoses poses = arm.poses(numbers);
  for (Actuation& command : poses.commands) command *= more;
  poses.columns.clear();
  poses.values.resize(poses.values.rows(), 0);
  show_outlines(poses, seen_from_the_side(arm, numbers), noise, seed);
  return poses;
}

const std::vector<std::string> made_outlines{"materials.body.youngs_modulus=0.2", "base.ry=4", "base.z=2"},
    fitted_to_outlines{"materials.body.youngs_modulus=0.3,0.05,2", "base.ry", "base.z"};

/// Which points of a grid of a quarter of a mm triangles cover, from (-60, -60) on, row by row.
class Covered {
 public:
  Covered(const std::vector<Triangle>& triangles, const Points& seen) : cells_(side * side) {
    for (const Triangle& t : triangles) {
      const Vector2d a = seen.row(t[0]).head<2>(), b = seen.row(t[1]).head<2>(), c = seen.row(t[2]).head<2>();
      const Vector2d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
      for (int j = at(low.y()); j <= at(high.y()) + 1; ++j)
        for (int i = at(low.x()); i <= at(high.x()) + 1; ++i) {
          const auto left_of = [&](const Vector2d& from, const Vector2d& to) {
            const Vector2d arm = Vector2d(i * step - 60, j * step - 60) - from, along = to - from;
            return along.x() * arm.y() - along.y() * arm.x() > 0;
          };
          const bool ab = left_of(a, b), bc = left_of(b, c), ca = left_of(c, a);
          if (ab == bc && bc == ca) cells_[j * side + i] = true;
        }
    }
  }

  /// What is not reached from outside is covered, too.
  void fill() {
    std::vector<bool> outside(cells_.size());
    std::vector<int> next{0};
    while (!next.empty()) {
      const int k = next.back();
      next.pop_back();
      if (k < 0 || k >= side * side || outside[std::size_t(k)] || cells_[std::size_t(k)]) continue;
      outside[std::size_t(k)] = true;
      next.insert(next.end(), {k - 1, k + 1, k - side, k + side});
    }
    for (std::size_t k = 0; k < cells_.size(); ++k) cells_[k] = !outside[k];
  }

  /// Is it near a place where what is covered ends?
  [[nodiscard]] bool ends_near(const Vector2d& place) const {
    bool any = false, all = true;
    for (int j = at(place.y()) - 1; j <= at(place.y()) + 2; ++j)
      for (int i = at(place.x()) - 1; i <= at(place.x()) + 2; ++i) any = any || is(i, j), all = all && is(i, j);
    return any && !all;
  }
  /// Points that are covered beside one that is not.
  [[nodiscard]] std::vector<Vector2d> border() const {
    std::vector<Vector2d> border;
    for (int j = 1; j + 1 < side; ++j)
      for (int i = 1; i + 1 < side; ++i)
        if (is(i, j) && !(is(i - 1, j) && is(i + 1, j) && is(i, j - 1) && is(i, j + 1)))
          border.emplace_back(i * step - 60, j * step - 60);
    return border;
  }

 private:
  static constexpr int side = 480;
  static constexpr double step = 0.25;

  [[nodiscard]] static int at(double place) { return static_cast<int>(std::floor((place + 60) / step)); }
  [[nodiscard]] bool is(int i, int j) const { return cells_[j * side + i]; }

  std::vector<bool> cells_;
};

/// A block of 120 x 10 x 10 mm wound up to a coil that is in front of itself.
std::pair<std::vector<Triangle>, Points> coil() {
  const Mesh mesh = block_mesh({48, 3, 3}, {120, 10, 10});
  Points wound(mesh.vertices.rows(), 3);
  for (Eigen::Index v = 0; v < wound.rows(); ++v) {
    const double turn = mesh.vertices(v, 0) / 15, radius = 14 + mesh.vertices(v, 2);
    wound.row(v) << radius * std::cos(turn), radius * std::sin(turn), mesh.vertices(v, 1) + 2 * turn;
  }
  return {boundary_triangles(mesh.tetrahedra, mesh.edge_nodes, mesh.prisms), wound};
}

Vector2d on_circle(double turn) {
  return {10 * std::cos(turn), 10 * std::sin(turn)};
}

}  // namespace

TEST(RobotOutline, IsThinnedEvenlyWithItsNormals) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> uneven(0.5, 1.5);
  for (const double sense : {1.0, -1.0}) {
    std::vector<Vector2d> points;
    for (double turn = 0.2; turn < 5.2; turn += 0.02 * uneven(engine)) points.push_back(on_circle(sense * turn));
    const std::vector<OutlinePoint> thinned = thinned_outline(points, 20);  // 5 of 6.28 of a circle, then a gap
    ASSERT_EQ(thinned.size(), 20u);
    for (std::size_t i = 0; i < thinned.size(); ++i) {
      EXPECT_GT(thinned[i].outward.dot(thinned[i].place.normalized()), 0.98);
      const double step = i == 0 ? 2.5 : (thinned[i].place - thinned[i - 1].place).norm();
      EXPECT_NEAR(step, 50.0 / 20, 0.5);
    }
    EXPECT_EQ(thinned_outline(points, 10000).size(), points.size());
  }
}

/// Of a block from any side it is the hull of its corners.
TEST(RobotOutline, OfABlockIsTheHullOfItsCorners) {
  const Arm arm;
  const Model model = arm.robot({}).model(Eigen::VectorXd(0));
  const SurfaceEdges surface(runs::body_surface(model).triangles);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> turn(-180, 180), place(-60, 90);
  for (int trial = 0; trial < 20; ++trial) {
    const bool straight = trial == 0;  // its sides are seen on their edges
    const auto at = [&](const char* name) { return GivenNumber{name, straight ? 0 : turn(engine), ""}; };
    const MeasuringFrame frame =
        arm.robot({}, {at("camera.rx"), at("camera.ry"), at("camera.rz")}).frame(Eigen::VectorXd(0));
    const Points seen = model.rest * frame.rotation.transpose();
    std::vector<Vector2d> corners;
    for (int c = 0; c < 8; ++c)
      corners.push_back((frame.rotation * Vec3(c & 1 ? 60 : 0, c & 2 ? 10 : 0, c & 4 ? 10 : 0)).head<2>());
    const SeenOutline outline(surface, seen);
    // in a direction the farthest place of the outline is the farthest corner
    for (int k = 0; k < 12; ++k) {
      const Vector2d path(std::cos(0.5 * k), std::sin(0.5 * k));
      double farthest = -1e9, found = -1e9;
      for (const Vector2d& corner : corners) farthest = std::max(farthest, path.dot(corner));
      for (const auto& line : outline.lines())
        for (const Vector2d& end : line) found = std::max(found, path.dot(end));
      EXPECT_NEAR(found, farthest, 1e-9) << trial;
    }
    // and beyond every place of it there is no corner
    for (int k = 0; k < 10; ++k) {
      const std::optional<OutlinePlace> nearest = outline.nearest({place(engine), place(engine)}, Vector2d(0, 0));
      ASSERT_TRUE(nearest.has_value());
      for (const Vector2d& corner : corners) EXPECT_LT(nearest->outward.dot(corner - nearest->place), 1e-9) << trial;
    }
    const std::optional<OutlinePlace> facing = outline.nearest({30, 4}, Vector2d(0, 1));
    ASSERT_TRUE(facing.has_value());
    EXPECT_GT(facing->outward.y(), 0);
  }
}

/// Everywhere and nowhere else than where what it covers ends, whatever hides behind it.
TEST(RobotOutline, IsTheOuterBorderOfWhatIsCovered) {
  const auto [triangles, wound] = coil();
  const SurfaceEdges surface(triangles);
  for (const double turn : {0.0, 25.0, 60.0, 90.0, 140.0}) {
    const MeasuringFrame frame =
        Arm().robot({}, {{"camera.rx", turn, ""}, {"camera.rz", 20 + turn, ""}}).frame(Eigen::VectorXd(0));
    const Points seen = wound * frame.rotation.transpose();
    const SeenOutline outline(surface, seen);
    Covered covered(triangles, seen);
    covered.fill();
    std::size_t within = 0, pieces = 0;
    for (const auto& [begin, end] : outline.lines())
      for (int k = 0; k < 10; ++k, ++pieces) within += !covered.ends_near(begin + (k + 0.5) / 10 * (end - begin));
    EXPECT_GT(pieces, 400u);
    EXPECT_LT(within, pieces / 20) << turn;  // at slits that are narrower than the grid
    std::size_t far = 0, all = 0;
    for (const Vector2d& place : covered.border()) {
      const std::optional<OutlinePlace> nearest = outline.nearest(place, Vector2d(0, 0));
      ASSERT_TRUE(nearest.has_value());
      far += (nearest->place - place).norm() > 0.4;
      ++all;
    }
    EXPECT_GT(all, 500u);
    EXPECT_LT(far, all / 200) << turn;  // where a piece of an edge is hidden up to its nearest place
  }
}

/// The places that were nearest held on their edges, as the derivatives have them.
TEST(RobotOutline, DistancesHaveTheirDerivatives) {
  const Arm arm;
  const std::vector<std::string> names{"materials.body.youngs_modulus=0.25",
                                       "actuators.t1.factor=0.9",
                                       "base.ry=3",
                                       "base.z=1",
                                       "camera.x=-2",
                                       "camera.rz=4"};
  const NumberedRobot robot = seen_from_the_side(arm, names);
  const MeasuredPoses poses = outlines_of(arm, {"materials.body.youngs_modulus=0.2", "base.z=-1"}, 0.3);
  RobotFitOptions options;
  options.solver.step_tolerance_mm = 1e-8;
  const FitCallback none;
  RobotProblem problem(robot, poses, options, none);
  const Eigen::VectorXd at = robot.start();
  const std::optional<RobotPoint> point = problem.solve(at, nullptr, true);
  ASSERT_TRUE(point && point->without_equilibrium == 0);
  const auto place = [](const RobotPoint& of, std::size_t pose, const OutlinePlace& held) -> Vector2d {
    const Points& all = of.equilibria[pose].state.positions;
    const Vec3 body =
        ((1 - held.fraction) * all.row(held.vertices[0]) + held.fraction * all.row(held.vertices[1])).transpose();
    return (of.frame.rotation * body + of.frame.place).head<2>();
  };
  for (Index i = 0; i < std::ssize(names); ++i) {
    const double step = 1e-3 * robot.size(i);
    Eigen::VectorXd above = at, below = at;
    above[i] += step;
    below[i] -= step;
    const auto more = problem.solve(above, &*point, false), less = problem.solve(below, &*point, false);
    double largest = 0;
    for (std::size_t pose = 0; pose < 6; ++pose) {
      ASSERT_EQ(point->outline_misses[pose].size(), 40u);
      for (std::size_t k = 0; k < 40; ++k) {
        const OutlineMiss& miss = point->outline_misses[pose][k];
        const Vector2d moved = (place(*more, pose, miss.nearest) - place(*less, pose, miss.nearest)) / (2 * step);
        const double slope = point->outline_slopes[pose](static_cast<Index>(k), i);
        EXPECT_NEAR(slope, -miss.path.dot(moved), 1e-4 * std::max(1.0, moved.norm())) << names[std::size_t(i)];
        largest = std::max(largest, std::abs(slope));
      }
    }
    EXPECT_GT(largest, 0.05) << names[std::size_t(i)];
  }
}

/// Where the nearest places are found again, distances change by their derivatives, as long as the places stay near.
TEST(RobotOutline, DerivativesHoldForDistancesFoundAnew) {
  const Arm arm;
  const NumberedRobot robot = seen_from_the_side(arm, {"materials.body.youngs_modulus=0.25", "base.ry=3"});
  const MeasuredPoses poses = outlines_of(arm, {"materials.body.youngs_modulus=0.24", "base.ry=3"}, 0.1);
  const RobotFitOptions options;
  const FitCallback none;
  RobotProblem problem(robot, poses, options, none);
  const std::optional<RobotPoint> point = problem.solve(robot.start(), nullptr, true);
  std::size_t close = 0, all = 0;
  for (Index i = 0; i < 2; ++i) {
    const double step = 1e-4 * robot.size(i);
    Eigen::VectorXd above = robot.start();
    above[i] += step;
    const auto more = problem.solve(above, &*point, false);
    for (std::size_t pose = 0; pose < 6; ++pose)
      for (std::size_t k = 0; k < 40; ++k, ++all) {
        const double change = (more->outline_misses[pose][k].off_mm - point->outline_misses[pose][k].off_mm) / step;
        const double slope = point->outline_slopes[pose](static_cast<Index>(k), i);
        close += std::abs(change - slope) < 0.02 * std::max(1.0, std::abs(slope));
      }
  }
  EXPECT_GT(static_cast<double>(close), 0.97 * static_cast<double>(all)) << close << " of " << all;
}

TEST(RobotOutline, TellsTheModulusAndTheFrame) {
  const Arm arm;
  const MeasuredPoses poses = outlines_of(arm, made_outlines, 0.3, 7, 4);
  const NumberedRobot robot = seen_from_the_side(arm, fitted_to_outlines);
  for (const Loss loss : {Loss::squares, Loss::huber}) {
    RobotFitOptions options;
    options.loss = loss;
    const RobotFit fit = fit_robot(robot, poses, options);
    ASSERT_EQ(fit.status, Status::converged) << fit.remark;
    const double made[] = {0.2, 4, 2};
    for (Index i = 0; i < 3; ++i) EXPECT_NEAR(fit.values[i], made[i], 3 * fit.deviations[i]) << i;
    EXPECT_NEAR(fit.values[0], 0.2, 0.03 * 0.2);
    EXPECT_NEAR(fit.outlines.scale_mm, 0.3, 0.09);
    EXPECT_NEAR(fit.outlines.fitted_mm.rms, 0.3, 0.06);
    EXPECT_EQ(fit.outlines.fitted_mm.readings, 240u);
    EXPECT_EQ(fit.markers_mm.readings, 0u);
    const Model model = robot.model(robot.start());
    const RobotFitReport report{robot, poses, options, fit, model};
    const std::string text = robot_fit_text(report), table = robot_fit_table(report).csv(),
                      json = robot_fit_json(report);
    EXPECT_NE(text.find("240 of 240 points of outlines count, within 3.082 mm"), std::string::npos) << text;
    EXPECT_NE(text.find("outline off by [mm]"), std::string::npos) << text;
    EXPECT_NE(table.find("kept,outline_off_mm,counts\n"), std::string::npos) << table.substr(0, 300);
    EXPECT_NE(table.find("1,2,outline1_x_mm,"), std::string::npos) << table.substr(0, 300);
    EXPECT_NE(json.find("\"counting\": 240"), std::string::npos) << json.substr(0, 3000);
    EXPECT_NE(json.find("\"camera.rx\": -90"), std::string::npos);
    EXPECT_EQ(robot_fit_plot(report).rows[0][0].series.size(), 2u) << "computed and measured";
  }
}

/// Outlines are fitted in addition to markers; a weight that hangs from the robot in some pictures is left out.
TEST(RobotOutline, LeavesOutWhatIsNotTheRobot) {
  const Arm arm;
  MeasuredPoses poses = arm.poses(made_outlines);
  poses.values.setConstant(std::nan(""));
  const NumberedRobot camera = seen_from_the_side(arm, made_outlines);
  const RobotFit markers = predict_poses(camera, poses, camera.start(), {});
  poses.values.row(0) = markers.computed.values.row(0);
  show_outlines(poses, camera, 0.1);
  poses.outlines.points[3].clear();
  for (Vector2d& point : poses.outlines.points[1])  // a weight and its thread under the tip
    if (point.x() > 45) point.y() -= 12;
  RobotFitOptions options;
  options.kept = {false, false, false, false, false, true};
  options.deviations[0] = 0.1;
  options.outlines.within_mm = 1.5;
  options.outlines.points = 60;
  const NumberedRobot robot = seen_from_the_side(arm, fitted_to_outlines);
  const RobotFit fit = fit_robot(robot, poses, options);
  ASSERT_EQ(fit.status, Status::converged) << fit.remark;
  EXPECT_NEAR(fit.values[0], 0.2, 0.02 * 0.2);
  EXPECT_NEAR(fit.values[1], 4, 0.1);
  EXPECT_NEAR(fit.values[2], 2, 0.1);
  EXPECT_TRUE(fit.outlines.poses[3].empty());
  EXPECT_EQ(fit.outlines.kept_mm.readings, 60u);
  EXPECT_LT(fit.outlines.fitted_mm.readings, 235u);
  EXPECT_GT(fit.outlines.fitted_mm.readings, 200u);
  EXPECT_EQ(fit.markers_mm.readings, 2u);
  const Model model = robot.model(robot.start());
  const std::string text = robot_fit_text({robot, poses, options, fit, model});
  EXPECT_NE(text.find(" of 60  kept aside\n"), std::string::npos) << text;
  EXPECT_NE(text.find("outlines of poses kept aside: "), std::string::npos) << text;
}

/// The shape is so wrong that most points are next to the opposite side of the robot.
TEST(RobotOutline, IsMatchedFromFarOff) {
  const Arm arm;
  const MeasuredPoses poses =
      outlines_of(arm, {"materials.body.youngs_modulus=0.15", "camera.x=20", "camera.y=-15"}, 0.2);
  const NumberedRobot robot =
      seen_from_the_side(arm, {"materials.body.youngs_modulus=0.5,0.05,2", "camera.x", "camera.y"});
  const RobotFit fit = fit_robot(robot, poses, {});
  ASSERT_EQ(fit.status, Status::converged) << fit.remark;
  EXPECT_NEAR(fit.values[0], 0.15, 0.03 * 0.15);
  EXPECT_NEAR(fit.values[1], 20, 0.2);
  EXPECT_NEAR(fit.values[2], -15, 0.2);
}

TEST(RobotOutline, IsRefusedWithAReason) {
  const Arm arm;
  const Model model = arm.robot({}).model(Eigen::VectorXd(0));
  const TemporaryFolder folder;
  const auto read = [&](const std::string& poses, const std::string& outlines) {
    std::ofstream(folder / "poses.csv") << poses;
    std::ofstream(folder / "o.csv") << outlines;
    MeasuredPoses measured = read_measured_poses(folder / "poses.csv", model, true);
    add_outlines(measured, folder / "o.csv");
    return measured;
  };
  std::string square = "picture,x_mm,y_mm\n";
  for (const char* point : {"0,0", "5,0", "10,0", "10,5", "10,10", "5,10", "0,10", "0,5", "0,0"})
    square += std::string("2,") + point + "\n";
  const MeasuredPoses two = read("t1_N,picture\n0.1,2\n0.2,\n", square);
  EXPECT_EQ(two.pictures, (std::vector<Index>{2, 0}));
  EXPECT_EQ(two.outlines.points[0].size(), 8u) << "closed by its first point";
  EXPECT_TRUE(two.outlines.points[1].empty());
  expect_refused([&] { (void)read("t1_N,tip_x_mm\n0.1,2\n", square); }, "poses.csv: no column 'picture'");
  expect_refused([&] { (void)read("t1_N,picture,tip_x_mm\n0.1,,2\n", square); }, "no pose has a picture");
  expect_refused([&] { (void)read("t1_N,picture\n0.1,\n", square); }, "every reading is missing");
  expect_refused([&] { (void)read("t1_N,picture\n0.1,2\n0.2,3\n", square); },
                 "poses.csv:3: column 'picture': there is no picture 3");
  expect_refused([&] { (void)read("t1_N,picture\n0.1,1.5\n", square); },
                 "poses.csv:2: column 'picture': expected the number");
  expect_refused([&] { (void)read("t1_N,picture\n0.1,2\n", "picture,x_mm\n2,0\n"); },
                 "o.csv:1: column 'y_mm' is missing");
  expect_refused([&] { (void)read("t1_N,picture\n0.1,2\n", "picture,x_mm,y_mm,z_mm\n2,0,0,0\n"); }, "column 'z_mm'");
  expect_refused([&] { (void)read("t1_N,picture\n0.1,2\n", "picture,x_mm,y_mm\n0,0,0\n"); },
                 "o.csv:2: column 'picture'");
  expect_refused([&] { (void)read("t1_N,picture\n0.1,2\n", "picture,x_mm,y_mm\n2,0,0\n"); },
                 "8 different ones at least");
  std::ofstream(folder / "p.csv") << "t1_N,picture\n0.1,2\n";
  expect_refused([&] { (void)read_measured_poses(folder / "p.csv", model); }, "no column is a reading");
  const MeasuredPoses bare = read_measured_poses(folder / "p.csv", model, true);
  std::ofstream(folder / "q.csv") << "t1_N,picture,tip_x_mm\n0.1,2,60\n";
  const MeasuredPoses beside = read_measured_poses(folder / "q.csv", model, true);
  expect_refused([&] { (void)fit_robot(arm.robot({"base.x"}), bare, {}); },
                 "p.csv: its poses have pictures and no other reading");
  expect_refused([&] { (void)predict_poses(arm.robot({}), bare, Eigen::VectorXd(0), {}); },
                 "p.csv: its poses have pictures and no other reading");
  RobotFitOptions options;
  options.outlines.within_mm = 2;
  expect_refused([&] { (void)fit_robot(arm.robot({"base.x"}), beside, options); }, "there is no outline");
  options.outlines.within_mm = -1;
  expect_refused([&] { (void)fit_robot(arm.robot({"base.x"}), two, options); }, "must be above 0 mm");
  options.outlines = {.points = 0};
  expect_refused([&] { (void)fit_robot(arm.robot({"base.x"}), two, options); }, "a number of points above 0");
}

TEST(GivenNumbers, AreOfTheFrameAndStay) {
  const Arm arm;
  const GivenNumber given = parse_given_number("--given", "camera.rx=-90");
  EXPECT_EQ(given.name, "camera.rx");
  EXPECT_EQ(given.value, -90);
  const NumberedRobot robot = arm.robot({"base.z"}, {given, {"base.ry", 90, ""}});
  const Eigen::VectorXd three = Eigen::VectorXd::Constant(1, 3);
  const MeasuringFrame frame = robot.frame(three);
  EXPECT_LT((frame.rotation * Vec3(0, 0, 1) - Vec3(1, 0, 0)).norm(), 1e-12) << "base.ry, and then about x";
  EXPECT_LT((frame.place - Vec3(0, 3, 0)).norm(), 1e-12) << "base.z is seen as y";
  const Points& weight = robot.model(three).loads.dead;
  EXPECT_NEAR(weight.col(0).sum(), 1100 * 6e-6 * 9.81, 1e-9)
      << "gravity turns in the robot's frame with the base alone";
  EXPECT_NEAR(weight.col(1).sum(), 0, 1e-9);
  const auto refusal = [&](const auto& act) -> std::string {
    try {
      act();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto parsed = [&](const char* text) { return refusal([&] { (void)parse_given_number("--given", text); }); };
  EXPECT_NE(parsed("materials.body.youngs_modulus=3").find("only numbers of the measuring frame"), std::string::npos);
  EXPECT_NE(parsed("base.x").find("expected NAME=VALUE"), std::string::npos);
  EXPECT_NE(parsed("base.x=far").find("expected a finite number"), std::string::npos);
  EXPECT_NE(refusal([&] {
              (void)arm.robot({"base.z"}, {{"base.z", 1, "--given"}});
            }).find("--given base.z: the number"),
            std::string::npos);
}

}  // namespace softkin::calibration
