#pragma once

#include <softkin/model/mesh/mesh.hpp>

namespace softkin::testing {

/// A face of the boundary whose outer side is inside the body.
struct CoveredFace {
  Triangle face;           // its vertices; of order 2 those of one of its four parts
  std::size_t owner = 0;   // the element that it belongs to
  std::size_t inside = 0;  // one that its point lies in
  Vec3 where;              // the point [mm]
};

/// Whether a body passes through itself: a point just outside each face of its boundary must lie in no element.
///
/// point      the centroid of the face, moved outwards by 1e-6 of the diagonal of the body's bounding box; of order 2
///            that of each of the four triangles between its nodes; faces without area have none
/// inside     in one of the element's straight tetrahedra, of which order 2 has eight, be it turned inside out or not.
///            So a body with inverted elements may cover faces of their neighbours
/// unseen     what enters between the points
/// positions  #V by 3 [mm], finite
/// elements   positively oriented at rest, so that it is known where outside is
/// edge_nodes of every tetrahedron, or empty
/// returns    by faces
[[nodiscard]] std::vector<CoveredFace> covered_faces(const Points& positions,
                                                     const std::vector<Tetrahedron>& tetrahedra,
                                                     const std::vector<EdgeNodes>& edge_nodes = {});

}  // namespace softkin::testing
