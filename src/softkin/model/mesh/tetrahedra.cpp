#include <softkin/model/mesh/tetrahedra.hpp>

namespace softkin {

namespace {

// Orders that put corner i first and keep the prism's orientation.
constexpr int prism_turns[6][6] = {{0, 1, 2, 3, 4, 5}, {1, 2, 0, 4, 5, 3}, {2, 0, 1, 5, 3, 4},
                                   {3, 5, 4, 0, 2, 1}, {4, 3, 5, 1, 0, 2}, {5, 4, 3, 2, 1, 0}};

}  // namespace

std::array<Tetrahedron, 3> split(const Prism& prism) {
  const auto first = std::min_element(prism.begin(), prism.end()) - prism.begin();
  Prism p;
  for (int i = 0; i < 6; ++i) p[i] = prism[prism_turns[first][i]];
  const Tetrahedron last{p[0], p[4], p[5], p[3]};
  if (std::min(p[1], p[5]) < std::min(p[2], p[4]))
    return {Tetrahedron{p[0], p[1], p[2], p[5]}, Tetrahedron{p[0], p[1], p[5], p[4]}, last};
  return {Tetrahedron{p[0], p[1], p[2], p[4]}, Tetrahedron{p[0], p[4], p[2], p[5]}, last};
}

std::array<Tetrahedron, 8> split(const Tetrahedron& corners, const EdgeNodes& edge_nodes) {
  const auto [a, b, c, d] = corners;
  const auto [ab, bc, ac, ad, bd, cd] = edge_nodes;
  return {Tetrahedron{a, ab, ac, ad},  Tetrahedron{ab, b, bc, bd},  Tetrahedron{ac, bc, c, cd},
          Tetrahedron{ad, bd, cd, d},  Tetrahedron{ac, bd, ab, bc}, Tetrahedron{ac, bd, bc, cd},
          Tetrahedron{ac, bd, cd, ad}, Tetrahedron{ac, bd, ad, ab}};
}

std::vector<Bounds> bounds_of(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<Bounds> bounds(tetrahedra.size());
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
    for (const Index v : tetrahedra[i]) bounds[i].extend(vertex_at(vertices, v));
  return bounds;
}

Barycentric barycentric(const Vec3 (&corners)[4], const Vec3& point) {
  const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[0], c = corners[3] - corners[0],
             offset = point - corners[0];
  const Vec3 bc = b.cross(c), ca = c.cross(a), ab = a.cross(b);
  const double six_volumes = a.dot(bc);
  Barycentric w(0, offset.dot(bc) / six_volumes, offset.dot(ca) / six_volumes, offset.dot(ab) / six_volumes);
  w[0] = 1 - w[1] - w[2] - w[3];
  return w;
}

}  // namespace softkin
