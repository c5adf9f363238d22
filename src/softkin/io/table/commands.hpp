#pragma once

#include <cstddef>
#include <optional>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/paths.hpp>
#include <string>
#include <vector>

namespace softkin {

struct CsvTable;  // io/table/csv.hpp

/// One actuation to solve for.
struct ActuationStep {
  Actuation actuation;           // m: a command for each actuator
  std::optional<double> time{};  // [s], where the path has times
  std::size_t line = 0;          // of the path's file
};

/// A table of commands: a column per actuator (air, air_kPa, or by its curve air_kPa_abs, skin_kV) and t_s, a row per
/// step. Actuators without a column stay at their setting, or at rest.
///
/// throws  InvalidInput naming file and line, or the setting of an actuator that has a column too
[[nodiscard]] std::vector<ActuationStep> read_actuation_path(const Model& model, const std::string& file,
                                                             const Settings& settings);

/// The same of a table that was read already.
[[nodiscard]] std::vector<ActuationStep> actuation_steps(const Model& model, const CsvTable& table,
                                                         const Settings& settings);

/// Whose command a column of such a table holds: the actuator's that it names, with the unit of its load if it has one.
[[nodiscard]] std::optional<Index> actuator_of_column(const Model& model, const std::string& column);

/// Reads a file of commands, and the pressures of chambers that are commanded by volume: from columns air_pressure_kPa,
/// from columns that command by a measured curve (air_kPa), or from the report of the run that made the commands
/// (empty: none), where a measured curve's comes before the model's; or, where that ends in .csv, from a measured table
/// of coupled chambers (coupled_curves_file.hpp).
///
/// throws  InvalidInput naming file and line: what fk --path refuses; pressures of other actuators or given twice; a
///         report of other commands
[[nodiscard]] Commands read_commands(const Model& model, const std::string& file, const std::string& report);

/// Actuators whose pressures the commands lack: the chambers that they command by volume.
///
/// file    that has pressures, for messages
/// throws  InvalidInput naming it: there is none, or the commands have pressures already
[[nodiscard]] std::vector<std::size_t> chambers_without_pressures(const Model& model, const Commands& commands,
                                                                  const std::string& file);

}  // namespace softkin
