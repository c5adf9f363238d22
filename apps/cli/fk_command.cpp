#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/io/csv.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene.hpp>
#include <softkin/io/vtk.hpp>
#include <softkin/statics/statics.hpp>

#include "command.hpp"
#include "fk_files.hpp"
#include "fk_report.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

struct FkOptions {
  std::string scene, path, output, report, image, solver = "local-global";
  std::vector<std::string> settings;
  std::vector<double> view;  // empty: the picture's default
  StaticsOptions statics;
  bool json = false, resume = false;
};

struct Step {
  Actuation actuation;
  double time = 0;
};

std::vector<std::string> actuator_names(const Model& model) {
  std::vector<std::string> names;
  for (const Actuator& actuator : model.actuators) names.push_back(actuator.name);
  return names;
}

Index actuator_index(const std::vector<std::string>& names, const std::string& name, const std::string& where) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) throw InvalidInput(where + ": no actuator '" + name + "'" + suggest_name(name, names));
  return static_cast<Index>(at - names.begin());
}

/// The scene's rest values, changed by --set NAME=RATIO.
Actuation set_actuation(const Model& model, const std::vector<std::string>& settings) {
  Actuation actuation = model.rest_actuation();
  const std::vector<std::string> names = actuator_names(model);
  for (const std::string& setting : settings) {
    const std::string where = "--set " + setting;
    const std::size_t equals = setting.find('=');
    double value = 0;
    if (equals == std::string::npos || !parse_real(std::string_view(setting).substr(equals + 1), value))
      throw InvalidInput(where + ": expected ACTUATOR=RATIO, for example --set air=1.5");
    actuation[actuator_index(names, setting.substr(0, equals), where)] = value;
  }
  check_actuation(model, actuation);
  return actuation;
}

