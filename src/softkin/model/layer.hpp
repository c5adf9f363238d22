#pragma once

#include <softkin/core/sheet_law.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// A sheet on faces of the body, or where there is no body: its mid-surface is the faces themselves.
struct LayerSpec {
  std::string name;                                // for messages and reports
  std::variant<RegionRef, TriangleSurface> where;  // faces of the mesh; or a surface that elements carry along [mm]
  double thickness_mm = 0;                         // > 0
  double e1 = 0, e2 = 0, g12 = 0;                  // [MPa], > 0, along and across the direction
  double nu12 = 0;                                 // strain across over that along, pulled along [-]
  std::optional<SheetRubber> rubber{};             // in place of these
  std::optional<Vec3> direction;                   // laid onto the faces; none: it does not matter, e1 = e2
  bool tension_only = false;                       // wrinkles instead of being pressed
  bool bending = false;                            // does it resist being bent
  double density = 0;                              // [kg/m^3], >= 0
  std::string robot{};                             // of several: whose elements; empty: all
  Origin origin{};                                 // of its entry, for messages
};

/// A place of a layer, of whose area it stands for some.
struct LayerPlace {
  std::vector<Index> vertices;          // that carry it along: of the element or face
  std::vector<double> weights;          // of them: where it is
  std::vector<Eigen::Vector2d> slopes;  // of them [1/mm]: F = sum of x slope^T, 3 by 2, in the layer's directions
  double area_mm2 = 0;                  // at rest
};

/// A place of a layer that bends: x_1, x_2, x_11, x_22 and x_12 by its directions are sums of parts of its vertices.
struct LayerBend {
  std::vector<Index> vertices;                     // of the face
  std::vector<Eigen::Matrix<double, 5, 1>> parts;  // of each vertex, in the order x_1, x_2, x_11, x_22, x_12
  BendingPlace place;                              // what is stored there
};

/// A place of an edge between two faces of a layer: of either side x_1, x_2 and what its moment is of.
struct LayerJoint {
  /// One of the two faces.
  struct Side {
    std::vector<Index> vertices;  // of the face
    std::vector<Vec3> parts;      // of each vertex: its parts of x_1 [1/mm], of x_2 [1/mm] and of the moment
  };
  std::array<Side, 2> sides;  // which meet at the edge
  BendingJoint joint;         // what is stored there
};

/// A compiled sheet.
struct Layer {
  std::string name;                // for messages and reports
  double thickness_mm = 0;         // at rest [mm]
  SheetLaw law;                    // what it is made of
  std::vector<LayerPlace> places;  // over its area, with which its energy is integrated
  std::vector<LayerBend> bends;    // where it resists bending
  std::vector<LayerJoint> joints;  // the same
  std::vector<CavityFace> faces;   // of the mesh, for pictures; none where elements carry it along
};

/// Of its elements, or where it has none of its sheets: 1 or 2.
[[nodiscard]] int order_of(const Model& model);

/// A face as flat triangles: itself, or of order 2 quarters().
[[nodiscard]] std::vector<Triangle> flat_triangles(const CavityFace& face);

/// Per vertex: is it of an element, edge nodes too. Sheets beside the body have others.
[[nodiscard]] std::vector<bool> vertices_of_elements(const Model& model);

}  // namespace softkin
