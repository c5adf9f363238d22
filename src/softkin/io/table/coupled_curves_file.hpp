#pragma once

#include <filesystem>
#include <softkin/model/coupled_curves.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// Reads a table of measured chambers: columns air1_pressure_kPa (gauge) and air1 (its ratio) for each, a row for every
/// combination of the pressures, in any order.
///
/// throws  InvalidInput naming file and line: fewer than two chambers, a column of something else or without its
///         partner, a combination that is missing or stands twice, a ratio that does not rise with its own pressure
[[nodiscard]] CoupledCurves read_coupled_curves(const Model& model, const std::filesystem::path& path);

}  // namespace softkin
