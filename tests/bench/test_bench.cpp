#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/mesh_check.hpp>
#include <thread>

#include "finger.hpp"
#include "machine.hpp"
#include "newton_runs.hpp"
#include "physical_parts.hpp"
#include "support/patience.hpp"
#include "support/skips.hpp"

namespace softkin::bench {
namespace {

using testing::patient;

constexpr double coarse = 4.68;  // [mm]

/// In the folder for temporary files; no other run's.
std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / (name + "_" + std::to_string(::getpid()))).string();
}

double volume_of(const Mesh& mesh, const std::string& region) {
  double volume = 0;
  for (const Region& r : mesh.regions)
    if (r.name == region)
      for (const Index t : r.tetrahedra) volume += signed_volume(mesh.vertices, mesh.tetrahedra[t]);
  return volume;
}

TEST(Finger, IsSoundAtEverySize) {
  for (const double cell : {10.0, coarse, 2.6, 1.4}) {
    const Mesh mesh = bellows_finger(cell);
    const MeshCheck check = check_mesh(mesh);
    EXPECT_TRUE(check.negative.empty() && check.degenerate.empty() && check.overlapping.empty()) << cell;
    EXPECT_TRUE(check.nonmanifold_faces.empty() && check.nonmanifold_edges.empty()) << cell;
    EXPECT_TRUE(check.nonmanifold_vertices.empty() && check.unreferenced.empty()) << cell;
    EXPECT_TRUE(check.duplicate_vertices.empty() && check.duplicate_elements.empty()) << cell;
    EXPECT_EQ(check.parts.size(), 1U) << cell;
    const Vec3 size = mesh.vertices.colwise().maxCoeff() - mesh.vertices.colwise().minCoeff();
    EXPECT_LT((size - Vec3(120, 25, 25)).norm(), 1e-9) << cell;
    EXPECT_EQ(static_cast<std::int64_t>(mesh.regions[0].tetrahedra.size()), body_tetrahedra(cell));
  }
}

TEST(Finger, HasTheSameVolumesAtEverySize) {
  const Mesh rough = bellows_finger(10), fine = bellows_finger(1.4);
  EXPECT_NEAR(volume_of(rough, "body"), volume_of(fine, "body"), 1e-6);
  EXPECT_NEAR(volume_of(rough, "chamber"), volume_of(fine, "chamber"), 1e-6);
  // the walls of the chamber enclose it
  std::vector<Triangle> walls;
  for (const Region& region : fine.regions)
    if (region.name == "cavity_wall")
      for (const Index t : region.triangles) walls.push_back(fine.triangles[t]);
  EXPECT_NEAR(enclosed_volume(fine.vertices, walls), volume_of(fine, "chamber"), 1e-6);
}

TEST(Finger, IsItsOwnMirrorImage) {
  const Mesh mesh = bellows_finger(coarse);
  const auto key = [&](Index v, double sign) {
    return std::array<long, 3>{std::lround(1e6 * mesh.vertices(v, 0)), std::lround(sign * 1e6 * mesh.vertices(v, 1)),
                               std::lround(1e6 * mesh.vertices(v, 2))};
  };
  std::map<std::array<long, 3>, Index> at;
  for (Index v = 0; v < mesh.vertices.rows(); ++v) at[key(v, 1)] = v;
  std::map<Tetrahedron, int> seen;
  for (Tetrahedron t : mesh.tetrahedra) {
    std::sort(t.begin(), t.end());
    ++seen[t];
  }
  for (Tetrahedron t : mesh.tetrahedra) {
    for (Index& v : t) {
      ASSERT_TRUE(at.contains(key(v, -1)));
      v = at[key(v, -1)];
    }
    std::sort(t.begin(), t.end());
    ASSERT_TRUE(seen.contains(t));
  }
}

TEST(Finger, ComesInTheSizesOfTheTable) {
  for (const double wanted : {5e3, 15e3, 45e3, 200e3, 1e6}) {
    const double got = static_cast<double>(body_tetrahedra(cell_for(wanted)));
    EXPECT_LT(std::abs(std::log(got / wanted)), std::log(1.3)) << wanted;
  }
}

TEST(Finger, RefusesWhatItCannotBe) {
  EXPECT_THROW((void)bellows_finger(0.1), InvalidInput);
  EXPECT_THROW((void)bellows_finger(std::nan("")), InvalidInput);
  EXPECT_THROW((void)cell_for(100), InvalidInput);
  EXPECT_THROW((void)cell_for(1e9), InvalidInput);
  Mesh mesh = bellows_finger(coarse);
  mesh.regions.erase(mesh.regions.begin());
  EXPECT_THROW((void)finger_robot(mesh, FingerKind::physical, "finger.msh"), InvalidInput);
}

