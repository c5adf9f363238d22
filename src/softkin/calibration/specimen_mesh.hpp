#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin::calibration {

/// A bar of two materials along x, from 0 to length; its axis is y = z = 0.
struct BarShape {
  double length_mm = 100, interface_mm = 50, width_mm = 20, height_mm = 10;
  int cells = 3;  // across the height, >= 1; the other edges are as near to this cell's as whole numbers allow
};

/// Linear tetrahedra, five to a cell, mirrored from cell to cell. Regions: volumes A (x < interface) and B, surfaces
/// base (x = 0), interface and free_end (x = length).
///
/// throws  InvalidInput on sizes that are not > 0, an interface that is not inside, fewer than one cell, or more than
///         a million tetrahedra
[[nodiscard]] Mesh bar_mesh(const BarShape& shape);

}  // namespace softkin::calibration
