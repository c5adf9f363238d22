#include <softkin/io/file.hpp>
#include <softkin/runs/plots.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/runs/run_tables.hpp>
#include <softkin/runs/walk_run.hpp>

namespace softkin::runs {

WalkRun::WalkRun(const Model& model, WalkTask task, const StaticsOptions& options, WalkFolder folder)
    : model_(model),
      task_(std::move(task)),
      folder_(std::move(folder)),
      walker_(model, options),
      job_(model, walker_, task_.steps, task_.gait),
      run_(model, job_, folder_.run(),
           walk_head(model, task_.scene, options, task_.gait, task_.cycles, walker_.direction()), {"feet"}) {}

Plot WalkRun::plot() {
  return plot_of_walk(model_, records(), plot_title(model_, task_.scene, task_.gait));
}

std::vector<double> WalkRun::note_strides() {
  const std::vector<double> lengths = strides(records(), task_.cycles);
  if (run_.done() > 0) run_.log().note("stride_mm", lengths);
  return lengths;
}

void WalkRun::finish() {
  if (run_.done() == 0) return;
  note_strides();
  run_.finish();
  if (!folder_.table().empty()) write_file(folder_.table(), walk_table(model_, records()).csv());
  if (!folder_.plot().empty()) write_svg(folder_.plot(), plot());
}

}  // namespace softkin::runs
