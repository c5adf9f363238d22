#include "fk_resume.hpp"

#include <filesystem>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/vtk.hpp>
#include <utility>

#include "fk_fingerprint.hpp"
#include "fk_units.hpp"
#include "output_files.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;
using Json = Report::Json;

namespace {

/// The shape of a step as it was written, or nothing.
std::optional<Points> stored_shape(const Json& step, const fs::path& file) {
  try {
    Points positions = read_vtu_points(file);
    if (fingerprint_of(positions) == step.at("shape_fingerprint").get<std::string>()) return positions;
  } catch (const InvalidInput&) {  // not there or damaged: the step is solved again
  }
  return std::nullopt;
}

class ReportOnDisk {
 public:
  ReportOnDisk(const Model& model, const FkOptions& options, const std::vector<Step>& asked)
      : model_(model),
        options_(options),
        asked_(asked),
        json_(Json::parse(read_file(options.report), nullptr, false)) {}

  Finished take(Report& report) const {
    try {
      check_head(report.head());
      return take_steps(report);
    } catch (const Json::exception&) {
      refuse("it is not a report that softkin wrote");
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InvalidInput({options_.report}, "--resume cannot go on from this report: " + why);
  }

  void check_head(const Json& head) const {
    const auto same = [&](const char* key) {  // whatever the order of keys
      return nlohmann::json(json_.at(key)) == nlohmann::json(head.at(key));
    };
    if (!same("softkin")) refuse("softkin " + json_.at("softkin").get<std::string>() + " wrote it");
    if (!same("robot_fingerprint")) refuse("it is of another robot, or the scene or its mesh has changed");
    if (!same("solver"))
      refuse("it was made with other solver options: " + json_.at("solver").dump() + " instead of " +
             head.at("solver").dump());
  }

  void check_step(const Json& step, std::size_t i) const {
    const std::string number_of_step = "step " + std::to_string(i);
    if (i >= asked_.size())
      refuse("it has " + number_of_step + ", but " + options_.path + " ends before; the path has changed");
    const std::string where = options_.path + ":" + std::to_string(asked_[i].line);
    const Json& actuation = step.at("actuation");
    if (actuation.size() != model_.actuators.size()) refuse(number_of_step + " has other actuators");
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      const std::string& name = model_.actuators[a].name;
      const double before = actuation.at(name).get<double>(), now = asked_[i].actuation[static_cast<Index>(a)];
      if (before != now)
        refuse(number_of_step + " was solved for " + name + " = " + command_text(model_.actuators[a], before, 12) +
               ", but " + where + " asks for " + command_text(model_.actuators[a], now, 12) + "; the path has changed");
    }
    const std::optional<double> time =
        step.contains("time_s") ? std::optional(step.at("time_s").get<double>()) : std::nullopt;
    if (time != asked_[i].time) refuse(number_of_step + " has another time than " + where + "; the path has changed");
  }

  Finished take_steps(Report& report) const {
    Finished finished;
    const Json& steps = json_.at("steps");
    for (std::size_t i = 0; i < steps.size(); ++i) check_step(steps.at(i), i);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      std::optional<State> state = stored_state(model_, steps.at(i), series_file(options_.output, i));
      if (!state) {
        finished.remark = series_file(options_.output, i).string() + " is missing or not the shape of the report";
        break;
      }
      report.add(steps.at(i));
      finished.state = std::move(*state);
      ++finished.steps;
    }
    return finished;
  }

  const Model& model_;
  const FkOptions& options_;
  const std::vector<Step>& asked_;
  Json json_;
};

}  // namespace

std::optional<State> stored_state(const Model& model, const Json& step, const fs::path& shape) {
  std::optional<Points> positions = stored_shape(step, shape);
  if (!positions) return std::nullopt;
  State result{std::move(*positions), {}, Eigen::VectorXd::Zero(static_cast<Index>(model.actuators.size()))};
  if (model.formulation == Formulation::physical) result.share = step.at("shape_load_share").get<double>();
  const Json& actuation = step.at("shape_actuation");
  if (!actuation.is_null()) result.actuation = Actuation::Zero(result.multipliers.size());
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const auto i = static_cast<Index>(a);
    if (!actuation.is_null()) result.actuation[i] = actuation.at(actuator.name).get<double>();
    const std::string key = multiplier_key(actuator);
    if (model.formulation == Formulation::physical && !key.empty())
      result.multipliers[i] = step.at("actuators").at(actuator.name).at(key).get<double>();
  }
  return result;
}

void add_shape(Json& step, const std::string& file, const Points& positions) {
  step["shape"] = file;
  step["shape_fingerprint"] = fingerprint_of(positions);
}

Finished take_finished(const Model& model, const FkOptions& options, const std::vector<Step>& steps, Report& report) {
  if (!fs::exists(options.report)) {
    Finished none;
    none.remark = "there is no " + options.report + " yet";
    return none;
  }
  return ReportOnDisk(model, options, steps).take(report);
}

}  // namespace softkin::cli
