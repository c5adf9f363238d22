#pragma once

#include <softkin/model/commands.hpp>
#include <softkin/model/model.hpp>
#include <string>

namespace softkin {

/// Reads a file of commands, and the pressures of chambers that are commanded by volume: from columns air_pressure_kPa,
/// or from the report of the run that made the commands (empty: none).
///
/// throws  InvalidInput naming file and line: what fk --path refuses; pressures of other actuators or given twice; a
///         report of other commands
[[nodiscard]] Commands read_commands(const Model& model, const std::string& file, const std::string& report);

}  // namespace softkin
