#include <cstdio>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/runs/page.hpp>
#include <softkin/runs/ranks.hpp>
#include <softkin/runs/workspace_file.hpp>

#include "command.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t max_samples = 100'000'000;

/// What the user asks of `softkin workspace`. An empty file name: not given.
struct WorkspaceOptions : SolveOptions, RunOptions {
  std::string output, cloud, hull, plot;
  std::string marker;  // that cloud, hull and plot show; empty: the first
  Index samples = 0;
  std::string sampling = "grid";
  std::optional<std::uint64_t> seed;

  [[nodiscard]] std::vector<Output> outputs() const {
    return requested_outputs(
        {{"--output", output}, {"--cloud", cloud}, {"--hull", hull}, {"--plot", plot}, {"--html", page}});
  }
  [[nodiscard]] Sampling kind() const {
    return sampling == "grid" ? Sampling::grid : sampling == "sobol" ? Sampling::sobol : Sampling::random;
  }
};

void add_files(CLI::App& command, WorkspaceOptions& options) {
  add_scene(command, options);
  command
      .add_option("-o,--output", options.output,
                  "A row per sample: actuation, markers [mm], tensions [N] and\npressures [kPa], status; grows while "
                  "samples are solved")
      ->type_name("F.csv")
      ->required();
  add_value(command, "--cloud", options.cloud, "F.vtu",
            "The marker at every sample, with actuation and loads, for\nParaView");
  add_value(command, "--hull", options.hull, "F", "Convex hull of the marker's positions; its volume is printed");
  add_value(command, "--plot", options.plot, "F.svg", "The marker's positions, seen along the axes");
  add_value(command, "--marker", options.marker, "NAME",
            "The marker that --cloud, --hull and --plot show (default: the\nscene's first); the CSV has all");
}

void add_sampling(CLI::App& command, WorkspaceOptions& options) {
  command
      .add_option("--samples", options.samples,
                  "How many actuations, inside the ranges of the actuators; a grid\ntakes the nearest number that "
                  "fills it")
      ->type_name("N")
      ->required()
      ->check(integer_from(1, max_samples));
  add_value(command, "--sampling", options.sampling, "NAME",
            "grid (default): as many values for every actuator, ends\nincluded; sobol: a low-discrepancy "
            "sequence; random: uniform",
            one_of({"grid", "sobol", "random"}));
  add_value(command, "--seed", options.seed, "S", "Of --sampling random (default: 0)",
            integer_from(0, std::numeric_limits<std::int64_t>::max()));
}

void check_usage(const WorkspaceOptions& options) {
  check_solver(options);
  check_extension("--output", options.output, {{".csv", ""}});
  check_extension("--cloud", options.cloud, {{".vtu", ""}});
  check_extension("--hull", options.hull, {{".vtu", ""}, {".stl", ""}});
  check_extension("--plot", options.plot, {{".svg", ""}});
  if (options.seed && options.kind() != Sampling::random)
    throw InvalidInput("--seed is the seed of random samples: it needs --sampling random");
}

bool has_triangles(const runs::Reach& reach) {
  return reach.hull && !reach.hull->triangles.empty();
}

/// "tip reaches x 20.1 to 118.3, ... mm", the hull and the files, a line each.
std::string reach_text(const runs::Reach& reach, const WorkspaceOptions& options, const std::string& reported_page) {
  if (reach.samples.empty()) return "no sample has an equilibrium: nothing to show\nsamples: " + options.output;
  std::string text = reach.marker + " reaches";
  for (int axis = 0; axis < 3; ++axis)
    text += std::string(axis > 0 ? ", " : " ") + axis_names[axis] + " " +
            decimal(reach.positions.col(axis).minCoeff(), 2) + " to " +
            decimal(reach.positions.col(axis).maxCoeff(), 2);
  text += " mm";
  if (reach.hull) text += "\nconvex hull of the reach: " + runs::hull_text(*reach.hull);
  text += "\nsamples: " + options.output;
  if (!options.cloud.empty()) text += "\ncloud: " + options.cloud + " (open it in ParaView)";
  if (has_triangles(reach)) text += "\nhull: " + options.hull;
  if (!options.plot.empty()) text += "\nplot: " + options.plot;
  if (!reported_page.empty()) text += "\n" + reported_page;
  return text;
}

