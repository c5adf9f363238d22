#pragma once

#include <filesystem>
#include <optional>
#include <softkin/model/measurements.hpp>
#include <vector>

namespace softkin {

/// Of the specimen at rest; none: not given.
struct StripSize {
  std::optional<double> length_mm, area_mm2;  // length between the grips, area of the cross-section
};

/// Reads relaxation, creep and cyclic tests of a strip, CSV: t_s; strain, strain_percent, stretch or length_mm;
/// stress_mpa, stress_kpa or force_n; run. Strains and stresses are nominal, tension counts positive.
///
/// load_imposed  creep: the load was imposed, and the stretch answered
/// size          needed for length_mm and force_n
/// throws        InvalidInput naming file and line: other columns or units, times that do not ascend, a stretch that is
///               not above 0 or above 16, a size that is missing, a run of less than two rows
[[nodiscard]] std::vector<RelaxationRun> read_relaxation_runs(const std::filesystem::path& path, bool load_imposed,
                                                              const StripSize& size);

}  // namespace softkin
