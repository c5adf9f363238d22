#pragma once

#include <memory>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/shapes.hpp>
#include <variant>

namespace softkin {

class SurfaceTree;  // mesh/surface_tree.hpp

// Selectors choose vertices (inside or on the boundary) and elements (centroid inside); shapes are in mm.
struct VertexList {
  std::vector<Index> vertices;  // from 0
};
struct ElementList {              // of the mesh
  std::vector<Index> tetrahedra;  // from 0
};
/// Everything inside a closed surface.
struct InsideSurface {
  std::shared_ptr<const SurfaceTree> surface;  // [mm]
};
/// The selection of a selector from a robot before joined() placed it among others.
struct Chosen {
  std::string kind;  // for messages: "box of robot 'left'"
  Region region;     // what was chosen, in the numbers of the robot's own mesh
};
using Selector =
    std::variant<Box, Sphere, Cylinder, Halfspace, InsideSurface, VertexList, ElementList, Chosen>;  // how to choose

/// A region by name, or a shape in its place.
struct RegionRef {
  std::variant<std::string, Selector> region;  // its name, or how to choose it
  Origin origin;                               // of the entry, for messages
};

/// A point by coordinates [mm], or the mean of a region (volume- or area-weighted) by its name.
struct PointRef {
  std::variant<Vec3, std::string> point;  // where it is, or the region's name
  Origin origin;                          // of the entry, for messages
  std::string robot{};                    // of several: whose elements carry the coordinates along; empty: the nearest
};

}  // namespace softkin
