#pragma once

#include <softkin/calibration/specimen_evaluation.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>

namespace softkin::calibration {

// The results, for people and programs. Files have no part of them where a simulation is not converged.

[[nodiscard]] std::string specimens_text(const SpecimenTask& task, const SpecimenResults& results);
[[nodiscard]] std::string specimens_json(const SpecimenTask& task, const SpecimenResults& results);
[[nodiscard]] Plot specimens_plot(const SpecimenTask& task, const SpecimenResults& results);
[[nodiscard]] Table residual_table(const SpecimenResults& results);
/// The materials of a scene, YAML.
[[nodiscard]] std::string specimens_fragment(const SpecimenTask& task, const SpecimenResults& results);

}  // namespace softkin::calibration