/// What all ranks know.
struct Requested {
  Model model;
  SamplingOptions sampling;
  WorkspacePlan plan;
  WorkspaceHead head;
  std::vector<fs::path> inputs;

  explicit Requested(const WorkspaceOptions& options) : inputs{options.scene} {
    model = requested_robot(options, inputs);
    (void)runs::shown_marker(model, options.marker);
    sampling = {options.kind(), options.samples, options.seed.value_or(0)};
    if (sampling.kind == Sampling::grid) sampling.samples = full_grid(model, options.samples);
    plan = plan_workspace(model, sampling);
    head = runs::workspace_head(model, sampling, options.statics());
  }
};

class WorkspaceRun {
 public:
  WorkspaceRun(const WorkspaceOptions& options, const Requested& requested, const runs::Ranks& ranks)
      : options_(options),
        requested_(requested),
        ranks_(ranks),
        columns_(runs::workspace_columns(requested.model)),
        page_(options.page, requested.model, runs::kept_command()) {}

  /// Rank 0: before anything is written.
  void begin() {
    std::vector<Output> outputs = options_.outputs();
    if (options_.resume) leave_to_resume(outputs, options_.output);
    check_outputs(outputs, requested_.inputs, options_.may_replace);
    folders_.emplace(outputs);
    file_.emplace(options_.output, requested_.head, columns_, requested_.plan, options_.resume);
    if (options_.resume) remove_torn_files(options_.outputs());
    say(options_.scene + ": " + runs::model_summary(requested_.model, options_.solver_name));
    std::string text = samples_text() + ", " + runs::sampling_text(requested_.model, requested_.sampling);
    if (requested_.sampling.samples != options_.samples)
      text += "; the full grid nearest to " + std::to_string(options_.samples);
    say(text);
    if (ranks_.size() > 1) say(std::to_string(ranks_.size()) + " ranks");
    if (options_.resume) say_resumed();
  }

  int run() {
    const double start = seconds_now();
    solve();
    if (!ranks_.leads()) return done;
    if (!file_->complete())
      return report_stopped({static_cast<std::size_t>(file_->done()), samples(), "sample", options_.output, true});
    const runs::Reach reach =
        runs::reach_of(requested_.model, file_->finish(), options_.marker, !options_.hull.empty());
    if (!reach.samples.empty()) write(reach);
    describe(reach, seconds_now() - start);
    return judge();
  }

 private:
  void say(const std::string& line) const {
    if (!options_.json) print(line + "\n");
  }

  [[nodiscard]] std::size_t samples() const { return requested_.plan.samples(); }
  [[nodiscard]] std::string samples_text() const { return counted(samples(), "sample"); }

  void say_resumed() const {
    if (file_->was_torn()) say("the last row was torn and is solved again");
    if (file_->done() == 0) return say("nothing to resume: starting with the first sample");
    const std::string count = std::to_string(file_->done()) + " of " + std::to_string(samples());
    say(count +
        (file_->complete() ? " samples were done before: nothing is left" : " samples were done before: going on"));
  }

  void solve() {
    ProgressLine line;
    std::optional<runs::FileDesk> desk;
    if (ranks_.leads()) {
      const auto show = [&, before = file_->done(), start = seconds_now()] { show_progress(line, before, start); };
      desk.emplace(
          requested_.plan, *file_, [] { return !interrupted(); }, show);
      show();
    }
    const auto work = [&](GroupDesk& groups) {
      if (ranks_.size() == 1 && file_->complete()) return;
      const Statics assembled(requested_.model);
      solve_groups(assembled, requested_.plan, options_.statics(), thread_count(options_.threads), groups,
                   [](const Progress&) { return !interrupted(); });
    };
    ranks_.distribute(requested_.model, requested_.plan, desk ? &*desk : nullptr, work);
  }

