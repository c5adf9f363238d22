#pragma once

#include <softkin/model/model.hpp>
#include <vector>

namespace softkin::runs {

/// Boundary of what has substance: the body and dielectric elastomers, not the air in chambers; and sheets of layers
/// that no element has.
struct BodySurface {
  std::vector<Triangle> triangles;  // normals outwards; faces of order 2 as four
  std::vector<Index> elements;      // whose face each is of: the model's tetrahedra, then its prisms; -1: a sheet's
};

[[nodiscard]] BodySurface body_surface(const Model& model);

/// Has the element, as numbered there, substance?
[[nodiscard]] bool is_solid(const Model& model, std::size_t element);
[[nodiscard]] const ElementRole& role_of(const Model& model, std::size_t element);

}  // namespace softkin::runs
