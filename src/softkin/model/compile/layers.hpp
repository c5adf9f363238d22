#pragma once

#include <softkin/model/layer.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>

namespace softkin {

struct Compilation;

/// Physical, after the loads: sheets on faces and surfaces, and their weight.
void compile_layers(Compilation& c);

/// With the nodes on its edges where the mesh is of order 2; -1 where nothing has an edge.
[[nodiscard]] CavityFace face_of(const Compilation& c, const Triangle& corners);

/// Where the strain of a face is looked at: of 3 nodes in the middle, of 6 at three points, exact for a strain that is
/// linear.
[[nodiscard]] const std::vector<TrianglePoint>& strain_points(std::size_t nodes);

/// A point of a face at rest, with the layer's directions.
///
/// throws  InvalidInput where the face has no area or the direction stands across it
struct LayerFrame {
  Vec3 normal = Vec3::Zero();
  Eigen::Matrix<double, 3, 2> axes;  // along the direction, and across it
  Eigen::Matrix2d back;              // from slopes by u and v to slopes along these [1/mm]
  double area_mm2 = 0;               // that the point stands for

  LayerFrame(const LayerSpec& spec, const TrianglePoint& point, const std::vector<Index>& nodes, const Points& rest);
};

/// Of a layer's faces, of order 2. Edges of one face, of more than two, and those folded by more than 120 degrees at
/// rest turn freely. A face that is held does not bend, and so clamps what is beside it.
///
/// fixed  per vertex and axis
void add_bending(const LayerSpec& spec, const Points& rest, const std::vector<std::array<bool, 3>>& fixed,
                 Layer& layer);

}  // namespace softkin
