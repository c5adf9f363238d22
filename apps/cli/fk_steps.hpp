#pragma once

#include <cstddef>
#include <optional>
#include <softkin/io/csv.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

#include "fk_options.hpp"

namespace softkin::cli {

/// One actuation to solve for.
struct Step {
  Actuation actuation;
  std::optional<double> time;  // [s], where the path has times
  std::size_t line = 0;        // of the path
};

/// The steps of --path, or the one of --set. Actuators that neither names keep their rest value.
/// Throws InvalidInput naming option, or file and line.
[[nodiscard]] std::vector<Step> asked_steps(const Model& model, const FkOptions& options);

/// The steps of a table of commands that was read from a file: what --path takes. Throws InvalidInput naming file and
/// line.
[[nodiscard]] std::vector<Step> path_steps(const Model& model, const std::string& file, CsvTable table);

/// Whose command a column of such a table holds: the actuator's that it names, with the unit of its load if it has one.
[[nodiscard]] std::optional<Index> actuator_of_column(const Model& model, const std::string& column);

}  // namespace softkin::cli
