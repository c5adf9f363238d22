#include "walk_resume.hpp"

#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <utility>

#include "fk_resume.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

class WalkReport {
 public:
  WalkReport(const Model& model, const WalkOptions& options, const std::vector<GaitStep>& steps)
      : model_(model),
        options_(options),
        steps_(steps),
        json_(Json::parse(read_file(options.report()), nullptr, false)) {}

  WalkedBefore take(Report& report) const {
    try {
      check_head(report.head());
      return take_steps(report);
    } catch (const Json::exception&) {
      refuse("it is not a report of softkin walk");
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput({options_.report().string()}, "--resume cannot go on from this report: " + why);
  }

  void check_head(const Json& head) const {
    const auto same = [](const Json& a, const Json& b) { return nlohmann::json(a) == nlohmann::json(b); };
    if (!same(json_.at("softkin"), head.at("softkin")))
      refuse("softkin " + json_.at("softkin").get<std::string>() + " wrote it");
    if (!same(json_.at("robot_fingerprint"), head.at("robot_fingerprint")))
      refuse("it is of another robot, or the scene or its mesh has changed");
    if (!same(json_.at("walk").at("feet"), head.at("walk").at("feet"))) refuse("the feet have changed");
    if (!same(json_.at("solver"), head.at("solver")))
      refuse("it was made with other options: " + json_.at("solver").dump() + " instead of " +
             head.at("solver").dump());
  }

  [[nodiscard]] bool is_asked(const Json& step, const GaitStep& asked) const {
    const Json& actuation = step.at("actuation");
    for (std::size_t a = 0; a < model_.actuators.size(); ++a)
      if (actuation.at(model_.actuators[a].name).get<double>() != asked.asked.actuation[static_cast<Index>(a)])
        return false;
    const std::optional<double>& time = asked.asked.time;
    return step.contains("time_s") == time.has_value() && (!time || step.at("time_s").get<double>() == *time);
  }

  WalkedBefore take_steps(Report& report) const {
    WalkedBefore before;
    const Json& steps = json_.at("steps");
    if (steps.size() > steps_.size())
      refuse("it has " + counted(steps.size(), "step") + ", and " + counted(options_.cycles, "cycle") + " of " +
             options_.gait + " have " + std::to_string(steps_.size()));
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (!is_asked(steps.at(i), steps_[i]))
        refuse("step " + std::to_string(i) + " is another one than in " + options_.gait + "; the gait has changed");
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const fs::path shape = series_file(options_.shapes(), i);
      std::optional<State> state = stored_state(model_, steps.at(i), shape);
      if (!state) {
        before.remark = shape.string() + " is missing or not the shape of the report";
        break;
      }
      before.done.push_back({steps_[i], walked(model_, steps.at(i))});
      report.add(steps.at(i));
      before.state = std::move(*state);
    }
    return before;
  }

  const Model& model_;
  const WalkOptions& options_;
  const std::vector<GaitStep>& steps_;
  Json json_;
};

}  // namespace

Json feet_json(const Model& model) {
  Json feet = Json::array();
  for (const Foot& foot : model.feet)
    feet.push_back({{"marker", model.markers[static_cast<std::size_t>(foot.marker)].name},
                    {"forward_N", foot.forward},
                    {"backward_N", foot.backward}});
  return feet;
}

WalkedBefore take_walk(const Model& model, const WalkOptions& options, const std::vector<GaitStep>& steps,
                       Report& report) {
  if (!fs::exists(options.report())) {
    WalkedBefore none;
    none.remark = "there is no " + options.report().string() + " yet";
    return none;
  }
  return WalkReport(model, options, steps).take(report);
}

}  // namespace softkin::cli
