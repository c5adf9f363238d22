#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/runs/page.hpp>
#include <softkin/runs/plots.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/run_tables.hpp>
#include <softkin/runs/shape_files.hpp>
#include <softkin/runs/strain_plot.hpp>

#include "command.hpp"
#include "map_use.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;
using runs::StepRecord;

namespace {

/// What the user asks of `softkin fk`. An empty file name: not given.
struct FkOptions : SolveOptions, RunOptions, MapUse {
  std::string path, start;
  std::string output, report, trace, strains;
  ShowOptions show;
  std::vector<std::string> settings;  // ACTUATOR=VALUE
  std::vector<std::string> turn;      // two markers
  double beyond = 0;                  // volume or length over that at rest; 0: not given
  bool as_published = false;

  [[nodiscard]] bool series() const { return lower_extension(output) == ".pvd"; }
  /// The files to write; a path has so many steps.
  [[nodiscard]] std::vector<Output> outputs(std::size_t steps) const {
    std::vector<Output> outputs = requested_outputs({{"--output", output}});
    if (series()) outputs.back().shapes = steps;
    for (Output& each : requested_outputs({{"--report", report},
                                           {"--trace", trace},
                                           {"--image", show.image},
                                           {"--plot", show.plot},
                                           {"--strains", strains},
                                           {"--html", page}}))
      outputs.push_back(std::move(each));
    return outputs;
  }
};

void add_options(CLI::App& command, FkOptions& options) {
  add_scene(command, options);
  add_value(command, "--path", options.path, "F.csv",
            "A column per actuator (air; with a load's unit if you like:\nair_kPa), a row per step, each step solved "
            "from the last; with a curve\nof the actuator also air_kPa (gauge), air_kPa_abs, skin_kV; a\ncolumn t_s is "
            "the time in the series [s]");
  add_value(command, "-o,--output", options.output, "F",
            "F.vtu: the last shape; F.pvd: every step, as F_0000.vtu, ...");
  add_value(command, "--report", options.report, "F.json", "All numbers of all steps, with their strain histograms");
  add_value(command, "--trace", options.trace, "F.csv",
            "Each step of the path to each shape as it was tried: its cost,\nand why it was rejected; physical");
  add_value(command, "--image", options.show.image, "F.png", "Picture of the last shape");
  add_value(command, "--plot", options.show.plot, "F.svg",
            "With --path: commands, markers, pressures and tensions (under\npressure control volumes) over the steps, "
            "and the markers' trajectories");
  add_value(
      command, "--strains", options.strains, "F.svg",
      "Histograms of the body's strains, a panel a step (twelve at most),\nwith the linear ranges of its materials");
  add_turn(command, options.turn);
  add_repeated(command, "--set", options.settings, "A=V",
               "ACTUATOR=VALUE: length, area or volume over that at rest\n[-] (air=1.5), or its load where it is "
               "controlled by that (air=50,\nair=50kPa, tendon=3N), or by its curve (air=50kPa, "
               "air=150kPa_abs,\nair=50kPa:unloading, skin=2.5kV); repeatable; other actuators\nrest");
  add_value(command, "--start", options.start, "F.vtu",
            "Begin at a shape that softkin wrote instead of at rest, such as\none that was stopped before its end");
  add_value(
      command, "--beyond", options.beyond, "RATIO",
      "Where a pressure or tension comes to its maximum, go on beyond\nit, where it falls, to this volume or length "
      "over that at rest;\nphysical (default: end at the maximum)",
      positive_ratio());
  command.add_flag(
      "--as-published", options.as_published,
      "local-global: stop where the program of the paper's authors does,\nfrom the tenth iteration on when "
      "no marker moves by 0.032 mm,\nwithout acceleration and far from the equilibrium");
  add_map_use(command, options);
  add_force(command, options);
  add_view(command, options.show);
  add_solver(command, options);
  add_run(command, options, "Go on where the same command was interrupted; needs --path,\n--report and -o F.pvd",
          "Print the report instead of the table");
}

void check_as_published(const FkOptions& options) {
  if (!options.as_published) return;
  if (options.solver() != Solver::local_global)
    throw InvalidInput("--as-published stops Algorithm 1: it needs --solver local-global");
  if (options.anderson.value_or(0) > 0)
    throw InvalidInput("--as-published is Algorithm 1 without acceleration: leave --anderson out");
  if (options.tolerance_mm > 0)
    throw InvalidInput("--as-published has a tolerance of its own: leave --solver-tolerance out");
  if (!options.map.empty()) throw InvalidInput("--as-published is for the solver, not for a map: leave --map out");
}

void check_usage(const FkOptions& options) {
  check_extension("--output", options.output, {{".vtu", "the last shape"}, {".pvd", "every step"}});
  check_extension("--start", options.start, {{".vtu", "a shape of softkin's"}});
  check_extension("--report", options.report, {{".json", ""}});
  check_extension("--trace", options.trace, {{".csv", ""}});
  check_extension("--image", options.show.image, {{".png", ""}});
  check_extension("--plot", options.show.plot, {{".svg", ""}});
  check_extension("--strains", options.strains, {{".svg", ""}});
  if (!options.show.plot.empty() && options.path.empty())
    throw InvalidInput("--plot draws the steps of a path: it needs --path F.csv");
  check_view(options.show);
  check_solver(options);
  check_as_published(options);
  if (options.resume && (options.path.empty() || !options.series() || options.report.empty()))
    throw InvalidInput("--resume needs the --path, --report and --output F.pvd of the run that was interrupted");
}

class FkRun {
 public:
  FkRun(const Model& model, const runs::Answers& answers, const FkOptions& options,
        const std::vector<ActuationStep>& steps, State start, const runs::UsedStart* used)
      : model_(model),
        answers_(answers),
        options_(options),
        job_(answers.statics(), steps, options.path, solving(options), std::move(start)),
        run_(model, job_, {options.report, options.series() ? options.output : ""},
             runs::report_head(model, options.scene, solving(options), answers.map(), used), {}),
        page_(options.page, model, runs::kept_command()),
        line_(runs::read_marker_line(model, options.turn)),
        turn_(model, line_),
        table_(runs::table_of_steps(model, steps.size(), line_)) {
    page_.bend_by(answers.map_data());
    page_.watch(run_, &answers.statics());
  }

