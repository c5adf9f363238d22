#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <softkin/kinematics/workspace.hpp>
#include <thread>

#include <softkin/io/output_files.hpp>
#include "command.hpp"
#include "mesh_text.hpp"
#include "solve_options.hpp"
#include "step_text.hpp"
#include "terminal.hpp"
#include "workspace_columns.hpp"
#include "workspace_file.hpp"
#include "workspace_outputs.hpp"
#include "workspace_ranks.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// Groups that have something left, and the file that keeps what is made of them.
class FileDesk : public GroupDesk {
 public:
  FileDesk(const WorkspacePlan& plan, WorkspaceFile& file)
      : plan_(plan), file_(file), before_(file.done()), start_(seconds_now()) {
    show();
  }

  std::optional<GroupTask> take() override {
    const std::lock_guard lock(mutex_);
    for (; next_ < plan_.groups.size() && !interrupted(); ++next_) {
      GroupTask task{static_cast<Index>(next_), {}};
      bool anything = false;
      for (const Index sample : plan_.groups[next_]) {
        task.known.push_back(file_.known(sample));
        anything = anything || !task.known.back();
      }
      if (!anything) continue;
      ++next_;
      return task;
    }
    return std::nullopt;
  }

  void keep(const WorkspaceSample& sample) override {
    const std::lock_guard lock(mutex_);
    file_.add(sample);
    show();
  }

  void end_progress() { line_.clear(); }

 private:
  void show() {
    const double done = file_.done(), all = plan_.samples(), made = done - before_, elapsed = seconds_now() - start_;
    std::string text =
        std::to_string(file_.done()) + "/" + std::to_string(plan_.samples()) + " samples, " + duration(elapsed);
    if (made > 0) text += ", " + duration(elapsed * (all - done) / made) + " left";
    const Index missed = file_.done() - file_.count(Status::converged);
    if (missed > 0) text += ", " + std::to_string(missed) + " without an equilibrium";
    line_.show(done / all, text);
  }

  const WorkspacePlan& plan_;
  WorkspaceFile& file_;
  std::mutex mutex_;
  std::size_t next_ = 0;  // group
  Index before_;          // samples
  double start_;          // [s]
  ProgressLine line_;
};

/// What all ranks know.
struct Job {
  Model model;
  SamplingOptions sampling;
  WorkspacePlan plan;
  WorkspaceHead head;
  std::vector<fs::path> inputs;
};

Job read_job(const WorkspaceOptions& options) {
  Job job;
  job.inputs = {options.scene};
  job.model = asked_robot(options, job.inputs);
  (void)shown_marker(job.model, options.marker);
  job.sampling = {options.kind(), options.samples, options.seed.value_or(0)};
  if (job.sampling.kind == Sampling::grid)
    job.sampling.samples = static_cast<Index>(std::llround(
        std::pow(nearest_grid(job.model, options.samples), static_cast<double>(varied_actuators(job.model).size()))));
  job.plan = plan_workspace(job.model, job.sampling);
  job.head = workspace_head(job.model, job.sampling, options.solver_name);
  return job;
}