  /// before: samples that were done at the start [s]
  void show_progress(ProgressLine& line, Index before, double start) const {
    const double now = file_->done(), all = requested_.plan.samples(), made = now - before;
    const double elapsed = seconds_now() - start;
    std::string text =
        std::to_string(file_->done()) + "/" + std::to_string(samples()) + " samples, " + duration(elapsed);
    if (made > 0) text += ", " + duration(elapsed * (all - now) / made) + " left";
    const Index missed = file_->done() - file_->count(Status::converged);
    if (missed > 0) text += ", " + std::to_string(missed) + " without an equilibrium";
    line.show(now / all, text);
  }

  void write(const runs::Reach& reach) {
    if (!options_.cloud.empty()) runs::write_cloud(options_.cloud, requested_.model, reach);
    if (has_triangles(reach)) runs::write_hull(options_.hull, *reach.hull);
    if (!options_.plot.empty()) write_svg(options_.plot, runs::plot_of_reach(reach));
    page_.show_reach(runs::shown_marker(requested_.model, options_.marker), reach.positions);
    page_.write();
  }

  void describe(const runs::Reach& reach, double seconds) const {
    const Index converged = file_->count(Status::converged);
    if (options_.json)
      return print(runs::workspace_summary(
                       options_.scene, requested_.head, reach, requested_.plan.samples(),
                       [this](Status status) { return file_->count(status); }, seconds) +
                   "\n");
    say(std::to_string(converged) + " of " + samples_text() + " converged; " + duration(seconds));
    say(reach_text(reach, options_, page_.reported()));
  }

  [[nodiscard]] int judge() const {
    const auto complain = [&](Status status, const std::string& what) {
      if (const Index count = file_->count(status); count > 0)
        std::fprintf(stderr, "softkin: %d of %zu samples %s\n", count, samples(), what.c_str());
    };
    const Index shapeless = file_->count_without_shape() - file_->count(Status::not_converged);
    complain(Status::limit,
             "have no equilibrium that could be followed to (status limit); their rows hold the last good "
             "shape" +
                 (shapeless == 0 ? "" : ", but " + std::to_string(shapeless) + " have none"));
    complain(Status::not_converged, "did not converge (status not_converged); they are rows without values");
    return file_->count(Status::converged) == requested_.plan.samples() ? done : not_converged;
  }

  const WorkspaceOptions& options_;
  const Requested& requested_;
  const runs::Ranks& ranks_;
  WorkspaceColumns columns_;
  runs::RunPage page_;
  std::optional<OutputFolders> folders_;
  std::optional<runs::WorkspaceFile> file_;
};

void add_options(CLI::App& command, WorkspaceOptions& options) {
  add_files(command, options);
  add_sampling(command, options);
  add_force(command, options);
  add_solver(command, options,
             "Samples solved at once, each on one thread; 0: as many as the\nmachine has (default); under mpirun: "
             "of each rank");
  add_run(command, options, "Go on where the same command was interrupted or killed", "Print a summary as JSON");
}

int run_workspace(const WorkspaceOptions& options) {
  const runs::Ranks ranks;
  try {
    std::optional<Requested> requested;
    ranks.together([&] {
      check_usage(options);
      requested.emplace(options);
    });
    std::string text;
    for (const auto& [key, value] : requested->head) text += key + ": " + value + "\n";
    ranks.agree_on(text);
    WorkspaceRun run(options, *requested, ranks);
    catch_interrupt();
    ranks.together([&] {
      if (ranks.leads()) run.begin();
    });
    return run.run();
  } catch (const runs::Silence&) {
    return bad_input;
  }
}

}  // namespace

void add_workspace(CLI::App& app, Run& run) {
  add_command(app, run, "workspace", "Workspace: the equilibria of many actuations, and their reach",
              "Lengths are in mm, pressures in kPa (gauge), forces in N. Exit code: 0 done, 1 some samples have no "
              "equilibrium\n"
              "or interrupted, 2 bad usage or bad input.\n"
              "Example:\n"
              "  softkin workspace examples/three_tendon_finger/three_tendon_finger.yaml --samples 64 -o reach.csv",
              add_options, run_workspace);
}

}  // namespace softkin::cli
