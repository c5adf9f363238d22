// The patch test of contact: two blocks whose meshes do not match pressed on each other, uniformly in truth. How far
// the stress of the elements is from that, by contact distance, for both orders and two meshes.

#include "command_line.hpp"
#include "statics/pressed_blocks.hpp"

namespace {

using namespace softkin;
using softkin::testing::StackedBlocks;

struct Options {
  std::vector<double> distances{0.005, 0.0005, 0.0002, 0.00005};
  std::vector<int> cells{3, 6}, orders{1, 2};
};

void print_row(int order, int cells, double distance) {
  const StackedBlocks blocks = softkin::testing::blocks_at(distance, order == 2);
  StaticsOptions options;
  options.step_tolerance_mm = 1e-9;
  const int more = (4 * cells + 2) / 3;  // 4 on 3, 8 on 6
  const auto found = softkin::testing::unevenness_of(blocks, {cells, cells, 2}, {more, more, 2}, options);
  std::printf("%5d %3d on %-3d %9.5f %9.5f | %+10.2e %10.2e %10.2e | %5d %7.2f %s\n", order, more, cells, distance,
              distance * cells, found.force, found.largest, found.root_mean, found.report.iterations,
              found.report.seconds, found.report.status == Status::converged ? found.report.remark.c_str() : "FAILED");
  std::fflush(stdout);
}

int run(const Options& options) {
  bench::print_machine();
  std::printf(
      "two cubes, neo-Hookean, E 1 MPa, nu 0.4, each compressed by 5 %%; distance over their edge, and over a cell;\n"
      "  force   over that by hand, less 1\n"
      "  stress  von Mises' of an element over the mean one, less 1: the largest, and the root of the mean square\n");
  std::printf("%5s %8s %9s %9s | %10s %10s %10s | %5s %7s\n", "order", "cells", "distance", "of a cell", "force",
              "stress", "rms", "iter.", "time s");
  for (const int order : options.orders)
    for (const int cells : options.cells)
      for (const double distance : options.distances) print_row(order, cells, distance);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace softkin::bench;
  CommandLine app("Blocks with other meshes pressed on each other", "bench_patch");
  Options options;
  app.add_option("--distances", options.distances, "of contact, over the edge of the blocks").split_at_commas();
  app.add_option("--cells", options.cells, "of the lower block, along an edge").split_at_commas();
  app.add_option("--orders", options.orders, "of the tetrahedra").split_at_commas();
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
