#include "map_use.hpp"

#include <softkin/core/error.hpp>
#include <softkin/kinematics/map_robot.hpp>
#include <softkin/runs/map_file.hpp>

namespace softkin::cli {

namespace {

std::optional<KinematicMap> asked_map(const Model& model, const std::string& file) {
  if (file.empty()) return std::nullopt;
  MapData data = runs::read_map(file);
  runs::check_robot(data, model, file);
  return KinematicMap(std::move(data));
}

Statics statics_of(const Model& model, const std::optional<KinematicMap>& map, bool polish) {
  if (!map) return Statics(model);
  return {model, shapes_of(model, *map), polish ? Given::starts : Given::answers};
}

}  // namespace

void add_map_use(CLI::App& command, MapUse& use) {
  add_value(command, "--map", use.map, "F.skmap",
            "Kinematic map of the robot (softkin map): answers in its place,\nin microseconds, within the errors that "
            "it tells");
  command.add_flag("--polish", use.polish, "With --map: the solver goes on from the map's answers");
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
    : map_(asked_map(model, use.map)), statics_(statics_of(model, map_, use.polish)) {
  if (map_)
    remark_ = use.map + ": " + runs::map_text(map_->data()) + (use.polish ? "; polished by the solver" : "") + "\n";
}

}  // namespace softkin::cli
