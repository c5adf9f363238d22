#include "follow_resume.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <utility>

#include "fk_resume.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

class FollowReport {
 public:
  FollowReport(const Model& model, const FollowOptions& options, const MarkerPath& path)
      : model_(model),
        options_(options),
        path_(path),
        json_(Json::parse(read_file(options.report()), nullptr, false)) {}

  FollowedBefore take(Report& report) const {
    try {
      check_head(report.head());
      return take_steps(report);
    } catch (const Json::exception&) {
      refuse("it is not a report of softkin follow");
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput({options_.report().string()}, "--resume cannot go on from this report: " + why);
  }

  void check_head(const Json& head) const {
    const auto same = [&](const char* key) {  // whatever the order of keys
      return nlohmann::json(json_.at(key)) == nlohmann::json(head.at(key));
    };
    if (!same("softkin")) refuse("softkin " + json_.at("softkin").get<std::string>() + " wrote it");
    if (!same("robot_fingerprint")) refuse("it is of another robot, or the scene or its mesh has changed");
    for (const char* key : {"solver", "follow"})
      if (!same(key))
        refuse("it was made with other options: " + json_.at(key).dump() + " instead of " + head.at(key).dump());
  }

  /// Does the step answer to what the path asks for?
  void check_step(const Json& step, std::size_t i) const {
    if (i >= path_.waypoints.size())
      refuse("it has waypoint " + std::to_string(i) + ", but the path ends before; the path has changed");
    const Json &before = step.at("waypoint"), asked = asked_json(model_, path_, i);
    for (const auto& [key, value] : asked.items())
      if (!before.contains(key) || before.at(key) != value)
        refuse("waypoint " + std::to_string(i) + " is another one than in " + options_.path + "; the path has changed");
  }

  FollowedBefore take_steps(Report& report) const {
    FollowedBefore before;
    const Json& steps = json_.at("steps");
    for (std::size_t i = 0; i < steps.size(); ++i) check_step(steps.at(i), i);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const fs::path shape = series_file(options_.shapes(), i);
      std::optional<State> state = stored_state(model_, steps.at(i), shape);
      if (!state) {
        before.remark = shape.string() + " is missing or not the shape of the report";
        break;
      }
      before.done.push_back(done_waypoint(model_, path_, steps.at(i)));
      report.add(steps.at(i));
      before.state = std::move(*state);
    }
    return before;
  }

  const Model& model_;
  const FollowOptions& options_;
  const MarkerPath& path_;
  Json json_;
};

}  // namespace

Json follow_json(const FollowOptions& options) {
  return {{"method", options.method},
          {"tolerance_mm", options.reach_mm()},
          {"max_iterations", options.trajectory().inverse.max_iterations}};
}

FollowedBefore take_waypoints(const Model& model, const FollowOptions& options, const MarkerPath& path,
                              Report& report) {
  if (!fs::exists(options.report())) {
    FollowedBefore none;
    none.remark = "there is no " + options.report().string() + " yet";
    return none;
  }
  return FollowReport(model, options, path).take(report);
}

}  // namespace softkin::cli