  int run() {
    if (options_.resume) resume_run(run_, options_.outputs(run_.size()), "step", options_.json);
    turn_.catch_up(run_);
    const std::size_t first = run_.done();
    EquilibriumProgress fraction;
    const runs::Advance end = advance_run(
        run_, table_, "step", options_.json,
        [&](RunProgress& line, const Progress& p) { line.show(EquilibriumProgress::text(p), fraction.fraction(p)); },
        [&] {
          traces_.push_back(run_.last().trace);
          return runs::row_of(model_, run_.done() - 1, run_.last(), turn_.next(run_.last()));
        });
    if (run_.stopped()) traces_.push_back(run_.stopped()->record.trace);
    finish();
    if (end != runs::Advance::made) return stopped();
    if (run_.done() > first) say_findings();
    return judge();
  }

 private:
  static StaticsOptions solving(const FkOptions& options) {
    StaticsOptions statics = options.statics();
    statics.trace = !options.trace.empty();
    statics.beyond = options.beyond;
    statics.as_published = options.as_published;
    if (options.as_published) statics.anderson = 0;
    return statics;
  }

  void say(const std::string& line) const {
    if (!options_.json) print(line + "\n");
  }

  /// Writes the report and the files that show the last step, or the shape on its path where it was stopped.
  void finish() {
    run_.finish();
    const auto* stopped = run_.stopped();
    if (stopped)
      show(stopped->record, stopped->state, stopped->deformation);
    else if (run_.done() > 0)
      show(run_.last(), run_.last_state(), run_.last_deformation());
    if (run_.done() > 0) {
      if (!options_.show.plot.empty()) write_plot();
      if (!options_.strains.empty()) write_strains();
      page_.write();
    }
    if (!options_.trace.empty()) write_file(options_.trace, runs::table_of_traces(traces_).csv());
    if (options_.json) show_report(run_);
  }

