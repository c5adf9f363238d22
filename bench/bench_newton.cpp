// Time, memory and error of every solver on a finger that bends by 90, 180 and 240 degrees (the paper's Table III).

#include "command_line.hpp"
#include "newton_table.hpp"

int main(int argc, char** argv) {
  using namespace softkin::bench;
  CLI::App app{"Every solver from rest to 90, 180 and 240 degrees of bend of the tip face (the paper's Table III).",
               "bench_newton"};
  NewtonOptions options;
  options.solvers = {"local-global", "anderson", "newton", "physical", "physical-quadratic"};
  if (on_path("ccx")) options.solvers.insert(options.solvers.end(), {"calculix", "calculix-quadratic"});
  app.add_option("--sizes", options.sizes, "body tetrahedra of the fingers")->delimiter(',')->capture_default_str();
  app.add_option("--mesh", options.mesh, "this mesh instead (regions body, chamber, fixed, tip)")
      ->check(CLI::ExistingFile);
  app.add_option("--bends", options.bends, "angles [degrees], ascending")
      ->delimiter(',')
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  app.add_option("--solvers", options.solvers, "of these")
      ->delimiter(',')
      ->check(CLI::IsMember(solution_names()))
      ->capture_default_str();
  app.add_option("--repeat", options.repeat, "runs of each, of which the median is given")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--limit", options.run.limit, "longest run [s]")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--tip-error", options.run.tip_error_mm, "distance from the converged tip that counts as done [mm]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--threads", options.run.threads, "of softkin; 0: all")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app.add_option("--calculix-threads", options.calculix_threads, "of CalculiX, a row for each")
      ->delimiter(',')
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--quadratic-up-to", options.quadratic_up_to, "body tetrahedra of the largest finger of order 2")
      ->capture_default_str();
  app.add_option("--chamber-weight", options.chamber_weight, "w of the chamber's elements, target-shape")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--folder", options.folder, "where CalculiX works and its files stay; none: a temporary one");
  return run_benchmark(app, argc, argv, [&] {
    print_machine();
    std::printf(
        "Newton and local-global start at rest; done: tip within %g mm of the converged answer; limit %g s a run\n",
        options.run.tip_error_mm, options.run.limit);
    print_summary(measure_table(options), options);
    return 0;
  });
}
