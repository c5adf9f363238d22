#include <softkin/statics/solver_options.hpp>

#include "command.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

struct NoOptions {};

void declare_none(CLI::App& /*command*/, NoOptions& /*options*/) {}

int print_tables(const NoOptions& /*options*/) {
  print(option_tables());
  return done;
}

}  // namespace

void add_options_command(CLI::App& app, Run& run) {
  add_command(app, run, "options", "Tuned constants of the solvers, as docs/path_tracking.md lists them", "",
              &declare_none,
              &print_tables)
      ->group("");  // hidden: scripts/option_tables.py calls it
}

}  // namespace softkin::cli
