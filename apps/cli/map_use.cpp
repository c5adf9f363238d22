#include "map_use.hpp"

#include <algorithm>
#include <softkin/core/error.hpp>

#include "run_text.hpp"

namespace softkin::cli {

void add_map_use(CLI::App& command, MapUse& use) {
  add_value(command, "--map", use.map, "F.skmap",
            "Kinematic map of the robot (softkin map): answers in its place,\nin microseconds, within the errors that "
            "it tells");
  command.add_flag("--polish", use.polish,
                   "With --map: the solver continues from the map's answers, to its\nown accuracy");
}

void check_map_use(const MapUse& use, const SolveOptions& options, std::vector<std::filesystem::path>& inputs) {
  if (use.map.empty()) {
    if (use.polish) throw InvalidInput("--polish continues from the answers of a map: it needs --map F.skmap");
    return;
  }
  inputs.emplace_back(use.map);
  const SolveOptions usual;
  const bool changed = options.solver_name != usual.solver_name || options.tolerance_mm != usual.tolerance_mm ||
                       options.max_iterations != usual.max_iterations || options.stable || options.instant ||
                       !options.tuning_file.empty();
  if (changed && !use.polish)
    throw InvalidInput("a map answers without the solver: --map with the solver's options needs --polish");
}

void check_times(const Model& model, const std::string& path, const SolveOptions& options, const MapUse& use) {
  if (options.instant)
    throw InvalidInput("--instant: " + path + " has times (t_s), so that the material relaxes by them; leave one out");
  const auto is_viscous = [](const Material& material) { return !material.viscosity.empty(); };
  if (use.map.empty() || use.polish ||
      std::none_of(model.elements.materials.begin(), model.elements.materials.end(), is_viscous))
    return;
  throw InvalidInput("a map knows relaxed shapes alone, and " + path +
                     " has times (t_s) by which the material relaxes: --map needs --polish, or the times left out");
}

std::string head_text(const Model& model, const SolveOptions& options, const runs::Answers& answers) {
  return options.scene + ": " + runs::model_summary(model, answers.by_map_alone() ? "" : options.solver_name) + "\n" +
         answers.remark();
}

}  // namespace softkin::cli