int thread_count(int asked) {
  return asked > 0 ? asked : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

class WorkspaceRun {
 public:
  WorkspaceRun(const WorkspaceOptions& options, const Job& job, const Ranks& ranks)
      : options_(options), job_(job), ranks_(ranks), columns_(workspace_columns(job.model)) {}

  /// Rank 0: before anything is written.
  void begin() {
    check_outputs(options_.outputs(), job_.inputs);
    folders_.emplace(options_.outputs());
    file_.emplace(options_.output, job_.head, columns_, job_.plan, options_.resume);
    if (options_.resume) remove_torn_files(options_.outputs());
    say(options_.scene + ": " + summary(job_.model, options_.solver_name));
    std::string text = counted(static_cast<std::size_t>(job_.sampling.samples), "sample") + ", " +
                       sampling_text(job_.model, job_.sampling);
    if (job_.sampling.samples != options_.samples)
      text += "; the full grid nearest to " + std::to_string(options_.samples);
    say(text);
    if (ranks_.size() > 1) say(std::to_string(ranks_.size()) + " ranks");
    if (options_.resume) say_resumed();
  }

  int run() {
    const double start = seconds_now();
    solve();
    if (!ranks_.leads()) return done;
    if (!file_->complete()) return stopped();
    file_->finish();
    WorkspaceReach reach(job_.model, read_workspace(options_.output, columns_).samples, options_);
    reach.write();
    tell(reach, seconds_now() - start);
    return judge();
  }

 private:
  void say(const std::string& line) const {
    if (!options_.json) print(line + "\n");
  }

  void say_resumed() const {
    if (file_->was_torn()) say("the last row was torn and is solved again");
    if (file_->done() == 0) return say("nothing to resume: starting with the first sample");
    const std::string count = std::to_string(file_->done()) + " of " + std::to_string(job_.plan.samples());
    say(count +
        (file_->complete() ? " samples were done before: nothing is left" : " samples were done before: going on"));
  }

  void solve() {
    std::optional<FileDesk> desk;
    if (ranks_.leads()) desk.emplace(job_.plan, *file_);
    const auto work = [&](GroupDesk& groups) {
      if (ranks_.size() == 1 && file_->complete()) return;
      const Statics assembled(job_.model);
      solve_groups(job_.model, assembled, job_.plan, options_.statics(), thread_count(options_.threads), groups,
                   [](const Progress&) { return !interrupted(); });
    };
    ranks_.share(job_.model, job_.plan, desk ? &*desk : nullptr, work);
    if (desk) desk->end_progress();
  }

  void tell(const WorkspaceReach& reach, double seconds) const {
    const Index converged = file_->count(Status::converged), limit = file_->count(Status::limit);
    if (options_.json) {
      nlohmann::ordered_json json;
      json["softkin"] = SOFTKIN_VERSION;
      json["scene"] = options_.scene;
      for (const auto& [key, value] : job_.head)
        if (key == "robot" || key == "solver" || key == "sampling") json[key] = value;
      json["samples"] = job_.plan.samples();
      json["converged"] = converged;
      json["limit"] = limit;
      json["not_converged"] = file_->count(Status::not_converged);
      reach.add_to(json);
      json["seconds"] = seconds;
      return print(json);
    }
    say(std::to_string(converged) + " of " + counted(static_cast<std::size_t>(job_.plan.samples()), "sample") +
        " converged; " + duration(seconds));
    say(reach.text());
  }

  [[nodiscard]] int stopped() const {
    const std::string text = "interrupted after " + std::to_string(file_->done()) + " of " +
                             counted(static_cast<std::size_t>(job_.plan.samples()), "sample") + "; they are in " +
                             options_.output + ", the same command with --resume goes on";
    std::fprintf(stderr, "softkin: %s\n", text.c_str());
    return not_converged;
  }

  [[nodiscard]] int judge() const {
    const auto complain = [&](Status status, const char* what) {
      if (const Index count = file_->count(status); count > 0)
        std::fprintf(stderr, "softkin: %d of %d samples %s (status %s); they are rows without values\n", count,
                     job_.plan.samples(), what, workspace_status(status));
    };
    complain(Status::limit, "have no equilibrium that could be followed to");
    complain(Status::not_converged, "did not converge");
    return file_->count(Status::converged) == job_.plan.samples() ? done : not_converged;
  }

  const WorkspaceOptions& options_;
  const Job& job_;
  const Ranks& ranks_;
  WorkspaceColumns columns_;
  std::optional<OutputFolders> folders_;
  std::optional<WorkspaceFile> file_;
};

int run_workspace(const WorkspaceOptions& options) {
  const Ranks ranks;
  try {
    std::optional<Job> job;
    std::optional<WorkspaceRun> run;
    ranks.together([&] {
      check_usage(options);
      job = read_job(options);
    });
    std::string text;
    for (const auto& [key, value] : job->head) text += key + ": " + value + "\n";
    ranks.agree_on(text);
    run.emplace(options, *job, ranks);
    catch_interrupt();
    ranks.together([&] {
      if (ranks.leads()) run->begin();
    });
    return run->run();
  } catch (const Silence&) {
    return bad_input;
  }
}

}  // namespace

void add_workspace(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("workspace", "Workspace: the equilibria of many actuations, and their reach");
  const auto options = std::make_shared<WorkspaceOptions>();
  add_options(*command, *options);
  command->footer(
      "Lengths are in mm, pressures in kPa (gauge), forces in N. Exit code: 0 done, 1 some samples have no "
      "equilibrium\n"
      "or interrupted, 2 bad usage or bad input.\n"
      "Example:\n"
      "  softkin workspace examples/three_tendon_finger/three_tendon_finger.yaml --samples 64 -o reach.csv");
  command->callback([options, &run] { run = [options] { return run_workspace(*options); }; });
}

}  // namespace softkin::cli
