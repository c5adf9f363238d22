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

constexpr Index max_of_anything = 1'000'000;

/// What the user asks of `softkin map`.
struct MapRequest : SolveOptions, RunOptions {
  std::string output;
  MapOptions map;
};

MapOptions map_options(const MapRequest& requested) {
  MapOptions options = requested.map;
  options.statics = requested.statics();
  options.threads = thread_count(requested.threads);
  return options;
}

class MapRun {
 public:
  MapRun(const MapRequest& requested, const Model& model, const std::vector<fs::path>& inputs)
      : requested_(requested), model_(model), options_(map_options(requested)) {
    const std::vector<Output> outputs = requested_outputs({{"--output", requested.output}, {"--html", requested.page}});
    check_outputs(outputs, inputs, requested.may_replace);
    folders_.emplace(outputs);
    (void)maps::outline_of(model);
    journal_.emplace(requested.output, model, options_, requested.resume);
    say(requested.scene + ": " + runs::model_summary(model, requested.solver_name));
    if (requested.resume)
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
          reported_ = at;
          line.show(-1, progress_text(at) + ", " + duration(seconds_now() - start));
          return !interrupted();
        });
      } catch (const InvalidInput&) {
        journal_->remove();  // no later run could continue it
        throw;
      }
    }
    if (!result) return stopped();
    runs::write_map(requested_.output, result->data);
    journal_->remove();
    runs::RunPage page(requested_.page, model_, runs::kept_command());
    page.bend_by(&result->data);
    page.write();
    describe(*result, seconds_now() - start);
    if (!requested_.page.empty()) say(page.reported());
    if (result->accurate) return done;
    std::fprintf(stderr, "softkin: the map is not as accurate as requested: %s\n", result->remark.c_str());
    return not_converged;
  }

 private:
  void say(const std::string& line) const {
    if (!requested_.json) print(line + "\n");
  }

  static std::string progress_text(const MapProgress& at) {
    if (at.doing == "checking") return "checking, " + counted(static_cast<std::size_t>(at.checks), "point");
    std::string text = counted(static_cast<std::size_t>(at.equilibria), "equilibrium", "equilibria") + ", " + at.doing;
    if (std::isfinite(at.error)) text += ", predictions " + number(at.error, 2) + " times the accuracy off";
    return text;
  }

  [[nodiscard]] int stopped() const {
    const std::size_t found = reported_.equilibria + reported_.checks;
    std::fprintf(stderr, "softkin: %s after %s; they are in %s: the same command with --resume continues\n",
                 why_stopped().c_str(), counted(found, "equilibrium", "equilibria").c_str(),
                 runs::MapJournal::path_of(requested_.output).string().c_str());
    return not_converged;
  }

  void describe(const MapResult& result, double seconds) const {
    if (requested_.json) return print(runs::map_json(result.data, requested_.output, seconds) + "\n");
    say(runs::map_text(result.data));
    constexpr double kilo = 1000;
    say("map: " + requested_.output + ", " + number(static_cast<double>(fs::file_size(requested_.output)) / kilo, 3) +
        " kB; " + duration(seconds));
  }

  const MapRequest& requested_;
  const Model& model_;
  MapOptions options_;
  std::optional<OutputFolders> folders_;
  std::optional<runs::MapJournal> journal_;
  MapProgress reported_;
};

void add_accuracies(CLI::App& command, MapOptions& map) {
  add_value(command, "--accuracy", map.accuracy_mm, "MM", "Of the markers [mm] (default: 0.01)", positive_length());
  add_value(command, "--load-accuracy", map.load_accuracy, "L",
            "Of pressures [kPa] and tensions [N] (default: a thousandth of the\nlargest)", finite_number(false));
  add_value(command, "--shape-accuracy", map.shape_accuracy_mm, "MM",
            "Of every vertex of the shape [mm]; 0: without the shape\n(default: 0.05)", finite_number(false));
  add_value(command, "--most", map.max_equilibria, "N",
            "Equilibria that each set of taut cables may take (default: 2000)", integer_from(1, max_of_anything));
  add_value(command, "--check", map.checks, "N",
            "Random actuations, none of which the map was made of, at which\nit is compared with the solver "
            "(default: 200)",
            integer_from(1, max_of_anything));
  add_value(command, "--seed", map.seed, "S", "Of these (default: 1)", integer_from(0, max_of_anything));
}

void add_map_options(CLI::App& command, MapRequest& requested) {
  add_scene(command, requested);
  command.add_option("-o,--output", requested.output, "The map")->type_name("F.skmap")->required();
  add_accuracies(command, requested.map);
  add_force(command, requested);
  add_solver(command, requested,
             "Equilibria solved at once, each on one thread; 0: as many as the\nmachine has (default); the map is the "
             "same");
  add_run(command, requested, "Go on where the same command was interrupted or killed", "Print a summary as JSON");
}

int run_map(const MapRequest& requested) {
  check_solver(requested);
  check_extension("--output", requested.output, {{".skmap", ""}});
  if (!requested.page.empty() && requested.map.shape_accuracy_mm == 0)
    throw InvalidInput("--html bends the robot's shape, which --shape-accuracy 0 leaves out");
  if (requested.instant) throw InvalidInput("--instant: a map is one of relaxed shapes");
  std::vector<fs::path> inputs{requested.scene};
  const Model model = requested_robot(requested, inputs);
  catch_interrupt();
  return MapRun(requested, model, inputs).run();
}

}  // namespace

void add_map(CLI::App& app, Run& run) {
  CLI::App& map = *add_command(
      app, run, "map", "Kinematic map: the robot in closed form, its error checked",
      "Lengths are in mm, pressures in kPa (gauge), forces in N. Exit code: 0 done, 1 not as accurate as requested,\n"
      "or interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin map examples/three_chamber_actuator/three_chamber_actuator.yaml -o actuator.skmap",
      add_map_options, run_map);
  map.require_subcommand(0, 1);
  add_map_export(map, run);
}

}  // namespace softkin::cli
