#pragma once

#include <algorithm>
#include <numeric>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

/// Corners of the faces of an element, in the order that makes the normal point outwards.
inline constexpr int tetrahedron_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
inline constexpr int prism_triangles[2][3] = {{0, 2, 1}, {3, 4, 5}};
inline constexpr int prism_quads[3][4] = {{0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};

/// A face of an element: its vertices in that order, and sorted. Elements are numbered tetrahedra first, then prisms.
template <std::size_t K>
struct ElementFace {
  std::array<Index, K> sorted, vertices;
  Index owner;
};

struct ElementFaces {
  std::vector<ElementFace<3>> triangles;
  std::vector<ElementFace<4>> quads;
};

/// The faces of every element, by elements.
[[nodiscard]] ElementFaces faces_of(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms);

/// By ascending vertices, then owners. Indices must not be negative.
template <std::size_t K>
void sort_faces(std::vector<ElementFace<K>>& faces) {
  // into buckets of the first vertex, which hold a few faces each
  std::vector<std::size_t> end(1);
  for (const auto& face : faces) {
    const std::size_t first = face.sorted[0];
    if (first + 1 >= end.size()) end.resize(first + 2);
    ++end[first + 1];
  }
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<ElementFace<K>> sorted(faces.size());
  for (const auto& face : faces) sorted[end[face.sorted[0]]++] = face;
  const auto at = [&sorted](std::size_t i) { return sorted.begin() + static_cast<std::ptrdiff_t>(i); };
  for (std::size_t bucket = 0, begin = 0; bucket + 1 < end.size(); begin = end[bucket++])
    std::sort(at(begin), at(end[bucket]), [](const auto& a, const auto& b) {
      return a.sorted != b.sorted ? a.sorted < b.sorted : a.owner < b.owner;
    });
  faces = std::move(sorted);
}

/// Sorts the faces and calls visit(begin, end) for those of the same vertices, by ascending owners.
template <std::size_t K, class Visit>
void visit_same_faces(std::vector<ElementFace<K>>& faces, const Visit& visit) {
  sort_faces(faces);
  for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
    for (j = i + 1; j < faces.size() && faces[j].sorted == faces[i].sorted;) ++j;
    visit(faces.data() + i, faces.data() + j);
  }
}

/// Faces that belong to exactly one of the elements, with normals outwards (for positively oriented elements), and
/// whose face it is.
struct Boundary {
  std::vector<Triangle> triangles;
  std::vector<Index> triangle_owners;
  std::vector<Quad> quads;
  std::vector<Index> quad_owners;
};

[[nodiscard]] Boundary boundary_of(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Prism>& prisms);

/// The boundary as triangles, quads split along their first diagonal; owners (if given) run along.
[[nodiscard]] std::vector<Triangle> triangulated(const Boundary& boundary, std::vector<Index>* owners = nullptr);

}  // namespace softkin
