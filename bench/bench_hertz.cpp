// Elastic balls pressed on a rigid plane and on each other, beside Hertz's theory: force and radius of contact by
// approach, at two meshes and three contact distances.

#include <cmath>

#include "command_line.hpp"
#include "statics/pressed_balls.hpp"

namespace {

using namespace softkin;
using softkin::testing::BallContact;
using softkin::testing::PressedBalls;

struct Options {
  std::vector<double> cells{0.06, 0.03}, distances{0.002, 0.001, 0.0005}, approaches{0.005, 0.01, 0.02};
  bool two = false;
};

void print_row(const PressedBalls& balls, double fraction) {
  const BallContact found = softkin::testing::pressed(balls);
  const softkin::testing::HertzRatios ratios = softkin::testing::beside_hertz(balls, found);
  const double radius = PressedBalls::radius;
  std::printf("%7.3f %8.4f %8.4f %9.5f %9.5f %9.5f | %7.4f %7.4f %7.4f | %7.4f %7.4f | %5d %8td %7.1f %s\n", balls.cell,
              balls.distance / radius, fraction, found.force, found.approach / radius, found.radius / radius,
              ratios.force, ratios.force_of_ball, ratios.force_of_radius, ratios.radius, ratios.rim,
              found.found.report.iterations, static_cast<std::ptrdiff_t>(found.unknowns), found.found.report.seconds,
              found.found.report.status == Status::converged ? found.found.report.remark.c_str() : "FAILED");
  std::fflush(stdout);
}

int run(const Options& options) {
  bench::print_machine();
  std::printf(
      "%s, E 1 MPa, nu 0.3, neo-Hookean; lengths over the radius; ratios to Hertz:\n"
      "  F(d)  4/3 E* sqrt(R) d^1.5\n"
      "  F(d') the same, d' = d and what a ball between two plates is stiffer by\n"
      "  F(a)  4/3 E* a^3 / R\n"
      "  a(d)  sqrt(R d), of a from the second moment of the force; rim: of a from the outermost push\n",
      options.two ? "ball on ball" : "ball on a rigid plane");
  std::printf("%7s %8s %8s %9s %9s %9s | %7s %7s %7s | %7s %7s | %5s %8s %7s\n", "cell", "distance", "asked", "force N",
              "approach", "radius", "F/F(d)", "F/F(d')", "F/F(a)", "a/a(d)", "rim", "iter.", "unknowns", "time s");
  for (const double cell : options.cells)
    for (const double distance : options.distances)
      for (const double fraction : options.approaches)
        print_row({.approach = fraction * PressedBalls::radius,
                   .distance = distance * PressedBalls::radius,
                   .cell = cell,
                   .two = options.two},
                  fraction);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace softkin::bench;
  CommandLine app("Balls in contact beside Hertz's theory", "bench_hertz");
  Options options;
  app.add_option("--cells", options.cells, "at the pole, over the radius").split_at_commas();
  app.add_option("--distances", options.distances, "of contact, over the radius").split_at_commas();
  app.add_option("--approaches", options.approaches, "over the radius").split_at_commas();
  app.add_flag("--two", options.two, "ball on ball");
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
