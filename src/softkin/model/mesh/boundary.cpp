#include <softkin/model/mesh/boundary.hpp>

namespace softkin {

namespace {

template <std::size_t K, std::size_t N, std::size_t M>
void append_faces(const std::array<Index, N>& element, const int (&faces)[M][K], Index owner,
                  std::vector<ElementFace<K>>& all) {
  for (const auto& corners : faces) {
    ElementFace<K> face;
    for (std::size_t i = 0; i < K; ++i) face.vertices[i] = element[corners[i]];
    face.sorted = face.vertices;
    std::sort(face.sorted.begin(), face.sorted.end());
    face.owner = owner;
    all.push_back(face);
  }
}

template <std::size_t K>
void keep_single(std::vector<ElementFace<K>>& faces, std::vector<std::array<Index, K>>& vertices,
                 std::vector<Index>& owners) {
  using Face = ElementFace<K>;
  std::vector<const Face*> single;
  visit_same_faces(faces, [&](const Face* begin, const Face* end) {
    if (end == begin + 1) single.push_back(begin);
  });
  std::sort(single.begin(), single.end(), [](const Face* a, const Face* b) {
    return a->owner != b->owner ? a->owner < b->owner : a->sorted < b->sorted;
  });
  for (const Face* face : single) {
    vertices.push_back(face->vertices);
    owners.push_back(face->owner);
  }
}

}  // namespace

ElementFaces faces_of(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms) {
  ElementFaces faces;
  faces.triangles.reserve(4 * tetrahedra.size() + 2 * prisms.size());
  faces.quads.reserve(3 * prisms.size());
  Index owner = 0;
  for (const Tetrahedron& t : tetrahedra) append_faces(t, tetrahedron_faces, owner++, faces.triangles);
  for (const Prism& p : prisms) {
    append_faces(p, prism_triangles, owner, faces.triangles);
    append_faces(p, prism_quads, owner++, faces.quads);
  }
  return faces;
}

Boundary boundary_of(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms) {
  ElementFaces faces = faces_of(tetrahedra, prisms);
  Boundary boundary;
  keep_single(faces.triangles, boundary.triangles, boundary.triangle_owners);
  keep_single(faces.quads, boundary.quads, boundary.quad_owners);
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
