#pragma once

#include <filesystem>
#include <optional>
#include <softkin/model/measurements.hpp>
#include <string>

namespace softkin {

/// Stretched specimens, a row each: columns l_mm, l1_mm, dl_mm, dl1_mm; force_n and area_mm2 where they were measured.
///
/// throws  InvalidInput naming file, line and column: another unit, an unknown or missing column, a length that is not
///         0 < l1 < l or 0 < dl1 < dl, a force or area that is not > 0
[[nodiscard]] std::vector<StretchedSpecimen> read_stretched_specimens(const std::filesystem::path& path);

/// Twisted specimens: columns l_mm, l1_mm, twist_deg; interface_deg where it was measured.
///
/// throws  InvalidInput as above; a twist that is not > 0 and at most 180
[[nodiscard]] std::vector<TwistedSpecimen> read_twisted_specimens(const std::filesystem::path& path);

/// A tensile test, its loading branch: columns strain or strain_percent, and stress_mpa; both nominal. Files of testing
/// machines: as read_tensile_file() with a layout that names nothing.
///
/// throws  InvalidInput as above; strains below 0 or that do not ascend, above 15 (1500 %), fewer than five rows, no
///         stress > 0
[[nodiscard]] TensileCurve read_tensile_curve(const std::filesystem::path& path);

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