  void write_plot() {
    std::vector<StepRecord> steps;
    run_.log().each([&](std::size_t, StepRecord step) {
      step.history = {};  // most of a record, and not drawn
      step.strain = {};
      steps.push_back(std::move(step));
    });
    write_svg(options_.show.plot, runs::plot_of_steps(model_, steps, plot_title(), line_));
  }

  void write_strains() {
    std::vector<StepRecord> steps;
    run_.log().each([&](std::size_t, StepRecord step) {
      step.history = {};
      steps.push_back(std::move(step));
    });
    write_svg(options_.strains, runs::plot_of_strains(model_, steps, plot_title()));
  }

  [[nodiscard]] std::string plot_title() const {
    return runs::plot_title(model_, options_.scene) + ", " +
           (answers_.by_map_alone() ? options_.map : options_.solver_name);
  }

  void show(const StepRecord& step, const State& state, const ElementDeformation& deformation) const {
    if (!options_.output.empty() && !options_.series())
      runs::write_shape(options_.output, model_, state, deformation, step.status == Status::converged);
    if (!options_.show.image.empty())
      runs::write_image(options_.show.image, model_, state.positions, options_.show.view, image_title(step));
  }

  [[nodiscard]] std::string image_title(const StepRecord& step) const {
    const std::string title = runs::commands_title(model_, step.actuation);
    const std::string status = name_of(step.status);
    if (step.status == Status::converged) return title;
    return title + (title.empty() ? status : ": " + status);
  }

  void say_findings() {
    say(findings_text(model_, run_.last()));
    if (options_.as_published)
      say("stopped as published: no marker moved by " + number(PublishedStop::move_mm) +
          " mm in the last iteration; this is no equilibrium");
    if (!options_.output.empty()) say("shapes: " + options_.output + " (open it in ParaView)");
    if (!options_.show.image.empty()) say("picture: " + options_.show.image);
    if (!options_.show.plot.empty()) say("plot: " + options_.show.plot);
    if (!options_.strains.empty()) say("strains: " + options_.strains);
    if (!options_.report.empty()) say("report: " + options_.report);
    if (!options_.trace.empty()) say("trace: " + options_.trace);
    if (!options_.page.empty()) say(page_.reported());
  }

  [[nodiscard]] int stopped() const {
    const bool files = !options_.outputs(run_.size()).empty();
    const bool resumable = options_.series() && !options_.report.empty() && !options_.path.empty();
    Stopped reported{run_.done(), run_.size(), "step", files ? "the files that were requested" : "", resumable};
    if (run_.stopped()) reported.record = &run_.stopped()->record;
    if (run_.stopped() && !options_.output.empty())
      reported.shape = options_.series() ? stopped_file(options_.output).string() : options_.output;
    return report_stopped(reported);
  }

  [[nodiscard]] int judge() {
    struct Ended {
      std::vector<std::size_t> numbers;
      StepRecord last;
    };
    std::map<Status, Ended> all;
    OverlapTally overlaps(model_);
    std::vector<std::size_t> unstable;
    run_.log().each([&](std::size_t number, const StepRecord& step) {
      if (number + 1 < run_.done()) {  // the findings report those of the last one
        overlaps.add(number, step);
        if (step.physical.unstable_modes > 0) unstable.push_back(number);
      }
      if (step.status == Status::converged) return;
      all[step.status].numbers.push_back(number);
      all[step.status].last = step;
    });
    if (!unstable.empty()) say(unstable_text("step", unstable));
    if (const std::string text = overlaps.text("step"); !text.empty()) say(text);
    for (const auto& [status, ended] : all) complain(status, ended.numbers, ended.last);
    return all.empty() ? done : not_converged;
  }

