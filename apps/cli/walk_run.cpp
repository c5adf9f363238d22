#include "walk_run.hpp"

#include <cstdio>
#include <filesystem>
#include <softkin/io/file.hpp>
#include <softkin/io/svg_plot.hpp>
#include <softkin/io/vtk.hpp>
#include <utility>

#include "command.hpp"
#include "fk_files.hpp"
#include "fk_table.hpp"
#include "fk_units.hpp"
#include "mesh_text.hpp"
#include "plot_walk.hpp"
#include "stored_report.hpp"
#include "terminal.hpp"
#include "walk_resume.hpp"

namespace softkin::cli {

namespace {

class WalkRun {
 public:
  WalkRun(const Model& model, Walker& walker, const WalkOptions& options, const std::vector<GaitStep>& steps)
      : model_(model), walker_(walker), options_(options), steps_(steps), report_(model, options), table_(model) {
    const Vec3& along = walker.direction();
    report_.note("walk",
                 {{"gait", options.gait}, {"cycles", options.cycles}, {"direction", {along[0], along[1], along[2]}}});
    report_.note("feet", feet_json(model));
  }

  int run() {
    if (options_.resume) resume();
    first_ = done_.size();
    if (first_ < steps_.size()) say(table_.header());
    while (done_.size() < steps_.size()) {
      const Status status = advance();
      if (status == Status::converged) continue;
      finish();
      return status == Status::interrupted ? stopped() : lost();
    }
    finish();
    say(stride_text(strides(done_, options_.cycles)));
    say("steps: " + options_.steps().string() + "; plot: " + options_.plot().string() +
        "; shapes: " + options_.shapes().string() + " (open it in ParaView)");
    return done;
  }

 private:
  void say(const std::string& line) const {
    if (!options_.json) print(line + "\n");
  }

  void resume() {
    WalkedBefore before = take_walk(model_, options_, steps_, report_);
    remove_torn_files(options_.outputs(steps_.size()));
    if (!before.remark.empty()) say(before.remark);
    if (before.done.empty()) return say("nothing to resume: starting with step 0");
    done_ = std::move(before.done);
    WalkStep last = done_.back().walk;
    last.equilibrium.state = std::move(before.state);
    walker_.resume(last);
    say(std::to_string(done_.size()) + " of " + counted(steps_.size(), "step") +
        " were done before: " + (done_.size() < steps_.size() ? "going on" : "nothing is left"));
  }

  Status advance() {
    if (interrupted()) return Status::interrupted;
    const std::size_t i = done_.size();
    WalkStep found = walker_.advance(steps_[i].asked.actuation, [&](const Progress& p) {
      show(i, p);
      return !interrupted();
    });
    line_.clear();
    const Status status = found.equilibrium.report.status;
    if (status == Status::interrupted) return status;
    const ElementDeformation deformation = deformation_of(model_, found.equilibrium.state.positions);
    Report::Json json = walk_json(model_, steps_[i], found, deformation);
    if (status != Status::converged) {
      shortfall_ = shortfall(model_, json);
      return status;
    }
    keep(i, std::move(found), deformation, std::move(json));
    return status;
  }

  /// Shape first, report last: at any moment the report tells only of what is on disk.
  void keep(std::size_t i, WalkStep found, const ElementDeformation& deformation, Report::Json json) {
    const auto file = series_file(options_.shapes(), i);
    const Points& positions = found.equilibrium.state.positions;
    write_shape(file, model_, positions, deformation, true);
    add_shape(json, file.filename().string(), positions);
    found.equilibrium.state = {};
    done_.push_back({steps_[i], std::move(found)});
    report_.add(std::move(json));
    write_tables();
    write_file(options_.report(), report_.text());
    say(table_.row(done_.back()));
  }

  void write_tables() const {
    std::vector<PvdEntry> entries;
    for (std::size_t i = 0; i < done_.size(); ++i)
      entries.push_back({steps_[i].asked.time.value_or(static_cast<double>(i)),
                         series_file(options_.shapes(), i).filename().string()});
    write_pvd(options_.shapes(), entries);
    write_file(options_.steps(), walk_csv(model_, done_));
  }

  void finish() {
    if (!done_.empty()) {
      const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
      const std::string title =
          name(options_.gait) + " by " + name(options_.scene) + ": " + formulation_name(model_.formulation);
      write_svg(options_.plot(), plot_of_walk(model_, done_, title));
      report_.note("stride_mm", strides(done_, options_.cycles));
      write_file(options_.report(), report_.text());
    }
    if (options_.json) print(report_.text());
  }

  void show(std::size_t step, const Progress& p) {
    const auto all = static_cast<double>(steps_.size()), at = static_cast<double>(step);
    const double elapsed = seconds_now() - start_;
    std::string text = std::to_string(step) + "/" + std::to_string(steps_.size()) + " steps, " + duration(elapsed);
    if (const auto now = static_cast<double>(step - first_); now > 0)
      text += ", " + duration(elapsed * (all - at) / now) + " left";
    line_.show(at / all, text + ", iteration " + std::to_string(p.iteration));
  }

  [[nodiscard]] int stopped() const {
    std::string text = "interrupted; nothing was finished";
    if (!done_.empty())
      text = "interrupted after " + std::to_string(done_.size()) + " of " + counted(steps_.size(), "step") +
             "; they are in " + options_.folder + ", the same command with --resume goes on";
    std::fprintf(stderr, "softkin: %s\n", text.c_str());
    return not_converged;
  }

  [[nodiscard]] int lost() const {
    std::fprintf(stderr, "softkin: the walk ends before step %zu of %zu: %s\n", done_.size(), steps_.size() - 1,
                 shortfall_.c_str());
    return not_converged;
  }

  const Model& model_;
  Walker& walker_;
  const WalkOptions& options_;
  const std::vector<GaitStep>& steps_;
  Report report_;
  WalkTable table_;
  ProgressLine line_;
  double start_ = seconds_now();  // [s]
  std::vector<WalkedStep> done_;
  std::size_t first_ = 0;  // step of this run
  std::string shortfall_;
};

}  // namespace

int walk_steps(const Model& model, Walker& walker, const WalkOptions& options, const std::vector<GaitStep>& steps) {
  return WalkRun(model, walker, options, steps).run();
}

}  // namespace softkin::cli
