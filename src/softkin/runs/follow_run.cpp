#include <softkin/io/file.hpp>
#include <softkin/runs/follow_run.hpp>
#include <softkin/runs/plots.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/run_tables.hpp>

namespace softkin::runs {

FollowRun::FollowRun(const Model& model, const Statics& statics, FollowTask task, const TrajectoryOptions& options,
                     FollowFolder folder)
    : model_(model),
      task_(std::move(task)),
      tolerance_mm_(options.inverse.tolerance_mm),
      folder_(std::move(folder)),
      job_(model, statics, task_.path, task_.file, options),
      run_(model, job_, folder_.run(), follow_head(model, task_.scene, options, task_.map), {"follow"}) {}

Table FollowRun::commands() {
  return commands_table(model_, task_.path, records());
}

Table FollowRun::errors() {
  return errors_table(model_, task_.path, records());
}

Plot FollowRun::plot() {
  return plot_of_path(model_, task_.path, records(), tolerance_mm_, plot_title(model_, task_.scene, task_.file));
}

void FollowRun::finish() {
  if (run_.done() == 0) return;
  run_.finish();
  if (!folder_.commands().empty()) write_file(folder_.commands(), commands().csv());
  if (!folder_.errors().empty()) write_file(folder_.errors(), errors().csv());
  if (!folder_.plot().empty()) write_svg(folder_.plot(), plot());
}

}  // namespace softkin::runs
