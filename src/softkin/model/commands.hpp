#pragma once

#include <optional>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// One row of a file of commands.
struct CommandRow {
  Eigen::VectorXd actuation;  // per actuator of the model, as it is commanded: ratio [-], tension [N], pressure [kPa]
  Eigen::VectorXd pressures_kpa;  // per actuator; of chambers that are commanded by volume, where known
  std::optional<double> time_s;
  std::size_t line = 0;
};

/// What a robot is to do: at least one row, times all or none, increasing.
struct Commands {
  std::string file;
  std::vector<bool> commanded;       // per actuator: has it a column
  std::vector<bool> pressure_known;  // per actuator: do pressures_kpa hold it
  std::vector<CommandRow> rows;
};

}  // namespace softkin
