#pragma once

#include <filesystem>
#include <optional>
#include <softkin/model/syringe_run.hpp>
#include <softkin/model/voltage_run.hpp>
#include <string>

namespace softkin {

/// Reads syringe tests, CSV: pressure p_abs_kpa, p_gauge_kpa, or p_kpa with `scale`; air pushed out of the syringe
/// dv_sy_mm3 or dv_sy_ml; run, t_s.
///
/// scale   of p_kpa; the name of another column must not contradict it
/// throws  InvalidInput naming file and line: other columns or units, no scale, rows that are not finite numbers
[[nodiscard]] std::vector<SyringeRun> read_syringe_runs(const std::filesystem::path& path,
                                                        std::optional<PressureScale> scale);

/// Reads tests of a dielectric elastomer, CSV: voltage_kv or voltage_v; area_ratio, or stretch (a ratio of lengths,
/// alike in both directions); run, t_s.
///
/// throws  InvalidInput naming file and line: other columns or units, voltages below 0, ratios not above 0
[[nodiscard]] std::vector<VoltageRun> read_voltage_runs(const std::filesystem::path& path);

/// "12.5mL", "800 mm3" or "60cm3" in mm^3. Throws InvalidInput, naming the option, on anything else.
[[nodiscard]] double read_volume(const std::string& option, const std::string& text);

}  // namespace softkin
