#include "follow_run.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <softkin/io/file.hpp>
#include <softkin/io/svg_plot.hpp>
#include <softkin/io/vtk.hpp>
#include <utility>

#include "command.hpp"
#include "fk_files.hpp"
#include "fk_table.hpp"
#include "fk_units.hpp"
#include "follow_files.hpp"
#include "follow_resume.hpp"
#include "follow_table.hpp"
#include "mesh_text.hpp"
#include "plot_follow.hpp"
#include "stored_report.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

class FollowRun {
 public:
  FollowRun(const Model& model, const Statics& statics, const FollowOptions& options, const MarkerPath& path,
            const TrajectoryOptions& trajectory)
      : model_(model),
        options_(options),
        path_(path),
        follower_(model, statics, path, trajectory),
        report_(model, options),
        table_(model, path) {
    report_.note("follow", follow_json(options));
  }

  int run() {
    if (options_.resume) resume();
    const std::size_t first = done_.size();
    if (!follower_.done()) say(table_.header());
    FollowProgress progress(first, path_.waypoints.size());
    while (!follower_.done())
      if (!advance(progress)) {
        finish();
        return stopped();
      }
    finish();
    say(summary_of(done_, options_.reach_mm()));
    say("commands: " + options_.commands().string() + "; plot: " + options_.plot().string() +
        "; shapes: " + options_.shapes().string() + " (open it in ParaView)");
    return judge();
  }

 private:
  void say(const std::string& line) const {
    if (!options_.json) print(line + "\n");
  }

  void resume() {
    FollowedBefore before = take_waypoints(model_, options_, path_, report_);
    remove_torn_files(options_.outputs(path_.waypoints.size()));
    if (!before.remark.empty()) say(before.remark);
    if (before.done.empty()) return say("nothing to resume: starting with waypoint 0");
    done_ = std::move(before.done);
    follower_.resume(done_.size(), std::move(before.state));
    const std::string count = std::to_string(done_.size()) + " of " + counted(path_.waypoints.size(), "waypoint");
    say(count + (follower_.done() ? " were done before: nothing is left" : " were done before: going on"));
  }

  /// False where the user has interrupted it.
  bool advance(FollowProgress& progress) {
    const std::size_t i = follower_.next();
    if (interrupted()) return false;
    const InverseResult found = follower_.advance([&](const Progress& p) {
      progress.show(i, p);
      return !interrupted();
    });
    progress.clear();
    if (found.status == InverseStatus::interrupted) return false;
    keep(i, found);
    return true;
  }

  /// Shape first, report last: at any moment the report tells only of what is on disk.
  void keep(std::size_t i, const InverseResult& found) {
    const Points& positions = found.equilibrium.state.positions;
    const ElementDeformation deformation = deformation_of(model_, positions);
    Report::Json step = waypoint_json(model_, path_, i, found, deformation);
    const auto file = series_file(options_.shapes(), i);
    write_shape(file, model_, positions, deformation, found.equilibrium.report.status == Status::converged);
    add_shape(step, file.filename().string(), positions);
    done_.push_back(done_waypoint(model_, path_, step));
    report_.add(std::move(step));
    write_tables();
    write_file(options_.report(), report_.text());
    say(table_.row(i, done_.back()));
  }

  void write_tables() const {
    std::vector<PvdEntry> entries;
    for (std::size_t i = 0; i < done_.size(); ++i)
      entries.push_back({path_.waypoints[i].time.value_or(static_cast<double>(i)),
                         series_file(options_.shapes(), i).filename().string()});
    write_pvd(options_.shapes(), entries);
    write_file(options_.commands(), commands_csv(model_, path_, done_));
    write_file(options_.errors(), errors_csv(model_, path_, done_));
  }

  void finish() const {
    if (!done_.empty()) {
      write_tables();
      const auto name = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
      const std::string title =
          name(options_.path) + " by " + name(options_.scene) + ": " + formulation_name(model_.formulation);
      write_svg(options_.plot(), plot_of_path(model_, path_, done_, options_.reach_mm(), title));
    }
    if (options_.json) print(report_.text());
  }

  [[nodiscard]] int stopped() const {
    std::string text = "interrupted";
    if (done_.empty()) text += "; nothing was finished";
    if (!done_.empty())
      text += " after " + std::to_string(done_.size()) + " of " + counted(path_.waypoints.size(), "waypoint") +
              "; they are in " + options_.folder + ", the same command with --resume goes on";
    std::fprintf(stderr, "softkin: %s\n", text.c_str());
    return not_converged;
  }

  [[nodiscard]] int judge() const {
    const std::string missed = missed_text(done_);
    if (missed.empty()) return done;
    std::fprintf(stderr, "softkin: %s\n", missed.c_str());
    return not_converged;
  }

  const Model& model_;
  const FollowOptions& options_;
  const MarkerPath& path_;
  PathFollower follower_;
  Report report_;
  FollowTable table_;
  std::vector<DoneWaypoint> done_;
};

}  // namespace

int run_path(const Model& model, const Statics& statics, const FollowOptions& options, const MarkerPath& path,
             const TrajectoryOptions& trajectory) {
  return FollowRun(model, statics, options, path, trajectory).run();
}

}  // namespace softkin::cli
