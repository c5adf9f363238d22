#pragma once

#include <cstddef>
#include <optional>
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

}  // namespace softkin::cli