TEST(Bend, FollowsATurnBeyondAHalfCircle) {
  const Mesh mesh = bellows_finger(coarse);
  Bend bend(mesh.vertices, tip_face(mesh, "finger"));
  for (double degrees = 0; degrees <= 500; degrees += 50) {
    const Mat3 turn = Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitY()).toRotationMatrix();
    const Points turned = (mesh.vertices * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -20, 7);
    EXPECT_NEAR(bend.follow(turned), degrees, 1e-9);
  }
}

TEST(Bend, IsFoundWhereThePressureOfItPutsTheTip) {
  const Mesh mesh = bellows_finger(coarse);
  RobotSpec spec = finger_robot(mesh, FingerKind::physical, "finger");
  const Model model = compile(spec);
  const std::vector<BentShape> shapes = find_bends(model, Statics(model), tip_face(mesh, "finger"), {30, 75});
  ASSERT_EQ(shapes.size(), 2U);
  EXPECT_NEAR(shapes[0].degrees, 30, 0.05);
  EXPECT_NEAR(shapes[1].degrees, 75, 0.05);
  // the same shape, commanded by its pressure instead of its volume
  spec.actuators[0].control = Control::load;
  spec.actuators[0].low = 0;
  spec.actuators[0].high = 1000;
  spec.actuators[0].rest = 0;
  const Model pressed = compile(spec);
  const Statics statics(pressed);
  const Equilibrium found = statics.solve(Actuation::Constant(1, shapes[1].pressure), statics.rest());
  ASSERT_EQ(found.report.status, Status::converged);
  EXPECT_LT((pressed.markers[0].point.at(found.state.positions) - shapes[1].tip).norm(), 1e-3);
}

TEST(Bend, SaysHowFarAFingerBends) {
  const Mesh mesh = bellows_finger(coarse);
  RobotSpec spec = finger_robot(mesh, FingerKind::physical, "finger");
  spec.actuators[0].high = 1.2;
  const Model model = compile(spec);
  EXPECT_EQ(find_bends(model, Statics(model), tip_face(mesh, "finger"), {20, 240}).size(), 1U);
}

TEST(Child, SendsBackAndMeasuresMemory) {
  const auto small = measure<double>([] { return 3.5; }, patient(20));
  ASSERT_TRUE(small.result.has_value());
  EXPECT_EQ(*small.result, 3.5);
  const auto large = measure<double>(
      [] {
        const std::vector<double> values(32 << 20, 1.0);  // 256 MiB
        return values[12345];
      },
      patient(20));
  ASSERT_TRUE(large.result.has_value());
  EXPECT_GT(large.end.peak_mib, 256);
  EXPECT_LT(large.end.peak_mib, small.end.peak_mib + 300);
  EXPECT_LT(small.end.peak_mib, 200);
}

TEST(Child, SaysHowItFailed) {
  const auto thrown = measure<int>([]() -> int { throw InvalidInput("a failure on purpose"); }, patient(20));
  EXPECT_FALSE(thrown.result.has_value());
  EXPECT_EQ(thrown.end.exit_code, 1);
  const auto late = measure<int>(
      [] {
        std::this_thread::sleep_for(std::chrono::seconds(60));
        return 1;
      },
      0.2);
  EXPECT_FALSE(late.result.has_value());
  EXPECT_TRUE(late.end.timed_out);
  EXPECT_LT(late.end.seconds, 30);
  EXPECT_EQ(run_program({"sh", "-c", "exit 7"}, ".", "", {}, patient(20)).exit_code, 7);
  EXPECT_EQ(run_program({"sh", "-c", "exit $WANTED"}, ".", "", {"WANTED=5"}, patient(20)).exit_code, 5);
  EXPECT_TRUE(on_path("sh"));
  EXPECT_FALSE(on_path("no such program"));
}

FingerSource coarse_finger() {
  FingerSource source;
  source.cell_mm = coarse;
  return source;
}

TEST(Runs, EverySolverComesWithinTheErrorAskedFor) {
  const FingerSource source = coarse_finger();
  const auto answers = find_answers(source, FingerKind::target_shape, {4}, 1, patient(60));
  ASSERT_TRUE(answers.result.has_value());
  ASSERT_EQ(answers.result->count, 1);
  const Target& target = answers.result->targets[0];
  RunOptions options;
  options.threads = 1;
  options.tip_error_mm = 1;
  const auto newton = run_newton(source, FingerKind::target_shape, target, options);
  const auto plain = run_local_global(source, target, 0, options);
  const auto accelerated = run_local_global(source, target, 6, options);
  for (const auto* run : {&newton, &plain, &accelerated}) {
    ASSERT_TRUE(run->result.has_value());
    EXPECT_TRUE(run->result->done);
    EXPECT_LE(run->result->tip_error, 1);
  }
  // what was measured is the library's iteration: after as many of its own the tip is as near
  const RobotSpec spec = source.robot(FingerKind::target_shape);
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions statics_options;
  statics_options.solver = Solver::local_global;
  statics_options.anderson = 0;
  const auto error_after = [&](int iterations) {
    statics_options.max_iterations = iterations;
    const Equilibrium found = statics.solve(Actuation::Constant(1, target.ratio), statics.rest(), statics_options);
    return (model.markers[0].point.at(found.state.positions) - Vec3(target.tip[0], target.tip[1], target.tip[2]))
        .norm();
  };
  EXPECT_LE(error_after(plain.result->iterations), 1);
  EXPECT_GT(error_after(plain.result->iterations - 1), 1);
}

