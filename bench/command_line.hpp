#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>

#include "machine.hpp"

namespace softkin::bench {

inline void print_machine() {
  std::printf("%s\n", machine_text().c_str());
  std::fflush(stdout);
}

/// Parses the arguments and runs a benchmark. Exit codes: what body returns, 2 on bad usage or
/// input.
inline int run_benchmark(CLI::App& app, int argc, char** argv, const std::function<int()>& body) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return body();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
    return 2;
  }
}

}  // namespace softkin::bench
