#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace softkin {

/// A bar of two materials, A up to the interface and B beyond, held at A's end and stretched at B's (Fang et al. 2020,
/// Fig. 7a).
struct StretchedSpecimen {
  double length_mm = 0;            // L, > 0
  double interface_mm = 0;         // L_1, from the fixed end, 0 < L_1 < L
  double stretch_mm = 0;           // Delta L, > 0
  double interface_moved_mm = 0;   // Delta L_1, 0 < Delta L_1 < Delta L
  std::optional<double> force_n;   // of the testing machine, > 0
  std::optional<double> area_mm2;  // of the cross-section at rest, > 0
  std::size_t line = 0;            // of the file; 0: not from a file
};

/// Such a bar, its free end turned about the axis of the bar (Fig. 7d).
struct TwistedSpecimen {
  double length_mm = 0, interface_mm = 0;  // as above
  double twist_deg = 0;                    // of the free end, 0 < twist
  std::optional<double> interface_deg;     // turn of the interface; none: not measured
  std::size_t line = 0;
};

/// A tensile test of one material: nominal strain [-], strictly ascending from 0 or more, and nominal stress [MPa].
struct TensileCurve {
  std::vector<double> strain, stress;
  std::vector<std::size_t> lines;  // of the file; empty: not from a file
};

}  // namespace softkin
