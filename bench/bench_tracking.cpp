// Converged shapes per second along a path of 1 % actuation steps, and what bounds them.

#include <softkin/statics/statics.hpp>

#include "command_line.hpp"
#include "finger.hpp"
#include "machine.hpp"
#include "physical_parts.hpp"

namespace {

using namespace softkin;
using namespace softkin::physical;
using namespace softkin::bench;

struct Options {
  std::vector<double> sizes{5000, 45000}, quadratic_sizes{15000};
  int steps = 50, threads = 0;
  double chamber_weight = 0.05;
  double rate_of_factor = 0, rate_of_memory = 0;  // measured [flop/s, byte/s]
};

/// What a path took, per shape.
struct Path {
  int shapes = 0;
  double seconds = 0, typical = 0;  // whole path over shapes; median of a shape
  double iterations = 0, factorisations = 0;
  double degrees = 0;  // bend at its end
  double middle_ratio = 1;
  State middle;
  bool complete = true;
};

Path track(const Model& model, const std::vector<Index>& face, const Options& options) {
  const Statics statics(model);
  StaticsOptions statics_options;
  statics_options.threads = options.threads;
  statics_options.keep_history = false;
  Path path;
  Bend bend(model.rest, face);
  State state = statics.rest();
  // the first solve makes the work space
  state = statics.solve(Actuation::Constant(1, 1), state, statics_options).state;
  std::vector<double> times;
  for (int step = 1; step <= options.steps; ++step) {
    const double ratio = 1 + 0.01 * step;
    const Equilibrium found = statics.solve(Actuation::Constant(1, ratio), state, statics_options);
    if (found.report.status != Status::converged) {
      path.complete = false;
      break;
    }
    state = found.state;
    times.push_back(found.report.seconds);
    path.seconds += found.report.seconds;
    path.iterations += found.report.iterations;
    path.factorisations += found.report.factorisations;
    path.degrees = bend.follow(state.positions);
    if (step == (options.steps + 1) / 2) {
      path.middle = state;
      path.middle_ratio = ratio;
    }
  }
  path.shapes = static_cast<int>(times.size());
  if (path.shapes == 0) return path;
  path.typical = median(times);
  path.seconds /= path.shapes;
  path.iterations /= path.shapes;
  path.factorisations /= path.shapes;
  return path;
}

void print_path(const char* what, std::int64_t size, const Path& path) {
  std::printf("%9lld  %-13s %6d %9.1f %12.1f %11.1f %10.1f %10.1f %8.1f%s\n", static_cast<long long>(size), what,
              path.shapes, path.shapes > 0 ? 1 / path.seconds : 0.0, 1e3 * path.seconds, 1e3 * path.typical,
              path.iterations, path.factorisations, path.degrees, path.complete ? "" : "  not converged beyond");
  std::fflush(stdout);
}

/// Times of the parts at the path's middle, and how often a shape needs them: every factorisation assembles, factorises
/// and solves for the constraint and the step; every iteration evaluates the force, turns a step and solves once more.
void print_parts(const Model& model, const Path& path, const Options& options) {
  PhysicalParts parts(model, Actuation::Constant(1, path.middle_ratio), path.middle, options.threads);
  const PhysicalParts::Times t = parts.measure(7);
  std::printf(
      "           one call [ms]: force %.2f, stiffness %.2f, assembly %.2f, factor %.2f, solve %.2f, turn %.2f\n",
      1e3 * t.force, 1e3 * t.stiffness, 1e3 * t.assembly, 1e3 * t.factor, 1e3 * t.solve, 1e3 * t.turn);
  const double factor = path.factorisations * t.factor;
  const double solve = (path.iterations + 2 * path.factorisations) * t.solve;
  const double elements = path.factorisations * t.stiffness + (path.iterations + 1) * t.force;
  const double whole = path.seconds;
  std::printf(
      "           of a shape: factor %.0f %%, solve %.0f %%, elements %.0f %%, rest %.0f %% (calls counted, times of "
      "one call; the rest by difference)\n",
      100 * factor / whole, 100 * solve / whole, 100 * elements / whole,
      100 * (1 - (factor + solve + elements) / whole));
  const double bytes = 2 * 8 * parts.nonzeros();
  std::printf(
      "           factor: %.3g flop at %.1f GFlop/s, %.0f %% of the DGEMM rate; solve: %.3g nonzeros read twice "
      "at %.1f GB/s, %.0f %% of the bandwidth\n",
      parts.flops(), 1e-9 * parts.flops() / t.factor, 100 * parts.flops() / t.factor / options.rate_of_factor,
      parts.nonzeros(), 1e-9 * bytes / t.solve, 100 * bytes / t.solve / options.rate_of_memory);
  std::fflush(stdout);
}

int run(Options options) {
  print_machine();
  {
    Team team(options.threads);
    const Rates rates = measure_rates(team);
    options.rate_of_factor = rates.dgemm;
    options.rate_of_memory = rates.bandwidth;
    std::printf(
        "%d threads: DGEMM (Eigen) %.1f GFlop/s, dense LDL^T of softkin's fronts %.1f GFlop/s, triad %.1f GB/s\n",
        team.size(), 1e-9 * rates.dgemm, 1e-9 * rates.front, 1e-9 * rates.bandwidth);
  }
  std::printf("%9s  %-13s %6s %9s %12s %11s %10s %10s %8s\n", "body tets", "formulation", "shapes", "shapes/s",
              "a shape [ms]", "median [ms]", "iterations", "factorisat.", "bend [deg]");
  for (const double size : options.sizes) {
    const double cell = cell_for(size);
    const Mesh mesh = bellows_finger(cell);
    const std::vector<Index> face = tip_face(mesh, "finger");
    const Model physical = compile(finger_robot(mesh, FingerKind::physical, "finger"));
    const Path path = track(physical, face, options);
    print_path("physical", body_tetrahedra(cell), path);
    if (path.middle.positions.rows() > 0) print_parts(physical, path, options);
    RobotSpec spec = finger_robot(mesh, FingerKind::target_shape, "finger");
    spec.actuators[0].weight = options.chamber_weight;
    print_path("target-shape", body_tetrahedra(cell), track(compile(spec), face, options));
  }
  for (const double size : options.quadratic_sizes) {
    const double cell = cell_for(size);
    const Mesh mesh = bellows_finger(cell);
    const Model quadratic = compile(finger_robot(mesh, FingerKind::physical_quadratic, "finger"));
    const Path path = track(quadratic, tip_face(mesh, "finger"), options);
    print_path("quadratic", body_tetrahedra(cell), path);
    if (path.middle.positions.rows() > 0) print_parts(quadratic, path, options);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{
      "Converged shapes per second along a path of 1 % steps of the chamber's volume, and what bounds them.",
      "bench_tracking"};
  Options options;
  app.add_option("--sizes", options.sizes, "body tetrahedra of the fingers").split_at_commas();
  app.add_option("--quadratic-sizes", options.quadratic_sizes, "the same of order 2, physical").split_at_commas();
  app.add_option("--steps", options.steps, "of 1 %").check(within(1, 100));
  app.add_option("--threads", options.threads, "0: all").check(within(0, 256));
  app.add_option("--chamber-weight", options.chamber_weight, "w of the chamber's elements, target-shape")
      .check(positive());
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
