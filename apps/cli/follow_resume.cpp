#include "follow_resume.hpp"

#include <utility>

#include "mesh_text.hpp"
#include "stored_report.hpp"

namespace softkin::cli {

Json follow_json(const FollowOptions& options) {
  return {{"method", options.method},
          {"tolerance_mm", options.reach_mm()},
          {"max_iterations", options.trajectory().inverse.max_iterations}};
}

FollowedBefore take_waypoints(const Model& model, const FollowOptions& options, const MarkerPath& path,
                              Report& report) {
  const StoredReport stored(model, options.report(), options.shapes());
  /// Does the step answer to what the path asks for?
  const auto check_step = [&](const Json& step, std::size_t i) {
    if (i >= path.waypoints.size())
      stored.refuse("it has waypoint " + std::to_string(i) + ", but the path ends before; the path has changed");
    const Json &before = step.at("waypoint"), asked = asked_json(model, path, i);
    for (const auto& [key, value] : asked.items())
      if (!before.contains(key) || before.at(key) != value)
        stored.refuse("waypoint " + std::to_string(i) + " is another one than in " + options.path +
                      "; the path has changed");
  };
  FollowedBefore before;
  Finished finished = stored.take(report, {"follow"}, check_step,
                                  [&](const Json& step) { before.done.push_back(done_waypoint(model, path, step)); });
  before.state = std::move(finished.state);
  before.remark = std::move(finished.remark);
  return before;
}

}  // namespace softkin::cli
