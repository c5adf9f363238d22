#include <algorithm>
#include <softkin/model/mesh/boundary.hpp>

namespace softkin {

namespace {

template <std::size_t K>
struct Face {
  std::array<Index, K> sorted, vertices;
  Index owner;
};

template <std::size_t K>
Face<K> make_face(const Index* element, const int* corners, Index owner) {
  Face<K> face;
  for (std::size_t i = 0; i < K; ++i) face.vertices[i] = element[corners[i]];
  face.sorted = face.vertices;
  std::sort(face.sorted.begin(), face.sorted.end());
  face.owner = owner;
  return face;
}

template <std::size_t K>
void keep_single(std::vector<Face<K>>& faces, std::vector<std::array<Index, K>>& vertices, std::vector<Index>& owners) {
  std::sort(faces.begin(), faces.end(), [](const Face<K>& a, const Face<K>& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.owner < b.owner;
  });
  std::vector<const Face<K>*> single;
  for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
    for (j = i + 1; j < faces.size() && faces[j].sorted == faces[i].sorted;) ++j;
    if (j == i + 1) single.push_back(&faces[i]);
  }
  std::sort(single.begin(), single.end(), [](const Face<K>* a, const Face<K>* b) {
    return a->owner != b->owner ? a->owner < b->owner : a->sorted < b->sorted;
  });
  for (const Face<K>* face : single) {
    vertices.push_back(face->vertices);
    owners.push_back(face->owner);
  }
}

}  // namespace

Boundary boundary_of(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms) {
  std::vector<Face<3>> triangles;
  std::vector<Face<4>> quads;
  triangles.reserve(4 * tetrahedra.size() + 2 * prisms.size());
  quads.reserve(3 * prisms.size());
  Index owner = 0;
  for (const Tetrahedron& t : tetrahedra) {
    for (const auto& corners : tetrahedron_faces) triangles.push_back(make_face<3>(t.data(), corners, owner));
    ++owner;
  }
  for (const Prism& p : prisms) {
    for (const auto& corners : prism_triangles) triangles.push_back(make_face<3>(p.data(), corners, owner));
    for (const auto& corners : prism_quads) quads.push_back(make_face<4>(p.data(), corners, owner));
    ++owner;
  }
  Boundary boundary;
  keep_single(triangles, boundary.triangles, boundary.triangle_owners);
  keep_single(quads, boundary.quads, boundary.quad_owners);
  return boundary;
}

std::vector<Triangle> triangulated(const Boundary& boundary, std::vector<Index>* owners) {
  std::vector<Triangle> triangles = boundary.triangles;
  if (owners) *owners = boundary.triangle_owners;
  for (std::size_t i = 0; i < boundary.quads.size(); ++i) {
    const Quad& q = boundary.quads[i];
    triangles.push_back({q[0], q[1], q[2]});
    triangles.push_back({q[0], q[2], q[3]});
    if (owners) owners->insert(owners->end(), 2, boundary.quad_owners[i]);
  }
  return triangles;
}

}  // namespace softkin