/// One step per row; actuators without a column keep their value. A column t_s is the time in the series [s].
std::vector<Step> path_steps(const Model& model, const std::string& file, const Actuation& start) {
  const CsvTable table = read_csv(file);
  const std::vector<std::string> names = actuator_names(model);
  std::vector<Index> targets;
  for (const std::string& column : table.columns)
    targets.push_back(column == "t_s" ? -1 : actuator_index(names, column, file));
  std::vector<Step> steps;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    Step step{start, static_cast<double>(row)};
    for (std::size_t column = 0; column < targets.size(); ++column)
      (targets[column] < 0 ? step.time : step.actuation[targets[column]]) = table.rows[row][column];
    try {
      check_actuation(model, step.actuation);
    } catch (const InvalidInput& refusal) {
      throw InvalidInput({file, table.lines[row]}, refusal.what());
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

/// The steps that an interrupted run has finished: those of its report whose shapes exist and whose actuation is asked
/// for again.
std::size_t finished_steps(const Model& model, const FkOptions& options, const std::vector<Step>& steps, Json& report) {
  if (!fs::exists(options.report)) return 0;
  const Json before = Json::parse(read_file(options.report), nullptr, false);
  if (before.is_discarded() || !before.contains("steps") || before.value("scene", "") != options.scene ||
      before.value("mesh", Json()) != report["mesh"])
    throw InvalidInput({options.report}, "is not a report of this scene: --resume cannot go on from it");
  std::size_t done = 0;
  for (const Json& step : before["steps"]) {
    if (done == steps.size() || step.value("status", "") != "converged" ||
        !fs::exists(series_file(options.output, done)))
      break;
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      if (step["actuation"].value(model.actuators[a].name, 0.0) != steps[done].actuation[static_cast<Index>(a)])
        throw InvalidInput({options.report}, "step " + std::to_string(done) +
                                                 " was solved for another actuation than " + options.path +
                                                 " asks for: run without --resume");
    report["steps"].push_back(step);
    ++done;
  }
  return done;
}

void check_outputs(const FkOptions& options) {
  const auto need_folder = [](const std::string& file) {
    if (file.empty()) return;
    const fs::path folder = fs::path(file).parent_path();
    std::error_code failure;
    if (!folder.empty()) fs::create_directories(folder, failure);
    if (failure) throw InvalidInput({file}, "its folder cannot be made: " + failure.message());
  };
  const std::string form = fs::path(options.output).extension().string();
  if (!options.output.empty() && form != ".vtu" && form != ".pvd")
    throw InvalidInput("-o " + options.output + ": the output is .vtu (the last shape) or .pvd (a series)");
  if (options.resume && (options.path.empty() || form != ".pvd" || options.report.empty()))
    throw InvalidInput("--resume needs --path, --report and -o F.pvd of the run that was interrupted");
  for (const std::string& file : {options.output, options.report, options.image}) need_folder(file);
}

/// Solves the steps in order, each from the last shape, and keeps what is finished on disk.
class FkRun {
 public:
  FkRun(const Model& model, const FkOptions& options, std::vector<Step> steps)
      : model_(model), options_(options), steps_(std::move(steps)), report_(report_json(model, options.scene)) {}

  int run() {
    const Statics statics(model_);
    State state = statics.rest();
    std::size_t first = 0;
    if (options_.resume) first = finished_steps(model_, options_, steps_, report_);
    if (first > 0) {
      state.positions = read_vtu_points(series_file(options_.output, first - 1));
      say("resumed after step " + std::to_string(first - 1));
    }
    say(table_header(model_));
    bool converged = true;
    for (std::size_t i = first; i < steps_.size(); ++i) {
      Equilibrium found = solve(statics, state, i);
      if (found.report.status == Status::interrupted) {
        say("interrupted in step " + std::to_string(i) + "; " + std::to_string(i) + " finished steps are kept" +
            (i > 0 && !options_.report.empty() && series() ? ": go on with --resume" : ""));
        return not_converged;
      }
      converged = converged && found.report.status == Status::converged;
      state = std::move(found.state);
    }
    finish(state);
    return converged ? done : not_converged;
  }

 private:
  [[nodiscard]] bool series() const { return fs::path(options_.output).extension() == ".pvd"; }

  void say(const std::string& line) const {
    if (!options_.json) std::printf("%s\n", line.c_str()), std::fflush(stdout);
  }

  Equilibrium solve(const Statics& statics, const State& state, std::size_t i) {
    ProgressLine line;
    double first_step = 0;
    const auto progress = [&](const Progress& p) {
      if (p.iteration == 1) first_step = p.step_mm;
      const double share = std::log(p.step_mm / first_step) / std::log(p.tolerance_mm / first_step);
      line.show(share, "step " + std::to_string(i) + " of " + std::to_string(steps_.size()) + ", iteration " +
                           std::to_string(p.iteration) + ", moves " + number(p.step_mm, 2) + " mm, stops below " +
                           number(p.tolerance_mm, 2) + " mm");
      return !interrupted();
    };
    Equilibrium found = statics.solve(steps_[i].actuation, state, options_.statics, progress);
    line.clear();
    if (found.report.status == Status::interrupted) return found;
    report_["steps"].push_back(step_json(model_, found));
    report_["seconds"] = report_["seconds"].get<double>() + found.report.seconds;
    say(table_row(model_, i, report_["steps"].back()));
    if (series()) write_series(found.state.positions, i);
    if (!options_.report.empty()) write_file(options_.report, report_.dump(1) + "\n");
    return found;
  }

  void write_series(const Points& positions, std::size_t i) const {
    write_shape(series_file(options_.output, i), model_, positions);
    std::vector<PvdEntry> entries;
    for (std::size_t k = 0; k <= i; ++k)
      entries.push_back({steps_[k].time, series_file(options_.output, k).filename().string()});
    write_pvd(options_.output, entries);
  }

  void finish(const State& state) const {
    if (!options_.output.empty() && !series()) write_shape(options_.output, model_, state.positions);
    if (!options_.image.empty()) {
      std::string title;
      for (const auto& [name, value] : report_["steps"].back()["actuation"].items())
        title += (title.empty() ? "" : ", ") + name + " = " + number(value.get<double>(), 4);
      write_image(options_.image, model_, state.positions, options_.view, title);
    }
    if (options_.json) {
      std::printf("%s\n", report_.dump(1).c_str());
      return;
    }
    say(findings(report_["steps"].back()));
    if (!options_.output.empty()) say("shapes: " + options_.output + " (open it in ParaView)");
    if (!options_.image.empty()) say("picture: " + options_.image);
    if (!options_.report.empty()) say("report: " + options_.report);
  }

  const Model& model_;
  const FkOptions& options_;
  std::vector<Step> steps_;
  Json report_;
};

int run_fk(const FkOptions& options) {
  check_outputs(options);
  const Model model = compile(read_scene(options.scene));
  const Actuation start = set_actuation(model, options.settings);
  std::vector<Step> steps{{start, 0}};
  if (!options.path.empty()) steps = path_steps(model, options.path, start);
  if (!options.json) std::printf("%s: %s\n", options.scene.c_str(), summary(model).c_str());
  catch_interrupt();
  return FkRun(model, options, std::move(steps)).run();
}

}  // namespace

void add_fk(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("fk", "Forward kinematics: the shape under given actuation");
  const auto options = std::make_shared<FkOptions>();
  command->add_option("scene", options->scene, "Scene, YAML (docs/scene.md)")->required();
  command
      ->add_option("--set", options->settings, "ACTUATOR=RATIO (length, area or volume over that at rest); repeatable")
      ->expected(1)
      ->take_all();
  command->add_option("--path", options->path, "CSV: a column per actuator, a row per step, each solved from the last");
  command->add_option("-o,--output", options->output, "F.vtu: the last shape; F.pvd: every step, F_0000.vtu, ...");
  command->add_option("--report", options->report, "Report, JSON");
  command->add_option("--image", options->image, "Picture of the last shape, PNG");
  command->add_option("--view", options->view, "Picture: direction X Y Z from the robot to the eye")->expected(3);
  command->add_option("--solver", options->solver, "local-global: Algorithm 1 of Fang et al. 2020")
      ->check(CLI::IsMember({"local-global"}))
      ->capture_default_str();
  command
      ->add_option("--anderson", options->statics.anderson, "Steps that Anderson acceleration combines; 0: as printed")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  command
      ->add_option("--tolerance", options->statics.step_tolerance_mm,
                   "Stop below this largest move of a vertex in an iteration [mm]; 0: 8e-8 of the robot's diagonal, "
                   "the paper's 1e-5 mm on its robots")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--max-iterations", options->statics.max_iterations, "Give up after so many iterations")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--threads", options->statics.threads, "0: as many as the machine has")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--resume", options->resume, "Go on where an interrupted --path run stopped");
  command->add_flag("--json", options->json, "Print the report instead of the table");
  command->footer("Example: softkin fk examples/pneumatic_finger/pneumatic_finger.yaml --set air=1.5 -o finger.vtu");
  command->callback([options, &run] { run = [options] { return run_fk(*options); }; });
}

}  // namespace softkin::cli
