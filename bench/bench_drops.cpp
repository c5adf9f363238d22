// Random pairs of small bodies pressed onto each other, in one step or in several: whether any shape that comes back
// has surfaces that cross, decided exactly, and how the solves end.

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "command_line.hpp"
#include "statics/pressed_drops.hpp"

namespace {

using namespace softkin;
using softkin::testing::PressedDrop;

struct Options {
  std::uint64_t first = 0, count = 2000;
  int threads = 1, steps = 0;  // steps: 0: one in drops of even seeds, three in others
  bool verbose = false;
};

const char* word_for(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::limit:
      return "limit";
    case Status::interrupted:
      return "interrupted";
    default:
      return "not converged";
  }
}

struct Tally {
  std::map<std::string, std::size_t> statuses, remarks, refusals;
  std::size_t shapes = 0, crossed = 0;
  double seconds = 0, longest = 0;  // of solves
  std::uint64_t slowest = 0;

  void add(std::uint64_t seed, const PressedDrop& run, bool verbose) {
    if (!run.refusal.empty()) ++refusals[run.refusal.substr(0, run.refusal.find(" at ("))];
    for (const PressedDrop::Shape& shape : run.shapes) {
      const SolveReport& report = shape.report;
      ++shapes;
      ++statuses[word_for(report.status)];
      if (report.status != Status::converged) ++remarks[report.remark.substr(0, 60)];
      seconds += report.seconds;
      if (report.seconds > longest) longest = report.seconds, slowest = seed;
      if (shape.crossings > 0) {
        ++crossed;
        std::printf("seed %llu: %zu crossings, %s\n", static_cast<unsigned long long>(seed), shape.crossings,
                    word_for(report.status));
      }
      if (verbose)
        std::printf("seed %llu: %s, reached %.4f, %d iterations, %d equilibria, %.2f s, %zu elements %s\n",
                    static_cast<unsigned long long>(seed), word_for(report.status), report.reached, report.iterations,
                    report.continuation_steps, report.seconds, run.tetrahedra, report.remark.c_str());
    }
    std::fflush(stdout);
  }
  void print() const {
    const auto list = [](const char* title, const std::map<std::string, std::size_t>& counts) {
      for (const auto& [name, count] : counts) std::printf("%s %-70s %zu\n", title, name.c_str(), count);
    };
    list("status ", statuses);
    list("remark ", remarks);
    list("refused", refusals);
    std::printf("shapes %zu, with crossings %zu; solves took %.1f s, the longest %.2f s (seed %llu)\n", shapes, crossed,
                seconds, longest, static_cast<unsigned long long>(slowest));
  }
};

int run(const Options& options) {
  bench::print_machine();
  const auto begin = std::chrono::steady_clock::now();
  Tally tally;
  std::mutex mutex;
  std::atomic<std::uint64_t> next{0};
  const auto work = [&] {
    for (std::uint64_t i; (i = next++) < options.count;) {
      const std::uint64_t seed = options.first + i;
      const int steps = options.steps > 0 ? options.steps : seed % 2 == 0 ? 1 : 3;
      const PressedDrop done = softkin::testing::press_drop(seed, steps);
      const std::lock_guard lock(mutex);
      tally.add(seed, done, options.verbose);
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < options.threads; ++t) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  tally.print();
  std::printf("%llu drops in %.1f s\n", static_cast<unsigned long long>(options.count),
              std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  return tally.crossed == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace softkin::bench;
  CommandLine app("Random drops: no shape that comes back has surfaces that cross", "bench_drops");
  Options options;
  app.add_option("--first", options.first, "first seed");
  app.add_option("--count", options.count, "how many seeds");
  app.add_option("--threads", options.threads, "drops at once").check(positive());
  app.add_option("--steps", options.steps, "per drop; 0: 1 in those of even seeds, 3 in others").check(not_negative());
  app.add_flag("--verbose", options.verbose, "a line for every shape");
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
