#include "walk_resume.hpp"

#include <optional>
#include <utility>

#include "mesh_text.hpp"
#include "stored_report.hpp"

namespace softkin::cli {

namespace {

bool is_asked(const Model& model, const Json& step, const Step& asked) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (step.at("actuation").at(model.actuators[a].name).get<double>() != asked.actuation[static_cast<Index>(a)])
      return false;
  return step.contains("time_s") == asked.time.has_value() &&
         (!asked.time || step.at("time_s").get<double>() == *asked.time);
}

}  // namespace

Json feet_json(const Model& model) {
  Json feet = Json::array();
  for (std::size_t i = 0; i < model.feet.size(); ++i)
    feet.push_back({{"marker", foot_name(model, i)},
                    {"forward_N", model.feet[i].forward},
                    {"backward_N", model.feet[i].backward}});
  return feet;
}

WalkedBefore take_walk(const Model& model, const WalkOptions& options, const std::vector<GaitStep>& steps,
                       Report& report) {
  const StoredReport stored(model, options.report(), options.shapes());
  const auto check_step = [&](const Json& step, std::size_t i) {
    if (i >= steps.size())
      stored.refuse("it has step " + std::to_string(i) + ", but " + counted(options.cycles, "cycle") + " of " +
                    options.gait + " end before");
    if (!is_asked(model, step, steps[i].asked))
      stored.refuse("step " + std::to_string(i) + " is another one than in " + options.gait + "; the gait has changed");
  };
  WalkedBefore before;
  Finished finished = stored.take(report, {"feet"}, check_step, [&](const Json& step) {
    before.done.push_back({steps[before.done.size()], walked(model, step)});
  });
  before.state = std::move(finished.state);
  before.remark = std::move(finished.remark);
  return before;
}

}  // namespace softkin::cli
