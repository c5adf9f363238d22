#include <cmath>
#include <cstdio>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/page.hpp>
#include <softkin/runs/run_tables.hpp>
#include <softkin/runs/walk_run.hpp>

#include "command.hpp"
#include "run_text.hpp"
#include "solve_options.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;
using runs::WalkRecord;

namespace {

constexpr double same_stride_mm = 1e-4;
constexpr int stride_decimals = 4;

/// What the user asks of `softkin walk`.
struct WalkOptions : SolveOptions, RunOptions {
  std::string gait, folder;
  std::size_t cycles = 3;

  [[nodiscard]] runs::WalkFolder files() const { return runs::WalkFolder(folder); }
  [[nodiscard]] std::vector<Output> outputs(std::size_t steps) const {
    std::vector<Output> outputs;
    for (const fs::path& file : {files().table(), files().plot(), files().run().report})
      outputs.push_back({"--output", file});
    outputs.push_back({"--output", files().run().shapes, steps});
    if (!page.empty()) outputs.push_back({"--html", page});
    return outputs;
  }
};

void add_options(CLI::App& command, WalkOptions& options) {
  add_scene(command, options);
  command
      .add_option("GAIT", options.gait,
                  "One cycle of commands, a column for each actuator that\nchanges, and t_s; the last row is the first "
                  "one again")
      ->type_name("F.csv")
      ->required();
  command
      .add_option("-o,--output", options.folder,
                  "Folder for walk.csv, walk.pvd with the shapes, walk.svg and\nreport.json")
      ->type_name("DIR")
      ->required();
  add_value(command, "--cycles", options.cycles, "N",
            "How often the gait is walked (default: " + std::to_string(WalkOptions().cycles) + ")",
            integer_from(1, 100'000));
  add_force(command, options);
  add_solver(command, options);
  add_run(command, options, "Go on where the same command was interrupted, or with more\n--cycles",
          "Print the report instead of the table");
}

void check_usage(const WalkOptions& options) {
  if (options.folder.empty()) throw InvalidInput("--output: the name of the folder is empty");
  check_solver(options);
}

/// "stride: 5.12 mm per cycle from cycle 2 on".
std::string stride_text(const std::vector<double>& strides) {
  const double last = strides.back();
  std::size_t steady = strides.size();  // cycles before this one have another stride
  while (steady > 0 && std::abs(strides[steady - 1] - last) <= same_stride_mm) --steady;
  std::string text = "stride: " + decimal(last, stride_decimals) + " mm per cycle";
  if (steady + 1 >= strides.size()) {
    if (strides.size() > 1) text += " in the last one, which is not that of the one before: walk more --cycles";
  } else if (steady > 0) {
    text += " from cycle " + std::to_string(steady + 1) + " on";
  }
  return text;
}

/// The walk on the terminal.
class ShownWalk {
 public:
  ShownWalk(const Model& model, const WalkOptions& options, runs::WalkRun& walk)
      : model_(model),
        options_(options),
        walk_(walk),
        run_(walk.run()),
        page_(options.page, model, runs::kept_command()),
        table_(runs::table_of_walk(model)) {
    page_.watch(run_, nullptr);
  }

  int run() {
    if (options_.resume) resume_run(run_, options_.outputs(run_.size()), "step", options_.json);
    const runs::Advance end = advance_run(
        run_, table_, "step", options_.json,
        [](RunProgress& line, const Progress& p) { line.show("iteration " + std::to_string(p.iteration)); },
        [&] { return runs::row_of(model_, run_.last()); });
    walk_.finish();
    page_.write();
    if (options_.json) show_report(run_);
    if (end == runs::Advance::interrupted)
      return report_stopped(stopped_of(run_, "step", options_.folder, options_.files().run().shapes));
    if (end == runs::Advance::lost) return lost();
    if (!options_.json) describe();
    return done;
  }

 private:
  void describe() {
    OverlapTally overlaps(model_);
    std::size_t number = 0;
    for (const WalkRecord& record : walk_.records()) overlaps.add(number++, record);
    print(stride_text(walk_.note_strides()) + "\n");
    if (const std::string text = overlaps.text("step"); !text.empty()) print(text + "\n");
    const runs::WalkFolder files = options_.files();
    print("steps: " + files.table().string() + "; plot: " + files.plot().string() +
          "; shapes: " + files.run().shapes.string() + " (open it in ParaView)\n");
    if (!options_.page.empty()) print(page_.reported() + "\n");
  }

  [[nodiscard]] int lost() const {
    std::fprintf(stderr, "softkin: the walk ends before step %zu of %zu: %s\n", run_.done(), run_.size() - 1,
                 shortfall_text(model_, run_.last()).c_str());
    return not_converged;
  }

  const Model& model_;
  const WalkOptions& options_;
  runs::WalkRun& walk_;
  runs::Run<WalkRecord>& run_;
  runs::RunPage page_;
  Table table_;
};

int run_walk(const WalkOptions& options) {
  check_usage(options);
  std::vector<fs::path> inputs{options.scene, options.gait};
  ProgressLine line;
  line.show(-1, "reading the scene");
  const Model model = requested_robot(options, inputs);
  std::vector<runs::GaitStep> steps = runs::repeated(
      model, options.gait, read_actuation_path(model, options.gait, Settings(model.actuators.size())), options.cycles);
  std::vector<Output> outputs = options.outputs(steps.size());
  if (options.resume) leave_to_resume(outputs, options.files().run().report);
  check_outputs(outputs, inputs, options.may_replace);
  line.show(-1, "assembling");
  runs::WalkRun walk(model, {options.scene, options.gait, std::move(steps), options.cycles}, options.statics(),
                     options.files());
  line.clear();
  catch_interrupt();
  const OutputFolders folders(outputs);
  if (!options.json) print(options.scene + ": " + runs::model_summary(model, options.solver_name) + "\n");
  return ShownWalk(model, options, walk).run();
}

}  // namespace

void add_walk(CLI::App& app, Run& run) {
  add_command(
      app, run, "walk", "Walking: a gait with feet that slide more easily in one direction than in the other",
      "The scene's key 'feet' says what stands on the floor (docs/walking.md). Exit code: 0 done, 1 an equilibrium "
      "did\n"
      "not converge, or interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin walk examples/dea_crawler/dea_crawler.yaml examples/dea_crawler/gait.csv -o out/walk",
      add_options, run_walk);
}

}  // namespace softkin::cli
