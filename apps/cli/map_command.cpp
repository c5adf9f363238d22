#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/runs/map_file.hpp>
#include <softkin/runs/map_journal.hpp>
#include <softkin/runs/page.hpp>

#include "command.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

constexpr Index most_of_anything = 1'000'000;

/// What the user asks of `softkin map`.
struct MapAsked : SolveOptions, RunOptions {
  std::string output;
  MapOptions map;
};

MapOptions map_options(const MapAsked& asked) {
  MapOptions options = asked.map;
  options.statics = asked.statics();
  options.threads = thread_count(asked.threads);
  return options;
}

class MapRun {
 public:
  MapRun(const MapAsked& asked, const Model& model, const std::vector<fs::path>& inputs)
      : asked_(asked), model_(model), options_(map_options(asked)) {
    const std::vector<Output> outputs = asked_outputs({{"--output", asked.output}, {"--html", asked.page}});
    check_outputs(outputs, inputs, asked.may_replace);
    folders_.emplace(outputs);
    (void)maps::outline_of(model);
    journal_.emplace(asked.output, model, options_, asked.resume);
    say(asked.scene + ": " + runs::model_summary(model, asked.solver_name));
    if (asked.resume)
      say(journal_->known() > 0
              ? counted(journal_->known(), "equilibrium", "equilibria") + " were found before: going on"
              : "nothing to resume: starting with the first equilibrium");
  }

  int run() {
    const double start = seconds_now();
    std::optional<MapResult> result;
    {
      ProgressLine line;
      try {
        result = build_map(model_, options_, &*journal_, [&](const MapProgress& at) {
          told_ = at;
          line.show(-1, progress_text(at) + ", " + duration(seconds_now() - start));
          return !interrupted();
        });
      } catch (const InvalidInput&) {
        journal_->remove();  // no later run could go on with it
        throw;
      }
    }
    if (!result) return stopped();
    runs::write_map(asked_.output, result->data);
    journal_->remove();
    runs::RunPage page(asked_.page, model_, runs::kept_command());
    page.bend_by(&result->data);
    page.write();
    tell(*result, seconds_now() - start);
    if (!asked_.page.empty()) say(page.told());
    if (result->accurate) return done;
    std::fprintf(stderr, "softkin: the map is not as accurate as was asked for: %s\n", result->remark.c_str());
    return not_converged;
  }

 private:
  void say(const std::string& line) const {
    if (!asked_.json) print(line + "\n");
  }

  static std::string progress_text(const MapProgress& at) {
    if (at.doing == "checking") return "checking, " + counted(static_cast<std::size_t>(at.checks), "point");
    std::string text = counted(static_cast<std::size_t>(at.equilibria), "equilibrium", "equilibria") + ", " + at.doing;
    if (std::isfinite(at.error)) text += ", predictions " + number(at.error, 2) + " times the accuracy off";
    return text;
  }

  [[nodiscard]] int stopped() const {
    const std::size_t found = told_.equilibria + told_.checks;
    std::fprintf(stderr, "softkin: %s after %s; they are in %s: the same command with --resume goes on\n",
                 why_stopped().c_str(), counted(found, "equilibrium", "equilibria").c_str(),
                 runs::MapJournal::path_of(asked_.output).string().c_str());
    return not_converged;
  }

  void tell(const MapResult& result, double seconds) const {
    if (asked_.json) return print(runs::map_json(result.data, asked_.output, seconds) + "\n");
    say(runs::map_text(result.data));
    constexpr double kilo = 1000;
    say("map: " + asked_.output + ", " + number(static_cast<double>(fs::file_size(asked_.output)) / kilo, 3) + " kB; " +
        duration(seconds));
  }

  const MapAsked& asked_;
  const Model& model_;
  MapOptions options_;
  std::optional<OutputFolders> folders_;
  std::optional<runs::MapJournal> journal_;
  MapProgress told_;
};

void add_accuracies(CLI::App& command, MapOptions& map) {
  add_value(command, "--accuracy", map.accuracy_mm, "MM", "Of the markers [mm] (default: 0.01)", positive_length());
  add_value(command, "--load-accuracy", map.load_accuracy, "L",
            "Of pressures [kPa] and tensions [N] (default: a thousandth of the\nlargest)", finite_number(false));
  add_value(command, "--shape-accuracy", map.shape_accuracy_mm, "MM",
            "Of every vertex of the shape [mm]; 0: without the shape\n(default: 0.05)", finite_number(false));
  add_value(command, "--most", map.most_equilibria, "N",
            "Equilibria that each set of taut cables may take (default: 2000)", integer_from(1, most_of_anything));
  add_value(command, "--check", map.checks, "N",
            "Random actuations, none of which the map was made of, at which\nit is compared with the solver "
            "(default: 200)",
            integer_from(1, most_of_anything));
  add_value(command, "--seed", map.seed, "S", "Of these (default: 1)", integer_from(0, most_of_anything));
}

void add_map_options(CLI::App& command, MapAsked& asked) {
  add_scene(command, asked);
  command.add_option("-o,--output", asked.output, "The map")->type_name("F.skmap")->required();
  add_accuracies(command, asked.map);
  add_force(command, asked);
  add_solver(command, asked,
             "Equilibria solved at once, each on one thread; 0: as many as the\nmachine has (default); the map is the "
             "same");
  add_run(command, asked, "Go on where the same command was interrupted or killed", "Print a summary as JSON");
}

int run_map(const MapAsked& asked) {
  check_solver(asked);
  check_extension("--output", asked.output, {{".skmap", ""}});
  if (!asked.page.empty() && asked.map.shape_accuracy_mm == 0)
    throw InvalidInput("--html bends the robot's shape, which --shape-accuracy 0 leaves out");
  if (asked.instant) throw InvalidInput("--instant: a map is one of relaxed shapes");
  std::vector<fs::path> inputs{asked.scene};
  const Model model = asked_robot(asked, inputs);
  catch_interrupt();
  return MapRun(asked, model, inputs).run();
}

}  // namespace

void add_map(CLI::App& app, Run& run) {
  CLI::App& map = *add_command(
      app, run, "map", "Kinematic map: the robot in closed form, its error checked",
      "Lengths are in mm, pressures in kPa (gauge), forces in N. Exit code: 0 done, 1 not as accurate as asked for,\n"
      "or interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin map examples/three_chamber_actuator/three_chamber_actuator.yaml -o actuator.skmap",
      add_map_options, run_map);
  map.require_subcommand(0, 1);
  add_map_export(map, run);
}

}  // namespace softkin::cli
