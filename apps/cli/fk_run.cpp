#include "fk_run.hpp"

#include <cstdio>
#include <softkin/io/file.hpp>
#include <softkin/io/svg_plot.hpp>
#include <softkin/io/vtk.hpp>
#include <utility>

#include "command.hpp"
#include "fk_files.hpp"
#include "fk_progress.hpp"
#include "fk_report.hpp"
#include "fk_resume.hpp"
#include "fk_table.hpp"
#include "fk_units.hpp"
#include "mesh_text.hpp"
#include "output_files.hpp"
#include "plot_fk.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

class FkRun {
 public:
  FkRun(const Model& model, const Statics& statics, const FkOptions& options, const std::vector<Step>& steps)
      : model_(model),
        statics_(statics),
        options_(options),
        steps_(steps),
        report_(model, options),
        table_(model, steps.size()),
        state_(statics.rest()) {}

  int run() {
    if (options_.resume) resume();
    const std::size_t first = report_.size();
    if (first < steps_.size()) say(table_.header());
    FkProgress progress(first, steps_.size());
    while (report_.size() < steps_.size()) {
      if (!solve_next(progress)) {
        finish();
        return stopped();
      }
    }
    finish();
    if (report_.size() > first) say_findings();
    return judge();
  }

 private:
  void say(const std::string& line) const {
    if (!options_.json) print(line + "\n");
  }

  void resume() {
    Finished finished = take_finished(model_, options_, steps_, report_);
    remove_torn_files(options_.outputs(steps_.size()));
    if (!finished.remark.empty()) say(finished.remark);
    if (finished.steps == 0) return say("nothing to resume: starting with step 0");
    state_ = std::move(finished.state);
    write_collection();
    const std::string count = std::to_string(finished.steps) + " of " + counted(steps_.size(), "step");
    say(count +
        (finished.steps < steps_.size() ? " were done before: going on" : " were done before: nothing is left"));
  }

  /// False where the user has interrupted it.
  bool solve_next(FkProgress& progress) {
    const std::size_t i = report_.size();
    progress.begin_step(i);
    const auto go_on = [&](const Progress& p) {
      progress.show(p);
      return !interrupted();
    };
    if (interrupted()) return false;
    Equilibrium found = statics_.solve(steps_[i].actuation, state_, options_.statics(), go_on);
    progress.clear();
    if (found.report.status == Status::interrupted) return false;
    keep(found, i);
    state_ = std::move(found.state);
    return true;
  }

  /// Shape, then collection, then report: at any moment the report tells only of shapes that are on disk.
  void keep(const Equilibrium& found, std::size_t i) {
    const ElementDeformation deformation = deformation_of(model_, found.state.positions);
    Report::Json step = step_json(model_, found, deformation);
    if (steps_[i].time) step["time_s"] = *steps_[i].time;
    if (options_.series()) {
      const auto file = series_file(options_.output, i);
      write_shape(file, model_, found.state.positions, deformation, found.report.status == Status::converged);
      add_shape(step, file.filename().string(), found.state.positions);
    }
    report_.add(std::move(step));
    if (options_.series()) write_collection();
    if (!options_.report.empty()) write_file(options_.report, report_.text());
    say(table_.row(i, report_.last()));
  }

  void write_collection() const {
    std::vector<PvdEntry> entries;
    for (std::size_t i = 0; i < report_.size(); ++i)
      entries.push_back(
          {steps_[i].time.value_or(static_cast<double>(i)), series_file(options_.output, i).filename().string()});
    write_pvd(options_.output, entries);
  }

  [[nodiscard]] bool last_converged() const {
    const auto& unconverged = report_.unconverged();
    return unconverged.empty() || unconverged.back().number + 1 != report_.size();
  }

  /// What shows the last finished step.
  void finish() const {
    if (report_.size() > 0 && !options_.output.empty() && !options_.series())
      write_shape(options_.output, model_, state_.positions, deformation_of(model_, state_.positions),
                  last_converged());
    if (report_.size() > 0 && !options_.image.empty())
      write_image(options_.image, model_, state_.positions, options_.view, image_title());
    if (report_.size() > 0 && !options_.plot.empty()) write_plot();
    if (options_.json) print(report_.text());
  }

  void write_plot() const {
    const Report::Json report = Report::Json::parse(report_.text());  // with the steps of an interrupted run
    const std::string scene = std::filesystem::path(options_.scene).filename().string();
    const std::string title = scene + ": " + formulation_name(model_.formulation) + ", " + options_.solver_name;
    write_svg(options_.plot, plot_of_steps(model_, report.at("steps"), title));
  }

  [[nodiscard]] std::string image_title() const {
    std::string title;
    for (const Actuator& actuator : model_.actuators) {
      const double value = report_.last().at("actuation").at(actuator.name).get<double>();
      title += (title.empty() ? "" : ", ") + actuator.name + " = " + command_text(actuator, value, 4) +
               (actuator.control == Control::ratio ? " [-]" : "");
    }
    const auto status = report_.last().at("status").get<std::string>();
    return last_converged() ? title : title + (title.empty() ? status : ": " + status);
  }

  void say_findings() const {
    say(findings(model_, report_.last()));
    if (!options_.output.empty()) say("shapes: " + options_.output + " (open it in ParaView)");
    if (!options_.image.empty()) say("picture: " + options_.image);
    if (!options_.plot.empty()) say("plot: " + options_.plot);
    if (!options_.report.empty()) say("report: " + options_.report);
  }

  [[nodiscard]] int stopped() const {
    const bool files =
        !options_.output.empty() || !options_.report.empty() || !options_.image.empty() || !options_.plot.empty();
    const bool resumable = options_.series() && !options_.report.empty() && !options_.path.empty();
    std::string text = "interrupted";
    if (report_.size() == 0) text += "; nothing was finished";
    if (report_.size() > 0)
      text += " after " + std::to_string(report_.size()) + " of " + counted(steps_.size(), "step");
    if (report_.size() > 0 && files) text += "; they are in the files that were asked for";
    if (report_.size() > 0 && resumable) text += ", the same command with --resume goes on";
    std::fprintf(stderr, "softkin: %s\n", text.c_str());
    return not_converged;
  }

  [[nodiscard]] int judge() const {
    if (report_.unconverged().empty()) return done;
    for (const char* status : {"not converged", "limit"}) complain(status);
    return not_converged;
  }

  /// Tells which steps ended so, and of the last of them how.
  void complain(const std::string& status) const {
    std::vector<std::size_t> numbers;
    const Report::Json* last = nullptr;
    for (const Report::Unconverged& each : report_.unconverged()) {
      if (each.step.at("status").get<std::string>() != status) continue;
      numbers.push_back(each.number);
      last = &each.step;
    }
    if (numbers.empty()) return;
    std::string text = status;
    if (steps_.size() > 1) text += (numbers.size() == 1 ? " in step " : " in steps ") + list_text(numbers);
    text += numbers.size() > 1 ? "; in the last of them " : ": ";
    std::fprintf(stderr, "softkin: %s%s\n", text.c_str(), shortfall(model_, *last).c_str());
  }

  const Model& model_;
  const Statics& statics_;
  const FkOptions& options_;
  const std::vector<Step>& steps_;
  Report report_;
  StepTable table_;
  State state_;
};

}  // namespace

int run_steps(const Model& model, const Statics& statics, const FkOptions& options, const std::vector<Step>& steps) {
  return FkRun(model, statics, options, steps).run();
}

}  // namespace softkin::cli
