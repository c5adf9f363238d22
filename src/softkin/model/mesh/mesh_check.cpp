#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <softkin/model/mesh/mesh_check.hpp>
#include <softkin/model/mesh/mesh_topology.hpp>
#include <unordered_map>

namespace softkin {

namespace {

constexpr double least_volume = 1e-9;  // over the cube of the longest edge
constexpr double same_vertex = 1e-9;   // over the diagonal of the bounding box

Vec3 row(const Points& points, Index i) {
  return points.row(i).transpose();
}

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.dot(b.cross(c));
}

/// Shifted and scaled into the unit cube, halved first so that no finite coordinates overflow.
Points normalised(const Points& vertices) {
  Points points = vertices / 2;
  if (points.rows() == 0) return points;
  const Eigen::RowVector3d low = points.colwise().minCoeff();
  points.rowwise() -= low;
  const double extent = points.maxCoeff();
  if (extent > 0) points /= extent;
  return points;
}

template <std::size_t K>
std::array<Vec3, K> corners_of(const Points& points, const std::array<Index, K>& element) {
  std::array<Vec3, K> corners;
  for (std::size_t i = 0; i < K; ++i) corners[i] = row(points, element[i]);
  return corners;
}

/// What the shape of one element amounts to; lengths relative to its longest edge.
struct Shape {
  double volume = 0;    // signed
  bool folded = false;  // the Jacobian changes its sign between the corners
  double quality = 0;
};

template <std::size_t K>
void scale_to_edge(std::array<Vec3, K>& p, const std::vector<std::array<std::size_t, 2>>& edges) {
  const Vec3 origin = p[0];
  double longest = 0;
  for (const auto& [a, b] : edges) longest = std::max(longest, (p[a] - p[b]).norm());
  for (Vec3& corner : p) corner = longest > 0 ? Vec3((corner - origin) / longest) : Vec3(Vec3::Zero());
}

Shape shape_of(const Points& points, const Tetrahedron& element) {
  static const std::vector<std::array<std::size_t, 2>> edges = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  std::array<Vec3, 4> p = corners_of(points, element);
  scale_to_edge(p, edges);
  const Vec3 &a = p[1], &b = p[2], &c = p[3];
  Shape shape;
  shape.volume = determinant(a, b, c) / 6;
  const double area = (a.cross(b).norm() + b.cross(c).norm() + c.cross(a).norm() + (b - a).cross(c - a).norm()) / 2;
  // inradius 3 V / area, circumradius |around| / (12 V)
  const Vec3 around = a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
  const double divisor = area * around.norm();
  if (divisor > 0) shape.quality = std::min(1.0, 108 * shape.volume * shape.volume / divisor);
  return shape;
}

Shape shape_of(const Points& points, const Prism& element) {
  static const std::vector<std::array<std::size_t, 2>> edges = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5},
                                                                {5, 3}, {0, 3}, {1, 4}, {2, 5}};
  std::array<Vec3, 6> p = corners_of(points, element);
  scale_to_edge(p, edges);
  Points corners(6, 3);
  for (Index i = 0; i < 6; ++i) corners.row(i) = p[static_cast<std::size_t>(i)].transpose();
  Shape shape;
  shape.volume = signed_volume(corners, Prism{0, 1, 2, 3, 4, 5});
  const double sign = shape.volume < 0 ? -1 : 1;
  shape.quality = 1;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t layer = i / 3 * 3, foot = i % 3;
    const Vec3 next = p[layer + (foot + 1) % 3] - p[i], previous = p[layer + (foot + 2) % 3] - p[i];
    const Vec3 up = p[foot + 3] - p[foot];
    const double jacobian = sign * determinant(next, previous, up);
    const double lengths = next.norm() * previous.norm() * up.norm();
    if (jacobian < least_volume) shape.folded = true;
    shape.quality = std::min(shape.quality, lengths > 0 ? 2 / std::sqrt(3.0) * jacobian / lengths : 0);
  }
  shape.quality = std::max(shape.quality, 0.0);
  return shape;
}

template <class Element>
void check_shapes(const Points& points, const std::vector<Element>& elements, Index first, MeshCheck& check) {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Shape shape = shape_of(points, elements[i]);
    const Index element = first + static_cast<Index>(i);
    if (std::abs(shape.volume) < least_volume || shape.folded)
      check.degenerate.push_back(element);
    else if (shape.volume < 0)
      check.negative.push_back(element);
    check.quality.push_back(shape.quality);
  }
}

struct Cell {
  std::int64_t x, y, z;
  bool operator==(const Cell&) const = default;
};

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t part : {cell.x, cell.y, cell.z}) {
      hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

/// Cells four tolerances wide: few vertices that differ fit into one, and few cells are within reach of a vertex.
std::vector<Index> duplicate_vertices(const Points& points) {
  std::vector<Index> duplicates;
  if (points.rows() == 0) return duplicates;
  const double tolerance = same_vertex * std::max(points.colwise().maxCoeff().norm(), 1e-3);
  const auto cell_at = [&](double coordinate) {
    return static_cast<std::int64_t>(std::floor(coordinate / (4 * tolerance)));
  };
  std::unordered_multimap<Cell, Index, CellHash> cells;
  cells.reserve(static_cast<std::size_t>(points.rows()));
  const auto has_twin = [&](const Vec3& p) {
    const Vec3 low = p.array() - tolerance, high = p.array() + tolerance;
    for (std::int64_t x = cell_at(low.x()); x <= cell_at(high.x()); ++x)
      for (std::int64_t y = cell_at(low.y()); y <= cell_at(high.y()); ++y)
        for (std::int64_t z = cell_at(low.z()); z <= cell_at(high.z()); ++z) {
          const auto [begin, end] = cells.equal_range({x, y, z});
          if (std::any_of(begin, end, [&](const auto& it) { return (row(points, it.second) - p).norm() <= tolerance; }))
            return true;
        }
    return false;
  };
  for (Index i = 0; i < points.rows(); ++i) {
    const Vec3 p = row(points, i);
    if (has_twin(p))
      duplicates.push_back(i);
    else
      cells.emplace(Cell{cell_at(p.x()), cell_at(p.y()), cell_at(p.z())}, i);
  }
  return duplicates;
}

}  // namespace

MeshCheck check_mesh(const Mesh& mesh) {
  MeshCheck check;
  const Points points = normalised(mesh.vertices);
  const auto prisms_from = static_cast<Index>(mesh.tetrahedra.size());
  check_shapes(points, mesh.tetrahedra, 0, check);
  check_shapes(points, mesh.prisms, prisms_from, check);
  check.duplicate_vertices = duplicate_vertices(points);
  check_topology(mesh, points, check);
  return check;
}

}  // namespace softkin
