// A finger of a million linear tetrahedra, bent by 90 degrees: time, iterations, memory.

#include <softkin/statics/statics.hpp>

#include "child_process.hpp"
#include "command_line.hpp"
#include "finger.hpp"
#include "machine.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

struct Options {
  double size = 1e6, guide = 45000, degrees = 90, limit = 36000;
  int threads = 0;
};

/// The bend of one shape. Plain, to be sent between processes.
struct Outcome {
  int body_tetrahedra = 0, vertices = 0, solves = 0, iterations = 0, factorisations = 0;
  double ratio = 1, degrees = 0, setup = 0, solve = 0, step_mm = 0;
  bool converged = false;
};

/// Returns the ratio that bends a coarser finger by the requested angle.
double guide(const Options& options) {
  const Mesh mesh = bellows_finger(cell_for(options.guide));
  const Model model = compile(finger_robot(mesh, FingerKind::physical, "finger"));
  const std::vector<BentShape> found = find_bends(model, Statics(model), tip_face(mesh, "finger"), {options.degrees});
  if (found.empty()) throw InvalidInput("the coarser finger does not bend so far");
  return found[0].ratio;
}

/// Solves from rest to the given ratio, then in further steps of a tenth of that change until the requested bend is
/// reached.
Outcome bend(double ratio, const Options& options) {
  const double cell = cell_for(options.size);
  RobotSpec spec = finger_robot(bellows_finger(cell), FingerKind::physical, "finger");
  const std::vector<Index> face = tip_face(spec.mesh, "finger");
  Outcome outcome;
  outcome.body_tetrahedra = static_cast<int>(body_tetrahedra(cell));
  outcome.vertices = static_cast<int>(spec.mesh.vertices.rows());
  double begin = now();
  const Model model = compile(spec);
  spec = {};
  const Statics statics(model);
  outcome.setup = now() - begin;
  StaticsOptions statics_options;
  statics_options.threads = options.threads;
  statics_options.keep_history = false;
  const double end = now() + options.limit;
  const ProgressCallback progress = [&](const Progress& p) {
    std::fprintf(stderr, "iteration %d, step %.3g mm, %.0f s\n", p.iteration, p.step_mm, now() - begin);
    return now() < end;
  };
  State state = statics.rest();
  begin = now();
  for (const double fraction : {1.0, 1.1, 1.2, 1.3}) {
    outcome.ratio = 1 + fraction * (ratio - 1);
    const Equilibrium found = statics.solve(Actuation::Constant(1, outcome.ratio), state, statics_options, progress);
    ++outcome.solves;
    outcome.iterations += found.report.iterations;
    outcome.factorisations += found.report.factorisations;
    outcome.step_mm = found.report.step_mm;
    outcome.converged = found.report.status == Status::converged;
    outcome.degrees = Bend(model.rest, face).follow(found.state.positions);
    state = found.state;
    if (!outcome.converged || outcome.degrees >= options.degrees) break;
  }
  outcome.solve = now() - begin;
  return outcome;
}

int run(const Options& options) {
  print_machine();
  const Measured<double> ratio = measure<double>([&] { return guide(options); }, options.limit);
  if (!ratio.result) {
    std::printf("no ratio from the coarser finger: %s\n", ratio.end.complaint().c_str());
    return 1;
  }
  const Measured<Outcome> found = measure<Outcome>([&] { return bend(*ratio.result, options); }, 1.2 * options.limit);
  if (!found.result) {
    std::printf("not done: %s; peak memory %.0f MiB\n", found.end.complaint().c_str(), found.end.peak_mib);
    return 1;
  }
  const Outcome& o = *found.result;
  std::printf("%d body tetrahedra, %d vertices, physical, sparse LDL^T: volume ratio %.4f, bend %.1f degrees%s\n",
              o.body_tetrahedra, o.vertices, o.ratio, o.degrees, o.converged ? "" : " (not converged)");
  std::printf(
      "setup %.1f s, %d solve(s) from rest %.1f s: %d iterations (%.1f s each), %d factorisations, last step "
      "%.2g mm, peak memory %.2f GiB\n",
      o.setup, o.solves, o.solve, o.iterations, o.solve / std::max(1, o.iterations), o.factorisations, o.step_mm,
      found.end.peak_mib / 1024);
  return o.converged && o.degrees >= options.degrees ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"A finger of a million linear tetrahedra, bent by 90 degrees: time, iterations and peak memory.",
                  "bench_large"};
  Options options;
  app.add_option("--size", options.size, "body tetrahedra");
  app.add_option("--guide", options.guide, "body tetrahedra of the finger that tells the volume ratio");
  app.add_option("--bend", options.degrees, "[degrees]").check(within(1.0, 170.0));
  app.add_option("--limit", options.limit, "[s]").check(positive());
  app.add_option("--threads", options.threads, "0: all").check(within(0, 256));
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
