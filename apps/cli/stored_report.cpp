#include "stored_report.hpp"

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

/// What the step after that one starts from, as if it had just been solved; nothing where its shape is not there as it
/// was written.
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

}  // namespace

void add_shape(Json& step, const std::string& file, const Points& positions) {
  step["shape"] = file;
  step["shape_fingerprint"] = fingerprint_of(positions);
}

void StoredReport::refuse(const std::string& why) const {
  throw InvalidInput({file_.string()}, "--resume cannot go on from this report: " + why);
}

void StoredReport::check_head(const Json& json, const Json& head, const std::vector<std::string>& keys) const {
  const auto same = [&](const std::string& key) {  // whatever the order of keys
    return nlohmann::json(json.at(key)) == nlohmann::json(head.at(key));
  };
  if (!same("softkin")) refuse("softkin " + json.at("softkin").get<std::string>() + " wrote it");
  if (!same("robot_fingerprint")) refuse("it is of another robot, or the scene or its mesh has changed");
  const auto check = [&](const std::string& key, const std::string& what) {
    if (!same(key))
      refuse("it was made with other " + what + ": " + json.at(key).dump() + " instead of " + head.at(key).dump());
  };
  check("solver", "solver options");
  for (const std::string& key : keys) check(key, "options");
}

Finished StoredReport::take(Report& report, const std::vector<std::string>& keys,
                            const std::function<void(const Json& step, std::size_t i)>& check_step,
                            const std::function<void(const Json& step)>& keep) const {
  Finished finished;
  if (!fs::exists(file_)) {
    finished.remark = "there is no " + file_.string() + " yet";
    return finished;
  }
  try {
    const Json json = Json::parse(read_file(file_), nullptr, false);
    check_head(json, report.head(), keys);
    const Json& steps = json.at("steps");
    for (std::size_t i = 0; i < steps.size(); ++i) check_step(steps.at(i), i);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const fs::path shape = series_file(shapes_, i);
      std::optional<State> state = stored_state(model_, steps.at(i), shape);
      if (!state) {
        finished.remark = shape.string() + " is missing or not the shape of the report";
        break;
      }
      keep(steps.at(i));
      report.add(steps.at(i));
      finished.state = std::move(*state);
      ++finished.steps;
    }
  } catch (const Json::exception&) {
    refuse("it is not a report that this command wrote");
  }
  return finished;
}

}  // namespace softkin::cli
