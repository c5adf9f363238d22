#pragma once

#include <softkin/core/error.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/shapes.hpp>
#include <variant>
#include <vector>

namespace softkin {

/// A surface onto which nodes of a mesh of order 2 are moved [mm]; of a cylinder the side between its ends.
struct GivenSurface {
  std::variant<Sphere, Cylinder, TriangleSurface> shape;  // the surface itself
  Origin origin;                                          // of its entry, for messages
};

/// How the edges of a mesh of order 2 are curved.
struct CurveSpec {
  std::vector<GivenSurface> surfaces{};  // each takes the edges of the mesh's surface both of whose ends lie on it
  bool smooth = false;                   // the others go onto a smooth surface through the vertices
  double crease_degrees = 50;            // of that: where faces turn by more is a crease; > 0, <= 120
  Origin origin{};                       // of the entry, for messages
};

}  // namespace softkin
