#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/runs/map_commands.hpp>

namespace softkin::runs {

namespace {

Index pressure_of(const MapData& data, const Actuator& chamber, const std::string& map_file) {
  const auto found = std::find_if(data.outputs.begin(), data.outputs.end(),
                                  [&](const MapOutput& output) { return output.name == chamber.name + "_pressure"; });
  if (found == data.outputs.end())
    throw InvalidInput({map_file}, "it has no pressure of '" + chamber.name +
                                       "': those come from the physical formulation, and from chambers that vary");
  return found - data.outputs.begin();
}

}  // namespace

void take_pressures(const Model& model, const KinematicMap& map, const std::string& map_file, Commands& commands) {
  const std::vector<std::size_t> chambers = chambers_without_pressures(model, commands, map_file);
  std::vector<std::size_t> reported;  // the others have a measured curve, which comes before the model
  std::vector<Index> outputs;
  for (const std::size_t a : chambers) {
    if (model.actuators[a].curve) continue;
    reported.push_back(a);
    outputs.push_back(pressure_of(map.data(), model.actuators[a], map_file));
    commands.pressure_known[a] = true;
  }
  Eigen::VectorXd values(map.outputs());
  for (CommandRow& row : commands.rows) {
    if (!map.evaluate(map.commands(row.actuation).data(), values.data()))
      throw InvalidInput({commands.file, row.line}, "this row is outside the map " + map_file);
    for (std::size_t i = 0; i < reported.size(); ++i) row.pressures_kpa[reported[i]] = values[outputs[i]];
  }
}

}  // namespace softkin::runs
