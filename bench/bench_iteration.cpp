// Time of one local/global iteration against mesh size (the paper's Fig. 17), on bars with a chamber of 120 x 25 x 25
// mm.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <softkin/statics/statics.hpp>

#include "model/block_mesh.hpp"

namespace {

using namespace softkin;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

RobotSpec finger(int across) {
  const int along = static_cast<int>(std::lround(across * 120.0 / 25));
  Mesh mesh = testing::block_mesh({along, across, across}, {120, 25, 25});
  testing::add_volume_region(mesh, "chamber", [](const Vec3& p) {
    return p.x() > 6 && p.x() < 114 && p.y() > 5 && p.y() < 20 && p.z() > 9 && p.z() < 20;
  });
  RobotSpec spec = testing::block_robot(std::move(mesh));
  ActuatorSpec air;
  air.name = "air";
  air.kind = ActuatorKind::pneumatic;
  air.region = "chamber";
  air.low = 0.5;
  air.high = 3;
  spec.actuators = {air};
  return spec;
}

/// Milliseconds per iteration: the least of several runs, each of as many iterations as take about a third of a second.
double milliseconds(const Statics& statics, int threads, bool as_printed) {
  StaticsOptions options;
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
  std::printf("%10s %12s %10s %14s %14s %14s %16s\n", "vertices", "tetrahedra", "setup [s]", "1 thread [ms]",
              "all [ms]", "Anderson [ms]", "all [us/vertex]");
  std::vector<double> log_vertices, log_times;
  for (const int across : {4, 6, 8, 12, 16, 20}) {
    const Model model = compile(finger(across));
    const double begin = now();
    const Statics statics(model);
    const double setup = now() - begin;
    const double one = milliseconds(statics, 1, true), all = milliseconds(statics, 0, true);
    const double accelerated = milliseconds(statics, 0, false);
    const auto vertices = static_cast<double>(model.rest.rows());
    std::printf("%10.0f %12zu %10.3f %14.3f %14.3f %14.3f %16.3f\n", vertices, model.tetrahedra.size(), setup, one, all,
                accelerated, 1e3 * all / vertices);
    std::fflush(stdout);
    log_vertices.push_back(std::log(vertices));
    log_times.push_back(std::log(all));
  }
  const auto n = static_cast<double>(log_times.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < log_times.size(); ++i) {
    sx += log_vertices[i];
    sy += log_times[i];
    sxx += log_vertices[i] * log_vertices[i];
    sxy += log_vertices[i] * log_times[i];
  }
  std::printf("growth: time ~ vertices^%.2f (1: linear)\n", (n * sxy - sx * sy) / (n * sxx - sx * sx));
}
