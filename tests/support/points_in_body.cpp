#include "support/points_in_body.hpp"

#include <Eigen/Geometry>
#include <map>

namespace softkin::testing {

namespace {

struct OwnedFace {
  Triangle face;
  std::size_t owner;
};

struct StraightCell {
  Tetrahedron corners;
  std::size_t owner;
};

/// Of an element and its nodes, corner 0 to 3 and edge node 01 to 23: the eight tetrahedra between them.
constexpr int eight[8][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3},
                             {4, 9, 6, 7}, {4, 9, 7, 8}, {4, 9, 8, 5}, {4, 9, 5, 6}};

std::vector<StraightCell> straight_cells(const std::vector<Tetrahedron>& tetrahedra,
                                         const std::vector<EdgeNodes>& edge_nodes) {
  std::vector<StraightCell> cells;
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    if (edge_nodes.empty()) {
      cells.push_back({tetrahedra[e], e});
      continue;
    }
    const auto node = [&](int i) { return i < 4 ? tetrahedra[e][i] : edge_nodes[e][i - 4]; };
    for (const auto& [a, b, c, d] : eight) cells.push_back({{node(a), node(b), node(c), node(d)}, e});
  }
  return cells;
}

/// Faces of one cell alone, normals outwards. Those within an element, or between two, are of two cells.
std::vector<OwnedFace> outer_faces(const std::vector<StraightCell>& cells) {
  std::map<Triangle, std::vector<OwnedFace>> faces;
  for (const StraightCell& cell : cells) {
    const auto [a, b, c, d] = cell.corners;
    for (const Triangle& face : {Triangle{a, c, b}, Triangle{a, b, d}, Triangle{b, c, d}, Triangle{a, d, c}}) {
      Triangle sorted = face;
      std::sort(sorted.begin(), sorted.end());
      faces[sorted].push_back({face, cell.owner});
    }
  }
  std::vector<OwnedFace> outer;
  for (const auto& [sorted, owned] : faces)
    if (owned.size() == 1) outer.push_back(owned.front());
  return outer;
}

double diagonal_of(const Points& positions, const std::vector<StraightCell>& cells) {
  Vec3 low = vertex_at(positions, cells.front().corners[0]), high = low;
  for (const StraightCell& cell : cells)
    for (const Index v : cell.corners) {
      low = low.cwiseMin(vertex_at(positions, v));
      high = high.cwiseMax(vertex_at(positions, v));
    }
  return (high - low).norm();
}

std::vector<CoveredFace> points_outside(const Points& positions, const std::vector<StraightCell>& cells) {
  std::vector<CoveredFace> points;
  const double offset = 1e-6 * diagonal_of(positions, cells);
  for (const OwnedFace& outer : outer_faces(cells)) {
    const Vec3 a = vertex_at(positions, outer.face[0]), b = vertex_at(positions, outer.face[1]),
               c = vertex_at(positions, outer.face[2]);
    const Vec3 normal = (b - a).cross(c - a);
    if (normal.norm() > 0)
      points.push_back({outer.face, outer.owner, 0, (a + b + c) / 3 + offset * normal.normalized()});
  }
  return points;
}

bool holds(const std::array<Vec3, 4>& x, const Vec3& p) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
  };
  const double parts[] = {volume(p, x[1], x[2], x[3]), volume(x[0], p, x[2], x[3]), volume(x[0], x[1], p, x[3]),
                          volume(x[0], x[1], x[2], p)};
  const auto [least, most] = std::minmax_element(std::begin(parts), std::end(parts));
  return (*least >= 0 && *most > 0) || (*most <= 0 && *least < 0);
}

}  // namespace

std::vector<CoveredFace> covered_faces(const Points& positions, const std::vector<Tetrahedron>& tetrahedra,
                                       const std::vector<EdgeNodes>& edge_nodes) {
  const std::vector<StraightCell> cells = straight_cells(tetrahedra, edge_nodes);
  if (cells.empty()) return {};
  std::vector<CoveredFace> points = points_outside(positions, cells);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.where.x() < b.where.x(); });
  std::map<Triangle, CoveredFace> covered;
  for (const StraightCell& cell : cells) {
    std::array<Vec3, 4> x;
    for (int i = 0; i < 4; ++i) x[i] = vertex_at(positions, cell.corners[i]);
    const Vec3 low = x[0].cwiseMin(x[1]).cwiseMin(x[2]).cwiseMin(x[3]);
    const Vec3 high = x[0].cwiseMax(x[1]).cwiseMax(x[2]).cwiseMax(x[3]);
    const auto first = std::lower_bound(points.begin(), points.end(), low.x(),
                                        [](const CoveredFace& point, double left) { return point.where.x() < left; });
    for (auto point = first; point != points.end() && point->where.x() <= high.x(); ++point) {
      if ((point->where.array() < low.array()).any() || (point->where.array() > high.array()).any()) continue;
      if (!holds(x, point->where)) continue;
      point->inside = cell.owner;
      covered.try_emplace(point->face, *point);
    }
  }
  std::vector<CoveredFace> found;
  for (const auto& [face, point] : covered) found.push_back(point);
  return found;
}

}  // namespace softkin::testing
