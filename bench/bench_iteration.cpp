// Time of one local/global iteration against mesh size (the paper's Fig. 17), on bars with a chamber of 120 x 25 x 25
// mm.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/supports/global_step.hpp>
#include <softkin/statics/target_shape/system.hpp>

#include "machine.hpp"
#include "model/block_mesh.hpp"

namespace {

using namespace softkin;
using namespace softkin::supports;
using namespace softkin::target_shape;
using bench::growth;
using bench::now;

RobotSpec finger(int across) {
  const int along = static_cast<int>(std::lround(across * 120.0 / 25));
  Mesh mesh = testing::block_mesh({along, across, across}, {120, 25, 25});
  testing::add_volume_region(mesh, "chamber", [](const Vec3& p) {
    return p.x() > 6 && p.x() < 114 && p.y() > 5 && p.y() < 20 && p.z() > 9 && p.z() < 20;
  });
  RobotSpec spec = testing::block_robot(std::move(mesh));
  ActuatorSpec air;
  air.name = "air";
  air.drive = PneumaticSpec{.region = "chamber"};
  air.low = 0.5;
  air.high = 3;
  spec.actuators = {air};
  return spec;
}

/// Milliseconds of the local step (rotations, target shapes, assembly) and of the global one (triangular solves), on
/// one thread: the least of several.
std::pair<double, double> parts(const Model& model) {
  const target_shape::System system(model);
  const GlobalStep global(model, system.global_matrix());
  target_shape::System::Scratch scratch = system.make_scratch();
  Points positions = model.rest;
  const Actuation actuation = Actuation::Constant(1, 1.5);
  std::vector<Pose> poses = global.project(actuation, positions);
  Team alone(1);
  double local = 1e9, solve = 1e9;
  for (int run = 0; run < 30; ++run) {
    const double begin = now();
    system.local_step(actuation, positions, scratch, alone);
    const double middle = now();
    global.step(scratch.residual, positions, poses, alone);
    local = std::min(local, 1e3 * (middle - begin));
    solve = std::min(solve, 1e3 * (now() - middle));
  }
  return {local, solve};
}

/// Milliseconds per iteration: the least of several runs, each of as many iterations as take about a third of a second.
double milliseconds(const Statics& statics, int threads, bool as_printed) {
  StaticsOptions options;
  options.solver = Solver::local_global;
  options.threads = threads;
  options.anderson = as_printed ? 0 : 6;
  options.keep_history = false;
  options.step_tolerance_mm = 1e-14;
  options.max_iterations = 5;
  const Actuation actuation = Actuation::Constant(1, 1.5);
  State state = statics.solve(actuation, statics.rest(), options).state;
  double least = 1e9;
  for (int run = 0; run < 7; ++run) {
    const double begin = now();
    const SolveReport report = statics.solve(actuation, state, options).report;
    const double each = (now() - begin) / report.iterations;
    least = std::min(least, each);
    options.max_iterations = std::clamp(static_cast<int>(0.3 / each), 10, 5000);
  }
  return 1e3 * least;
}

}  // namespace

int main() {
  std::printf(
      "Time per local/global iteration (Algorithm 1; Fig. 17): one chamber, 120 x 25 x 25 mm, body R_omega = 1\n");
  std::printf("%9s %11s %10s | %12s %13s %10s | %16s %14s\n", "vertices", "tetrahedra", "setup [s]", "local [ms]",
              "global [ms]", "both [ms]", "all threads [ms]", "Anderson [ms]");
  std::vector<double> sizes, locals, globals, whole;
  for (const int across : {4, 6, 8, 12, 16, 20}) {
    const Model model = compile(finger(across));
    const double begin = now();
    const Statics statics(model);
    const double setup = now() - begin;
    const auto [local, global] = parts(model);
    const double one = milliseconds(statics, 1, true), all = milliseconds(statics, 0, true);
    const double accelerated = milliseconds(statics, 0, false);
    sizes.push_back(static_cast<double>(model.rest.rows()));
    std::printf("%9.0f %11zu %10.3f | %12.3f %13.3f %10.3f | %16.3f %14.3f\n", sizes.back(),
                model.elements.tetrahedra.size(), setup, local, global, one, all, accelerated);
    std::fflush(stdout);
    locals.push_back(local);
    globals.push_back(global);
    whole.push_back(all);
  }
  std::printf("growth with the vertices (1: linear): local step %.2f, global step %.2f, all threads %.2f\n",
              growth(sizes, locals), growth(sizes, globals), growth(sizes, whole));
}
