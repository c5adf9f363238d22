// A control loop on a robot that is described in code: a beam with a cable along its top, whose tip is to follow a wave.
// Every tick solves from the shape before, a warm start, and prints in the end what a tick takes.
//
//   control_loop [TICKS [THREADS [CELLS]]]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <softkin/softkin.hpp>

namespace {

/// So many cells of 5 x 10 x 10 mm in a row, each of six tetrahedra around its diagonal.
softkin::Mesh beam(int cells) {
  softkin::Mesh mesh;
  mesh.vertices.resize(4 * (cells + 1), 3);
  for (int v = 0; v < mesh.vertices.rows(); ++v)
    mesh.vertices.row(v) << 5.0 * (v / 4), 10.0 * (v / 2 % 2), 10.0 * (v % 2);
  for (int cell = 0; cell < cells; ++cell)
    for (const auto& [first, second] : {std::pair{4, 2}, {4, 1}, {2, 4}, {2, 1}, {1, 4}, {1, 2}}) {
      const int corner = 4 * cell;  // from corner to corner along three edges
      mesh.tetrahedra.push_back({corner, corner + first, corner + first + second, corner + 7});
    }
  return mesh;
}

softkin::RobotSpec finger(int cells) {
  softkin::RobotSpec robot;
  robot.name = "beam";
  robot.formulation = softkin::Formulation::physical;
  robot.mesh = beam(cells);
  softkin::MaterialSpec rubber;
  rubber.region = "all";
  rubber.elastic.emplace();
  rubber.elastic->youngs_modulus = 1;  // MPa
  rubber.elastic->poisson_ratio = 0.45;
  robot.materials = {rubber};
  robot.fixed = {{{softkin::Box{{-1, -1, -1}, {0.1, 11, 11}}, {}}}};
  softkin::ActuatorSpec cable;
  cable.name = "cable";
  softkin::CableSpec route;
  for (int i = 0; i <= cells; ++i) route.points.push_back({softkin::Vec3(5 * i, 5, 9), {}});
  cable.drive = route;
  cable.low = 0.6;  // of its length
  cable.high = 1;
  robot.actuators = {cable};
  robot.markers = {{"tip", {softkin::Vec3(5 * cells, 5, 5), {}}}};
  return robot;
}

}  // namespace

int main(int argc, char** argv) try {
  const int ticks = argc > 1 ? std::atoi(argv[1]) : 500;
  const int cells = argc > 3 ? std::atoi(argv[3]) : 8;
  softkin::StaticsOptions options;
  options.threads = argc > 2 ? std::atoi(argv[2]) : 0;
  options.keep_history = false;

  // `statics` keeps its threads, factors and memory from tick to tick: make one, and let it live
  const softkin::Model model = softkin::compile(finger(cells));
  const softkin::Statics statics(model);
  softkin::Actuation command = model.rest_actuation();
  softkin::Equilibrium now = statics.solve(command, statics.rest(), options);
  const auto tip = [&] { return model.markers[0].at(now.state.positions).z(); };
  const double rest = tip();

  std::vector<double> times;
  double farthest = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    const auto begin = std::chrono::steady_clock::now();
    const double wanted = rest + 2.5 * (1 - std::cos(0.02 * tick));  // mm, up to 5 and back
    // how the tip answers to the cable here, from the factor that the last solve left behind
    const softkin::Sensitivity sensitivity = statics.sensitivity(now.state, options);
    const double slope = softkin::jacobian(model, now.state.positions, sensitivity, {0})(2, 0);
    if (slope != 0)
      command[0] = std::clamp(command[0] + (wanted - tip()) / slope, model.actuators[0].low, model.actuators[0].high);
    now = statics.solve(command, now.state, options);
    if (now.report.status != softkin::Status::converged) {
      std::printf("tick %d: %s: %s\n", tick, softkin::name_of(now.report.status), now.report.remark.c_str());
      return 1;
    }
    times.push_back(1e6 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    farthest = std::max(farthest, std::abs(tip() - wanted));
  }
  std::sort(times.begin(), times.end());
  std::printf("%zu tetrahedra, %d ticks: median %.0f us, slowest %.0f us; the tip was at most %.3f mm off\n",
              model.elements.tetrahedra.size(), ticks, times[times.size() / 2], times.back(), farthest);
  return 0;
} catch (const softkin::InvalidInput& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
