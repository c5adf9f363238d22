#include "solve_options.hpp"

#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/runs/page.hpp>
#include <softkin/runs/solver_options_file.hpp>
#include <thread>

#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr int max_threads = 512;
constexpr int max_iterations = 1'000'000'000;

}  // namespace

int thread_count(int requested) {
  return requested > 0 ? requested : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

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

CLI::Validator positive(const std::string& what) {
  const auto check = [what](const std::string& text) -> std::string {
    double value = 0;
    if (parse_real(text, value) && value > 0) return "";
    return "must be " + what + ", not " + text;
  };
  return CLI::Validator(check, "");
}

CLI::Validator positive_length() {
  return positive("a length > 0 in mm");
}

CLI::Validator positive_force() {
  return positive("a force > 0 in N");
}

CLI::Validator positive_ratio() {
  return positive("a volume or length > 0 over that at rest");
}

CLI::Validator positive_time() {
  return positive("a time > 0 in s");
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
  result.stable = stable;
  result.tuning = tuning;
  if (instant) result.elapsed_s = 0;
  result.deadline = deadline;
  return result;
}

void add_scene(CLI::App& command, SolveOptions& options) {
  command.add_option("SCENE", options.scene, "Scene, YAML (docs/scene.md)")->type_name("")->required();
}

namespace {

void add_changes(CLI::App& command, SolveOptions& options) {
  add_repeated(command, "--material", options.materials, "R.K=V",
               "REGION.KEY=VALUE: another number for the scene's material of\nthat region, such as "
               "body.youngs_modulus=0.8; repeatable");
  add_repeated(command, "--change", options.changes, "PATH=V",
               "Another value for anything in the scene, by its path: keys, and\nentries of lists by name, region or "
               "number, such as\nactuators.air.range.2=60 or gravity=[0, 0, -9.81]; repeatable");
}

}  // namespace

void add_force(CLI::App& command, SolveOptions& options) {
  add_repeated(command, "--force", options.forces, "N=F",
               "NAME=FX,FY,FZ: another size and direction for the scene's\nforce of that name [N], such as a payload; "
               "physical; repeatable");
  add_changes(command, options);
}

void add_turn(CLI::App& command, std::vector<std::string>& turn) {
  command
      .add_option("--turn", turn,
                  "Two markers: a column, and with a plot a curve, of how far the\nline from one to the other has "
                  "turned from rest [degrees]")
      ->type_name("FROM TO")
      ->expected(2);
}

void add_solver(CLI::App& command, SolveOptions& options, const std::string& threads) {
  StaticsOptions newton, local_global;
  local_global.solver = Solver::local_global;
  add_value(command, "--formulation", options.formulation, "NAME",
            "physical: elastic laws, pressures, tensions and forces;\ntarget-shape: Fang et al. 2020; default: "
            "the scene's",
            one_of({"physical", "target-shape"}));
  add_value(command, "--solver", options.solver_name, "NAME",
            "newton (default), or local-global: Algorithm 1 of Fang et al.\n2020, target-shape only, with the "
            "same equilibria but slower",
            one_of({"newton", "local-global"}));
  add_value(command, "--solver-tolerance", options.tolerance_mm, "MM",
            "Stop when no vertex moves farther than this in an iteration\n[mm]; default: 8e-8 of the robot's "
            "diagonal, which is the\npaper's 1e-5 mm on its robots",
            finite_number(false));
  add_value(
      command, "--max-iterations", options.max_iterations, "N",
      "Give up on a shape after so many, of Newton's method (default: " + std::to_string(newton.iteration_limit()) +
          ")\nor of Algorithm 1 (" + std::to_string(local_global.iteration_limit()) +
          "); where the path to it advances\nin steps, the limit is one of each step",
      integer_from(1, max_iterations));
  add_value(command, "--anderson", options.anderson, "N",
            "local-global: earlier iterations that Anderson acceleration\ncombines, 0 to 20; 0: Algorithm 1 as "
            "printed (default: " +
                std::to_string(newton.anderson) + ")",
            integer_from(0, 20));
  command.add_flag(
      "--stable", options.stable,
      "Physical: where an equilibrium is unstable, go along its lowest mode\nto a stable one, as the robot "
      "would when it buckles");
  command.add_flag(
      "--instant", options.instant,
      "Physical: shapes before a viscous material relaxes (default:\nrelaxed; of a path with times, t_s, at "
      "those)");
  command
      .add_option_function<std::string>(
          "--options",
          [&options](const std::string& file) {
            options.tuning = runs::read_solver_options(file);
            options.tuning_file = file;
          },
          "Other tuned constants of the solvers, by group, such as\nstep: {max_turn: 20}; docs/path_tracking.md lists "
          "them")
      ->type_name("F.yaml");
  command
      .add_option_function<double>(
          "--budget", [&options](double seconds) { stop_at(options.deadline = Deadline(seconds)); },
          "Stop after so long, with the last good shape [s]; counts from the\nstart of the command (default: never)")
      ->type_name("S")
      ->check(positive_time());
  add_value(command, "--threads", options.threads, "N", threads, integer_from(0, max_threads));
}

void add_page(CLI::App& command, std::string& page, const std::string& what) {
  const CLI::Validator check([](const std::string& file) { return runs::page_refusal(file); }, "");
  add_value(command, "--html", page, "F.html", what, check);
}

void add_run(CLI::App& command, RunOptions& options, const std::string& resume, const std::string& json) {
  add_page(command, options.page,
           "All of it as a page for a browser, one file that needs no\nnetwork; with a kinematic map (softkin map) the "
           "robot bends in it");
  command.add_flag("--resume", options.resume, resume);
  add_overwriting(command, options.may_replace);
  command.add_flag("--json", options.json, json);
}

void add_view(CLI::App& command, ShowOptions& options) {
  command
      .add_option("--view", options.view,
                  "Picture: direction X Y Z from the robot to the eye (default:\n-0.5 -1 0.45); 0 0 1 looks from above")
      ->type_name("NUMBER")
      ->expected(3)
      ->check(finite_number(true));
}

void check_extension(const std::string& option, const std::string& file,
                     const std::vector<std::pair<std::string, std::string>>& endings) {
  if (file.empty()) return;
  std::string known;
  for (const auto& [ending, what] : endings) {
    if (lower_extension(file) == ending) return;
    known += (known.empty() ? "" : " or ") + ending + (what.empty() ? "" : " (" + what + ")");
  }
  throw InvalidInput(option + " " + file + ": must end in " + known);
}

std::vector<Output> requested_outputs(const std::vector<std::pair<std::string, std::string>>& files) {
  std::vector<Output> outputs;
  for (const auto& [option, file] : files)
    if (!file.empty()) outputs.push_back({option, file});
  return outputs;
}

void leave_to_resume(std::vector<Output>& outputs, const std::filesystem::path& file) {
  for (Output& output : outputs)
    if (output.file == file) output.is_own = [](const std::filesystem::path&) { return true; };
}

void check_view(const ShowOptions& options) {
  if (options.view.empty()) return;
  if (options.image.empty()) throw InvalidInput("--view is the view of the picture: it needs --image F.png");
  if (std::hypot(options.view[0], options.view[1], options.view[2]) == 0)
    throw InvalidInput("--view 0 0 0: must be a direction, so not zero");
}

void check_solver(const SolveOptions& options) {
  if (options.anderson && options.solver() != Solver::local_global)
    throw InvalidInput("--anderson accelerates Algorithm 1: it needs --solver local-global");
}

RobotSpec requested_spec(const SolveOptions& options, std::vector<std::filesystem::path>& inputs) {
  RobotSpec spec = read_requested_scene(options, inputs);
  if (!options.tuning_file.empty()) inputs.emplace_back(options.tuning_file);
  if (spec.formulation == Formulation::physical && options.solver() == Solver::local_global)
    throw InvalidInput(
        "--solver local-global is for the target-shape formulation, and this robot is physical: leave it out, or add "
        "--formulation target-shape");
  if (spec.formulation == Formulation::target_shape && options.stable)
    throw InvalidInput(
        "--stable is for the physical formulation, and this robot is of target shapes: leave it out, or add "
        "--formulation physical");
  const auto is_viscous = [](const MaterialSpec& material) { return !material.viscosity.empty(); };
  if (options.instant && std::none_of(spec.materials.begin(), spec.materials.end(), is_viscous))
    throw InvalidInput("--instant is for viscous materials, and this robot has none: leave it out");
  return spec;
}

Model requested_robot(const SolveOptions& options, std::vector<std::filesystem::path>& inputs) {
  Model model = compile(requested_spec(options, inputs));
  for (const std::string& each : options.materials) model.notes.push_back("Changed in the scene: --material " + each);
  for (const std::string& each : options.changes) model.notes.push_back("Changed in the scene: --change " + each);
  return model;
}

InverseOptions MethodOptions::by_method() const {
  InverseOptions result = usual_options(method == "gradient" ? InverseMethod::gradient : InverseMethod::newton);
  result.tolerance_mm = tolerance_requested_mm.value_or(result.tolerance_mm);
  result.max_iterations = descents.value_or(result.max_iterations);
  return result;
}

void add_method(CLI::App& command, MethodOptions& options, const std::string& tolerance,
                const std::vector<std::pair<std::string, std::string>>& more) {
  std::string text = "newton (default), or gradient: Algorithm 2 of Fang et al. 2020\nwith central differences";
  std::vector<std::string> names{"newton", "gradient"};
  for (const auto& [name, what] : more) {
    names.push_back(name);
    text += ",\nor " + name + ": " + what;
  }
  add_value(command, "--method", options.method, "NAME", text, one_of(names));
  add_value(command, "--tolerance", options.tolerance_requested_mm, "MM",
            tolerance + " [mm] (default:\n0.001; gradient: 0.2)", positive_length());
}

void check_method(const MethodOptions& options) {
  if (options.descents && options.method != "gradient")
    throw InvalidInput("--descents are iterations of Algorithm 2: it needs --method gradient");
}

}  // namespace softkin::cli
