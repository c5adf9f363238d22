// What contact costs: processor time of sweeps of the bellows finger with and without it, before anything touches and
// curled onto its own base.

#include <algorithm>
#include <ctime>

#include "command_line.hpp"
#include "finger.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

struct Options {
  double size = 15000, large = 45000, distance = 0.06, free = 1.3, curled = 3;
  int threads = 2, repeat = 3;
};

struct Outcome {
  double processor = 0, seconds = 0;
  int iterations = 0, factorisations = 0;
  bool converged = true, touched = false;
  std::vector<double> pressures;  // [kPa]
};

Model finger(double size, bool quadratic, double distance) {
  RobotSpec spec = finger_robot(bellows_finger(cell_for(size)),
                                quadratic ? FingerKind::physical_quadratic : FingerKind::physical, "finger");
  spec.materials[0].elastic = ElasticSpec{};
  spec.materials[0].elastic->youngs_modulus = 2;
  spec.materials[0].elastic->poisson_ratio = 0.45;
  if (distance > 0) {
    spec.contact.emplace();
    spec.contact->distance_mm = distance;
  }
  return compile(spec);
}

/// Solves from rest to a volume ratio of its chamber in equal steps.
Outcome sweep(const Statics& statics, double ratio, int steps, const Options& options) {
  StaticsOptions statics_options;
  statics_options.threads = options.threads;
  statics_options.keep_history = false;
  Outcome outcome;
  const std::clock_t begin = std::clock();
  State state = statics.rest();
  for (int step = 1; step <= steps && outcome.converged; ++step) {
    const Equilibrium found =
        statics.solve(Actuation::Constant(1, 1 + (ratio - 1) * step / steps), state, statics_options);
    outcome.seconds += found.report.seconds;
    outcome.iterations += found.report.iterations;
    outcome.factorisations += found.report.factorisations;
    outcome.converged = found.report.status == Status::converged;
    state = found.state;
    outcome.pressures.push_back(state.multipliers[0]);
  }
  outcome.processor = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const std::optional<ContactForces> contacts = statics.measured(state).contacts;
  outcome.touched = contacts && !contacts->pairs.empty();
  return outcome;
}

void print(const char* what, const Outcome& outcome) {
  std::printf("  %-16s %7.2f s of processor, %7.2f s, %4d iterations, %4d factorisations, %s touches%s\n", what,
              outcome.processor, outcome.seconds, outcome.iterations, outcome.factorisations,
              outcome.touched ? "something" : "nothing", outcome.converged ? "" : " NOT CONVERGED");
  std::printf("  %16s kPa in the chamber:", "");
  for (const double pressure : outcome.pressures) std::printf(" %.2f", pressure);
  std::printf("\n");
  std::fflush(stdout);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// One after the other, so that what else the machine does comes to both.
bool compare(const char* name, bool quadratic, double ratio, int steps, const Options& options) {
  std::printf("%s, ratio %g in %d step(s)\n", name, ratio, steps);
  const Model without = finger(options.size, quadratic, 0), with = finger(options.size, quadratic, options.distance);
  const Statics free(without), touching(with);
  std::vector<double> ratios;
  bool converged = true;
  for (int run = 0; run < options.repeat; ++run) {
    const Outcome first = sweep(free, ratio, steps, options), second = sweep(touching, ratio, steps, options);
    if (run == 0) print("without contact", first), print("with contact", second);
    ratios.push_back(second.processor / first.processor);
    converged = converged && first.converged && second.converged;
  }
  std::printf("  with over without: %.2f (median of %d)\n", median(ratios), options.repeat);
  std::fflush(stdout);
  return converged;
}

int run(const Options& options) {
  print_machine();
  bool converged = compare("nothing touches, linear", false, options.free, 3, options);
  converged &= compare("nothing touches, order 2", true, options.free, 3, options);
  converged &= compare("curled onto its base, linear", false, options.curled, 6, options);
  converged &= compare("curled onto its base, linear", false, options.curled, 1, options);
  if (options.large > 0) {
    std::printf("curled onto its base, linear, %g tetrahedra, ratio %g in 6 steps\n", options.large, options.curled);
    const Model large = finger(options.large, false, options.distance);
    const Outcome outcome = sweep(Statics(large), options.curled, 6, options);
    print("with contact", outcome);
    converged &= outcome.converged;
  }
  return converged ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"Processor time of the bellows finger with and without contact.", "bench_contact_cost"};
  Options options;
  app.add_option("--size", options.size, "body tetrahedra");
  app.add_option("--large", options.large, "body tetrahedra of the finger that is timed with contact alone; 0: none");
  app.add_option("--distance", options.distance, "of contact [mm]").check(positive());
  app.add_option("--free", options.free, "volume ratio at which nothing touches");
  app.add_option("--curled", options.curled, "volume ratio at which the finger lies on its base");
  app.add_option("--threads", options.threads, "0: all").check(within(0, 256));
  app.add_option("--repeat", options.repeat, "pairs of sweeps").check(within(1, 100));
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