  /// Lists the steps that ended with a status, and how the last of them ended.
  void complain(Status status, const std::vector<std::size_t>& numbers, const StepRecord& last) const {
    std::string text = name_of(status);
    if (run_.size() > 1) text += (numbers.size() == 1 ? " in step " : " in steps ") + list_text(numbers);
    text += numbers.size() > 1 ? "; in the last of them " : ": ";
    std::fprintf(stderr, "softkin: %s%s\n", text.c_str(), shortfall_text(model_, last).c_str());
  }

  const Model& model_;
  const runs::Answers& answers_;
  const FkOptions& options_;
  runs::PathJob job_;
  runs::Run<StepRecord> run_;
  runs::RunPage page_;
  std::optional<runs::MarkerLine> line_;
  LineTurn turn_;
  Table table_;
  std::vector<std::vector<TracedStep>> traces_;  // of the steps that this run made
};

/// Is there a pressure or tension that may have a maximum?
void check_beyond(const Model& model, const FkOptions& options) {
  const auto loads = [](const Actuator& a) {
    return a.control == Control::load && (a.is<ChamberDrive>() || a.is<CableDrive>());
  };
  if (options.beyond == 0) return;
  if (model.formulation != Formulation::physical || std::none_of(model.actuators.begin(), model.actuators.end(), loads))
    throw InvalidInput(
        "--beyond continues beyond the maximum of a pressure or tension, and no actuator of this robot is commanded by "
        "one (control: pressure, control: tension): leave it out");
  if (!options.map.empty() && !options.polish)
    throw InvalidInput("--beyond is for the solver, not for a map: it needs --polish, or no --map");
}

std::vector<ActuationStep> requested_steps(const Model& model, const FkOptions& options) {
  const Settings settings = read_settings(model, "--set", options.settings);
  if (!options.path.empty()) return read_actuation_path(model, options.path, settings);
  return {{with_settings(model.rest_actuation(), settings)}};
}

int run_fk(const FkOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.scene};
  if (!options.path.empty()) inputs.emplace_back(options.path);
  if (!options.start.empty()) inputs.emplace_back(options.start);
  check_map_use(options, options, inputs);
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = requested_robot(options, inputs);
  check_beyond(model, options);
  const std::vector<ActuationStep> steps = requested_steps(model, options);
  if (steps.front().time) check_times(model, options.path, options, options);
  (void)runs::read_marker_line(model, options.turn);  // before anything is written
  std::vector<Output> outputs = options.outputs(steps.size());
  if (options.resume) leave_to_resume(outputs, options.report);
  check_outputs(outputs, inputs, options.may_replace);
  if (steps.front().time && !options.start.empty())
    throw InvalidInput(
        "--start: a path with times, t_s, begins where the robot has rested for long: leave one of the two out");
  State start{model.rest};
  std::optional<runs::UsedStart> used;
  if (!options.start.empty()) {
    start = runs::read_state(options.start, model);
    used = {options.start, fingerprint_of(start.positions)};
  }
  line.show(-1, "assembling");
  catch_interrupt();
  const runs::Answers answers(model, options.map, options.polish);
  line.clear();
  const OutputFolders folders(outputs);
  if (!options.json) print(head_text(model, options, answers) + curve_remarks(model, options.settings));
  return FkRun(model, answers, options, steps, std::move(start), used ? &*used : nullptr).run();
}

}  // namespace

void add_fk(CLI::App& app, Run& run) {
  add_command(
      app, run, "fk", "Forward kinematics: the shape under given actuation",
      "Lengths are in mm, pressures in kPa (gauge), forces in N. Exit code: 0 done, 1 not converged, a limit or\n"
      "interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin fk examples/pneumatic_finger/pneumatic_finger.yaml --set air=1.5 -o finger.vtu",
      add_options, run_fk);
}

}  // namespace softkin::cli
