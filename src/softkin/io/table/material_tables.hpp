#pragma once

#include <filesystem>
#include <softkin/model/material_tests.hpp>

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

/// A tensile test, its loading branch: columns strain or strain_percent, and stress_mpa; both nominal.
///
/// throws  InvalidInput as above; strains below 0 or that do not ascend, above 15 (1500 %), fewer than five rows, no
///         stress > 0
[[nodiscard]] TensileCurve read_tensile_curve(const std::filesystem::path& path);

}  // namespace softkin
