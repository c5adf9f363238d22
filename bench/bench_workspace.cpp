// What a sample of a workspace costs when it starts from its neighbour, over what it costs from rest.

#include <time.h>

#include <cmath>
#include <softkin/io/scene/scene.hpp>
#include <softkin/kinematics/workspace.hpp>

#include "command_line.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

struct Options {
  std::string scene = "examples/three_tendon_finger/three_tendon_finger.yaml";
  std::string sampling = "grid";
  Index samples = 3375, groups = 4;
};

/// Of this thread [s]: what else the machine does shows less in it.
double processor_time() {
  timespec time = {};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Cost {
  Index samples = 0, converged = 0;
  std::int64_t iterations = 0;
  double seconds = 0, slowest = 0;

  void add(Status status, int its, double time) {
    ++samples;
    converged += status == Status::converged ? 1 : 0;
    iterations += its;
    seconds += time;
    slowest = std::max(slowest, time);
  }
};

void print_cost(const char* what, const Cost& cost) {
  std::printf("%-22s %8d %10d %12.1f %12.1f %12.1f\n", what, cost.samples, cost.converged,
              static_cast<double>(cost.iterations) / cost.samples, 1e3 * cost.seconds / cost.samples,
              1e3 * cost.slowest);
  std::fflush(stdout);
}

/// How far two equilibria of a sample are apart: both searches ended in the same one.
double distance(const Model& model, const WorkspaceSample& sample, const Equilibrium& cold) {
  if (sample.status != Status::converged || cold.report.status != Status::converged) return 0;
  double farthest = 0;
  for (std::size_t p = 0; p < model.markers.size(); ++p)
    farthest = std::max(farthest,
                        (sample.markers.row(p).transpose() - model.markers[p].point.at(cold.state.positions)).norm());
  return farthest;
}

int measure(const Options& options) {
  print_machine();
  const Model model = compile(read_scene(options.scene));
  const Statics statics(model);
  SamplingOptions sampling;
  sampling.kind = options.sampling == "grid"    ? Sampling::grid
                  : options.sampling == "sobol" ? Sampling::sobol
                                                : Sampling::random;
  sampling.samples = sampling.kind == Sampling::grid
                         ? static_cast<Index>(std::llround(
                               std::pow(nearest_grid(model, options.samples), varied_actuators(model).size())))
                         : options.samples;
  const WorkspacePlan plan = plan_workspace(model, sampling);
  StaticsOptions alone;
  alone.threads = 1;
  alone.reuse_factor = false;
  alone.keep_history = false;
  (void)statics.solve(plan.actuations.row(0), statics.rest(), alone);  // makes the work space
  Cost first, next, grouped, cold;
  double apart = 0;
  const Index all = plan.groups.size(), count = std::min(options.groups, all);
  for (Index g = 0; g < count; ++g) {
    GroupTask task{static_cast<Index>(static_cast<std::int64_t>(g) * all / count), {}};
    task.known.resize(plan.groups[task.group].size());
    std::vector<WorkspaceSample> samples;
    double start = processor_time();
    (void)solve_group(statics, plan, {}, task, [&](const WorkspaceSample& sample) {
      const double time = processor_time() - start;
      (samples.empty() ? first : next).add(sample.status, sample.iterations, time);
      grouped.add(sample.status, sample.iterations, time);
      samples.push_back(sample);
      start = processor_time();
    });
    start = processor_time();
    for (const WorkspaceSample& sample : samples) {
      const Equilibrium from_rest = statics.solve(sample.actuation, statics.rest(), alone);
      cold.add(from_rest.report.status, from_rest.report.iterations, processor_time() - start);
      start = processor_time();
      apart = std::max(apart, distance(model, sample, from_rest));
    }
  }
  std::printf("%s: %d samples (%s), %d groups of %d; processor time of one thread\n", options.scene.c_str(),
              plan.samples(), options.sampling.c_str(), all, group_size(plan.samples()));
  std::printf("%-22s %8s %10s %12s %12s %12s\n", "", "samples", "converged", "iterations", "mean [ms]", "slowest [ms]");
  print_cost("from rest", cold);
  print_cost("in groups", grouped);
  print_cost("  first of a group", first);
  if (next.samples > 0) print_cost("  predicted from it", next);
  std::printf("markers differ by at most %.1e mm\n", apart);
  std::printf("cost in groups over cost from rest: %.3f\n", grouped.seconds / cold.seconds);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"Cost of a sample of a workspace, over that of a solve from rest", "bench_workspace"};
  Options options;
  app.add_option("--scene", options.scene);
  app.add_option("--samples", options.samples);
  app.add_option("--sampling", options.sampling).check(one_of({"grid", "sobol", "random"}));
  app.add_option("--groups", options.groups).check(positive());
  return run_benchmark(app, argc, argv, [&] { return measure(options); });
}
