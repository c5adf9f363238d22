#include "map_use.hpp"

#include <softkin/core/error.hpp>
#include <softkin/kinematics/map_robot.hpp>
#include <softkin/runs/map_file.hpp>

#include "run_text.hpp"

namespace softkin::cli {

namespace {

Statics statics_of(const Model& model, const std::optional<KinematicMap>& map, bool polish) {
  if (!map) return Statics(model);
  return {model, shapes_of(model, *map), polish ? Given::starts : Given::answers};
}

}  // namespace

KinematicMap read_map_of(const Model& model, const std::string& file) {
  MapData data = runs::read_map(file);
  runs::check_robot(data, model, file);
  return KinematicMap(std::move(data));
}

void add_map_use(CLI::App& command, MapUse& use) {
  add_value(command, "--map", use.map, "F.skmap",
            "Kinematic map of the robot (softkin map): answers in its place,\nin microseconds, within the errors that "
            "it tells");
  command.add_flag("--polish", use.polish,
                   "With --map: the solver goes on from the map's answers, to its\nown accuracy");
}

void check_map_use(const MapUse& use, const SolveOptions& options, std::vector<std::filesystem::path>& inputs) {
  if (use.map.empty()) {
    if (use.polish) throw InvalidInput("--polish goes on from the answers of a map: it needs --map F.skmap");
    return;
  }
  inputs.emplace_back(use.map);
  const SolveOptions usual;
  const bool changed = options.solver_name != usual.solver_name || options.tolerance_mm != usual.tolerance_mm ||
                       options.max_iterations != usual.max_iterations || options.stable;
  if (changed && !use.polish)
    throw InvalidInput("a map answers without the solver: --map with the solver's options needs --polish");
}

Answers::Answers(const Model& model, const MapUse& use)
    : model_(model),
      map_(use.map.empty() ? std::nullopt : std::optional(read_map_of(model, use.map))),
      statics_(statics_of(model, map_, use.polish)) {
  if (map_) used_.emplace(runs::UsedMap{use.map, map_->data(), use.polish});
}

std::string Answers::solver(const SolveOptions& options) const {
  return used_ && !used_->polished ? "" : options.solver_name;
}

std::string Answers::head(const SolveOptions& options) const {
  std::string text = options.scene + ": " + summary(model_, solver(options)) + "\n";
  if (used_)
    text += (used_->polished ? "begun from the map " : "answered by the map ") + used_->file + ": " +
            runs::map_text(used_->data) + "\n";
  return text;
}

InverseResult Answers::inverse(const std::vector<Goal>& goals, const Actuation& start, const InverseOptions& options,
                               const ProgressCallback& progress) const {
  if (used_ && used_->polished) return solve_inverse_by_map(model_, *map_, statics_, goals, start, options, progress);
  return solve_inverse_from(model_, statics_, goals, start, options, progress);
}

}  // namespace softkin::cli