TEST(Runs, TellHowFarALateSolverIs) {
  const FingerSource source = coarse_finger();
  Target target;
  target.ratio = 2;
  RunOptions options;
  options.limit = 0.3;
  const auto run = run_local_global(source, target, 0, options);
  ASSERT_TRUE(run.result.has_value());
  EXPECT_TRUE(run.result->out_of_time);
  EXPECT_FALSE(run.result->done);
  EXPECT_GT(run.result->tip_error, 1);
}

TEST(CalculixDeck, LoadsEveryWallOnce) {
  const Model model = compile(coarse_finger().robot(FingerKind::physical));
  const std::string path = temporary("softkin_bench_deck");
  CalculixTask task;
  task.pressure_kpa = 20;
  write_calculix_deck(path, model, task);
  std::ifstream file(path);
  std::size_t loads = 0;
  Vec3 force = Vec3::Zero();
  // the outward faces of C3D4, as its manual numbers them
  constexpr int faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  bool reading = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('*')) {
      reading = line == "*DLOAD";
      continue;
    }
    std::size_t element = 0;
    int face = 0;
    if (!reading || std::sscanf(line.c_str(), "%zu, P%d", &element, &face) != 2) continue;
    ++loads;
    const Tetrahedron& t = model.elements.tetrahedra[element - 1];
    const auto corner = [&](int c) { return Vec3(model.rest.row(t[faces[face - 1][c]])); };
    force += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  std::filesystem::remove(path);
  EXPECT_EQ(loads, model.actuators[0].as<ChamberDrive>()->cavity.size());
  EXPECT_LT(force.norm(), 1e-9);  // a closed surface
}

TEST(CalculixDeck, RefusesAnotherModel) {
  const Model model = compile(coarse_finger().robot(FingerKind::target_shape));
  EXPECT_THROW(write_calculix_deck("never.inp", model, {}), InvalidInput);
}

TEST(CalculixRun, AgreesWithThePhysicalFormulation) {
  SKIP_WITHOUT_PROGRAM("ccx");
  for (const FingerKind kind : {FingerKind::physical, FingerKind::physical_quadratic}) {
    const FingerSource source = coarse_finger();
    const auto answers = find_answers(source, kind, {1}, 1, patient(120));
    ASSERT_TRUE(answers.result.has_value());
    ASSERT_EQ(answers.result->count, 1);
    const std::string folder = temporary("softkin_bench_ccx");
    std::filesystem::create_directories(folder);
    RunOptions options;
    options.tip_error_mm = 0.05;
    options.limit = patient(120);
    const CalculixRun found =
        run_calculix(source, kind, *answers.result, answers.result->targets[0], folder, 1, options);
    std::filesystem::remove_all(folder);
    EXPECT_TRUE(found.run.done) << found.complaint;
    EXPECT_LE(found.run.tip_error, 0.05);
    EXPECT_GT(found.run.iterations, 1);
  }
}

TEST(Parts, HoldTheHessianThatIsFactorised) {
  const Model model = compile(coarse_finger().robot(FingerKind::physical));
  const Statics statics(model);
  const Actuation actuation = Actuation::Constant(1, 1.1);
  const Equilibrium found = statics.solve(actuation, statics.rest());
  ASSERT_EQ(found.report.status, Status::converged);
  PhysicalParts parts(model, actuation, found.state, 1);
  const Eigen::SparseMatrix<double> matrix = parts.matrix();
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(matrix.rows(), 1);
  linear::SparseLdlt factor(parts.pattern());
  (void)factor.factorise(parts.values(), 0, parts.team());
  factor.solve(x, parts.team());
  const Eigen::VectorXd left = matrix.selfadjointView<Eigen::Lower>() * x.col(0) - Eigen::VectorXd::Ones(matrix.rows());
  EXPECT_LT(left.norm(), 1e-6 * std::sqrt(static_cast<double>(matrix.rows())));
  const PhysicalParts::Times times = parts.measure(1);
  for (const double time : {times.force, times.stiffness, times.factor, times.solve, times.turn}) EXPECT_GT(time, 0);
}

TEST(Machine, MedianAndGrowth) {
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_THROW((void)median({}), InvalidInput);
  EXPECT_NEAR(growth({10, 100, 1000}, {2 * std::pow(10, 1.4), 2 * std::pow(100, 1.4), 2 * std::pow(1000, 1.4)}), 1.4,
              1e-12);
}

}  // namespace
}  // namespace softkin::bench
