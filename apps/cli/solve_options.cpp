#include "solve_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/scanner.hpp>

namespace softkin::cli {

namespace {

constexpr int most_threads = 512;
constexpr int most_iterations = 1'000'000'000;

}  // namespace

CLI::Validator integer_from(std::int64_t low, std::int64_t high) {
  const auto check = [low, high](const std::string& text) -> std::string {
    std::int64_t value = 0;
    if (parse_integer(text, value) && value >= low && value <= high) return "";
    return "must be an integer from " + std::to_string(low) + " to " + std::to_string(high) + ", not " + text;
  };
  return CLI::Validator(check, "");
}

CLI::Validator finite_number(bool negative_too) {
  const auto check = [negative_too](const std::string& text) -> std::string {
    double value = 0;
    if (parse_real(text, value) && (negative_too || value >= 0)) return "";
    return std::string("must be a finite number") + (negative_too ? "" : ", 0 or more") + ", not " + text;
  };
  return CLI::Validator(check, "");
}

CLI::Validator positive_length() {
  const auto check = [](const std::string& text) -> std::string {
    double value = 0;
    if (parse_real(text, value) && value > 0) return "";
    return "must be a length > 0 in mm, not " + text;
  };
  return CLI::Validator(check, "");
}

CLI::Validator one_of(const std::vector<std::string>& names) {
  return CLI::IsMember(names).description("");
}

Solver SolveOptions::solver() const {
  return solver_name == "local-global" ? Solver::local_global : Solver::newton;
}

StaticsOptions SolveOptions::statics() const {
  StaticsOptions result;
  result.solver = solver();
  result.step_tolerance_mm = tolerance_mm;
  result.max_iterations = max_iterations;
  result.anderson = anderson.value_or(result.anderson);
  result.threads = threads;
  return result;
}

void add_scene(CLI::App& command, SolveOptions& options) {
  command.add_option("SCENE", options.scene, "Scene, YAML (docs/scene.md)")->type_name("")->required();
}

void add_force(CLI::App& command, SolveOptions& options) {
  command
      .add_option(
          "--force", options.forces,
          "NAME=FX,FY,FZ: another size and direction for the scene's\nforce of that name [N], such as a payload; "
          "physical; repeatable")
      ->type_name("N=F")
      ->expected(1)
      ->take_all();
}

void add_solver(CLI::App& command, SolveOptions& options, const std::string& tolerance) {
  const StaticsOptions defaults;
  command
      .add_option("--formulation", options.formulation,
                  "physical: elastic laws, pressures, tensions and forces;\ntarget-shape: Fang et al. 2020; default: "
                  "the scene's")
      ->type_name("NAME")
      ->check(one_of({"physical", "target-shape"}));
  command
      .add_option("--solver", options.solver_name,
                  "newton (default), or local-global: Algorithm 1 of Fang et al.\n2020, target-shape only, with the "
                  "same equilibria but slower")
      ->type_name("NAME")
      ->check(one_of({"newton", "local-global"}));
  command
      .add_option(tolerance, options.tolerance_mm,
                  "Stop when no vertex moves farther than this in an iteration\n[mm]; default: 8e-8 of the robot's "
                  "diagonal, which is the\npaper's 1e-5 mm on its robots")
      ->type_name("MM")
      ->check(finite_number(false));
  command
      .add_option("--max-iterations", options.max_iterations,
                  "Give up on a step after so many, of Newton's method or of\nAlgorithm 1 (default: " +
                      std::to_string(defaults.max_iterations) + ")")
      ->type_name("N")
      ->check(integer_from(1, most_iterations));
  command
      .add_option("--anderson", options.anderson,
                  "local-global: earlier iterations that Anderson acceleration\ncombines, 0 to 20; 0: Algorithm 1 as "
                  "printed (default: " +
                      std::to_string(defaults.anderson) + ")")
      ->type_name("N")
      ->check(integer_from(0, 20));
  command.add_option("--threads", options.threads, "0: as many as the machine has (default)")
      ->type_name("N")
      ->check(integer_from(0, most_threads));
}

void check_solver(const SolveOptions& options) {
  if (options.anderson && options.solver() != Solver::local_global)
    throw InvalidInput("--anderson accelerates Algorithm 1: it needs --solver local-global");
}

}  // namespace softkin::cli
