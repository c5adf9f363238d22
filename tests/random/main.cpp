#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "random/paths.hpp"
#include "random/runs.hpp"

/// Solves robots that nobody thought of and checks every answer by an evaluation of its own.
namespace softkin::random_robots {

namespace {

thread_local std::uint64_t current_seed = 0;

/// Names the seed that brought the program down.
void report_signal(int signal) {
  char text[64] = "softkin_random: signal ";
  std::size_t length = 23;
  const auto append = [&](std::uint64_t value) {
    char reversed[24];
    std::size_t count = 0;
    do reversed[count++] = static_cast<char>('0' + value % 10);
    while ((value /= 10) > 0);
    while (count > 0) text[length++] = reversed[--count];
  };
  append(static_cast<std::uint64_t>(signal));
  for (const char c : {' ', 'a', 't', ' ', 's', 'e', 'e', 'd', ' '}) text[length++] = c;
  append(current_seed);
  text[length++] = '\n';
  if (write(STDERR_FILENO, text, length) < 0) _exit(4);
  _exit(3);
}

struct Options {
  std::uint64_t first = 0;
  std::uint64_t count = 300;
  int threads = 1;
  std::filesystem::path folder;
  bool effort = false;
  int most = 0, max_of_99 = 0;  // iterations of a solve, and of 99 % of them; 0: as many as it takes
};

Summary run_all(const Options& options) {
  Summary summary;
  std::mutex mutex;
  std::atomic<std::uint64_t> next{0};
  auto described = std::chrono::steady_clock::now();
  const auto work = [&] {
    for (std::uint64_t i; (i = next++) < options.count;) {
      current_seed = options.first + i;
      const RunResult run = run_seed(current_seed, false, options.effort);
      const std::lock_guard lock(mutex);
      summary.add(run);
      if (run.outcome == Outcome::failed)
        std::fprintf(stderr, "seed %llu failed: %s\n", static_cast<unsigned long long>(run.seed), run.message.c_str());
      if (std::chrono::steady_clock::now() - described < std::chrono::seconds(20)) continue;
      described = std::chrono::steady_clock::now();
      std::fprintf(stderr, "%zu of %llu runs, %zu failed\n", summary.runs(),
                   static_cast<unsigned long long>(options.count), summary.failures().size());
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < options.threads; ++t) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  return summary;
}

bool takes_longer(const Summary& summary, double fraction, int most) {
  const int took = summary.iterations_of(fraction);
  if (most == 0 || took <= most) return false;
  std::fprintf(stderr, "%g %% of the solves take up to %d iterations, more than %d\n", 100 * fraction, took, most);
  return true;
}

int run(const Options& options) {
  const Summary summary = run_all(options);
  const std::string text = summary.text() + (options.effort ? summary.effort_text() : "");
  std::fputs(text.c_str(), stdout);
  if (!options.folder.empty()) {
    std::filesystem::create_directories(options.folder);
    std::ofstream(options.folder / "summary.txt") << text;
    std::ofstream(options.folder / "failures.csv") << summary.failure_table();
  }
  const bool most = takes_longer(summary, 0.99, options.max_of_99), all = takes_longer(summary, 1, options.most);
  return summary.failures().empty() && !most && !all ? 0 : 1;
}

}  // namespace

}  // namespace softkin::random_robots

int main(int argc, char** argv) {
  using namespace softkin::random_robots;
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, report_signal);
  CLI::App app("Random robots: every run ends in an answer that is confirmed, an honest status or a named error");
  Options options;
  std::uint64_t seed = 0;
  app.add_option("--first", options.first, "first seed");
  app.add_option("--count", options.count, "how many seeds");
  app.add_option("--threads", options.threads, "runs at once")->check(CLI::PositiveNumber);
  app.add_option("--out", options.folder, "folder for summary.txt and failures.csv");
  app.add_flag("--stats", options.effort, "what solves took, and why steps of their ways were not taken");
  app.add_option("--most", options.most, "fail where a solve takes more iterations");
  app.add_option("--most-of-99", options.max_of_99, "fail where more than 1 % of the solves take more iterations");
  const CLI::Option* one = app.add_option("--seed", seed, "one seed, told at length");
  bool falsify = false;
  app.add_flag("--falsify", falsify, "falsify answers: every false one must be noticed");
  bool paths = false;
  int rows = 32;
  app.add_flag("--paths", paths, "solve in one step and along a path of rows: ends that differ without a report fail");
  app.add_option("--rows", rows, "rows of a path")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  if (falsify) return count_unnoticed_lies(options.first, options.count) == 0 ? 0 : 1;
  if (paths && one->count() == 0)
    return compare_paths(options.first, options.count, rows, options.threads) == 0 ? 0 : 1;
  if (paths) return compare_path(seed, rows, true).comparison == PathComparison::differs ? 1 : 0;
  if (one->count() == 0) return run(options);
  const RunResult result = run_seed(seed, true);
  std::printf("seed %llu: %s in %.3f s %s\n", static_cast<unsigned long long>(seed), name_of(result.outcome),
              result.seconds, result.outcome == Outcome::failed ? result.message.c_str() : "");
  return result.outcome == Outcome::failed ? 1 : 0;
}
