#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/disjoint_sets.hpp>
#include <softkin/model/mesh/mesh_check.hpp>
#include <span>
#include <unordered_map>

namespace softkin {

namespace {

constexpr double min_volume = 1e-9;   // over the cube of the longest edge
constexpr double same_vertex = 1e-9;  // over the diagonal of the bounding box

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
  for (std::size_t i = 0; i < K; ++i) corners[i] = vertex_at(points, element[i]);
  return corners;
}

/// Measures of the shape of one element; lengths relative to its longest edge.
struct Shape {
  double volume = 0;    // signed
  bool folded = false;  // the Jacobian changes its sign between the corners
  double quality = 0;
};

template <std::size_t K, std::size_t M>
void scale_to_edge(std::array<Vec3, K>& p, const int (&edges)[M][2]) {
  const Vec3 origin = p[0];
  double longest = 0;
  for (const auto& [a, b] : edges) longest = std::max(longest, (p[a] - p[b]).norm());
  for (Vec3& corner : p) corner = longest > 0 ? Vec3((corner - origin) / longest) : Vec3(Vec3::Zero());
}

Shape shape_of(const Points& points, const Tetrahedron& element) {
  std::array<Vec3, 4> p = corners_of(points, element);
  scale_to_edge(p, tetrahedron_edges);
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
  std::array<Vec3, 6> p = corners_of(points, element);
  scale_to_edge(p, prism_edges);
  Points corners(6, 3);
  for (Index i = 0; i < 6; ++i) corners.row(i) = p[i].transpose();
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
    if (jacobian < min_volume) shape.folded = true;
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
    if (std::abs(shape.volume) < min_volume || shape.folded)
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
    return hash;
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
  cells.reserve(points.rows());
  const auto has_twin = [&](const Vec3& p) {
    const Vec3 low = p.array() - tolerance, high = p.array() + tolerance;
    for (std::int64_t x = cell_at(low.x()); x <= cell_at(high.x()); ++x)
      for (std::int64_t y = cell_at(low.y()); y <= cell_at(high.y()); ++y)
        for (std::int64_t z = cell_at(low.z()); z <= cell_at(high.z()); ++z) {
          const auto [begin, end] = cells.equal_range({x, y, z});
          if (std::any_of(begin, end,
                          [&](const auto& it) { return (vertex_at(points, it.second) - p).norm() <= tolerance; }))
            return true;
        }
    return false;
  };
  for (Index i = 0; i < points.rows(); ++i) {
    const Vec3 p = vertex_at(points, i);
    if (has_twin(p))
      duplicates.push_back(i);
    else
      cells.emplace(Cell{cell_at(p.x()), cell_at(p.y()), cell_at(p.z())}, i);
  }
  return duplicates;
}

std::span<const Index> vertices_of(const Mesh& mesh, Index element) {
  const std::size_t i = element;
  if (i < mesh.tetrahedra.size()) return mesh.tetrahedra[i];
  return mesh.prisms[i - mesh.tetrahedra.size()];
}

Index element_count(const Mesh& mesh) {
  return mesh.tetrahedra.size() + mesh.prisms.size();
}

template <std::size_t K>
void find_duplicates(const std::vector<std::array<Index, K>>& elements, Index first, std::vector<Index>& duplicates) {
  std::vector<std::pair<std::array<Index, K>, Index>> sorted;
  sorted.reserve(elements.size());
  for (std::array<Index, K> element : elements) {
    std::sort(element.begin(), element.end());
    sorted.emplace_back(element, first + static_cast<Index>(sorted.size()));
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i].first == sorted[i - 1].first) duplicates.push_back(sorted[i].second);
}

class TopologyCheck {
 public:
  TopologyCheck(const Mesh& mesh, const Points& points, MeshCheck& check)
      : mesh_(mesh), points_(points), check_(check), kept_(element_count(mesh), true), solid_(kept_) {}

  void run() {
    find_duplicates(mesh_.tetrahedra, 0, check_.duplicate_elements);
    find_duplicates(mesh_.prisms, mesh_.tetrahedra.size(), check_.duplicate_elements);
    std::sort(check_.duplicate_elements.begin(), check_.duplicate_elements.end());
    for (const Index element : check_.duplicate_elements) kept_[element] = false;
    for (const Index element : check_.degenerate) solid_[element] = false;
    check_faces();
    check_edges();
    list_elements_of_vertices();
    find_edge_nodes();
    check_vertices();
    find_parts();
  }

 private:
  void check_faces() {
    ElementFaces faces = faces_of(mesh_.tetrahedra, mesh_.prisms);
    check_shared(faces.triangles, check_.nonmanifold_faces);
    check_shared(faces.quads, check_.nonmanifold_quads);
    sort_unique(check_.overlapping);
  }

  template <std::size_t K>
  void check_shared(std::vector<ElementFace<K>>& faces, std::vector<std::array<Index, K>>& nonmanifold) {
    std::erase_if(faces, [&](const ElementFace<K>& face) { return !kept_[face.owner]; });
    visit_same_faces(faces, [&](const ElementFace<K>* begin, const ElementFace<K>* end) {
      if (end == begin + 1) add_edges(begin->vertices);
      if (end > begin + 2) nonmanifold.push_back(begin->vertices);
      if (end > begin + 1) check_sides(begin, end);
    });
  }

  /// Among the elements at one face, pairs each with the first on its side.
  template <std::size_t K>
  void check_sides(const ElementFace<K>* begin, const ElementFace<K>* end) {
    Index first[2] = {-1, -1};
    for (const ElementFace<K>* face = begin; face != end; ++face) {
      if (!solid_[face->owner]) continue;
      const double height = height_over(begin->vertices, face->owner);
      if (height == 0) continue;
      Index& other = first[height > 0 ? 1 : 0];
      if (other < 0)
        other = face->owner;
      else if (other != face->owner)
        check_.overlapping.push_back({other, face->owner});
    }
  }

  /// Returns the height of an element's mean over the plane of one of its faces, times the face's size; the sign is the
  /// side of the face.
  template <std::size_t K>
  double height_over(const std::array<Index, K>& face, Index element) const {
    Vec3 p[K], foot = Vec3::Zero(), mean = Vec3::Zero();
    for (std::size_t i = 0; i < K; ++i) {
      p[i] = vertex_at(points_, face[i]);
      foot += p[i] / K;
    }
    const std::span<const Index> corners = vertices_of(mesh_, element);
    for (const Index corner : corners) mean += vertex_at(points_, corner) / double(corners.size());
    const Vec3 normal = K == 4 ? (p[2] - p[0]).cross(p[K - 1] - p[1]) : (p[1] - p[0]).cross(p[2] - p[0]);
    return normal.dot(mean - foot);
  }

  template <std::size_t K>
  void add_edges(const std::array<Index, K>& face) {
    for (std::size_t i = 0; i < K; ++i) {
      const auto [low, high] = std::minmax(face[i], face[(i + 1) % K]);
      boundary_edges_.push_back({low, high});
    }
  }

  void check_edges() {
    std::sort(boundary_edges_.begin(), boundary_edges_.end());
    for (std::size_t i = 0, j = 0; i < boundary_edges_.size(); i = j) {
      for (j = i + 1; j < boundary_edges_.size() && boundary_edges_[j] == boundary_edges_[i];) ++j;
      if (j > i + 2) check_.nonmanifold_edges.push_back(boundary_edges_[i]);
    }
  }

  void list_elements_of_vertices() {
    starts_.assign(points_.rows() + 1, 0);
    for (Index e = 0; e < element_count(mesh_); ++e)
      for (const Index v : vertices_of(mesh_, e)) ++starts_[v + 1];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    around_.resize(starts_.back());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (Index e = 0; e < element_count(mesh_); ++e)
      for (const Index v : vertices_of(mesh_, e)) around_[next[v]++] = e;
  }

  void find_edge_nodes() {
    on_edge_.assign(points_.rows(), false);
    for (const EdgeNodes& nodes : mesh_.edge_nodes)
      for (const Index v : nodes) on_edge_[v] = true;
  }

  /// Checks that the elements around a vertex are connected through further common vertices.
  void check_vertices() {
    std::vector<Index> seen_from(points_.rows(), -1), seen_by(seen_from);
    for (Index v = 0; v < points_.rows(); ++v) {
      const std::size_t begin = starts_[v], count = starts_[v + 1] - begin;
      if (count == 0 && !on_edge_[v]) check_.unreferenced.push_back(v);
      DisjointSets groups(count);
      for (std::size_t i = 0; i < count; ++i)
        for (const Index w : vertices_of(mesh_, around_[begin + i])) {
          if (w == v) continue;
          if (seen_from[w] == v) groups.join(i, seen_by[w]);
          seen_from[w] = v;
          seen_by[w] = i;
        }
      bool one = true;
      for (std::size_t i = 1; i < count; ++i) one = one && groups.find(i) == groups.find(0);
      if (!one) check_.nonmanifold_vertices.push_back(v);
    }
  }

  void find_parts() {
    const auto count = points_.rows();
    DisjointSets sets(count);
    for (Index e = 0; e < element_count(mesh_); ++e)
      for (const Index v : vertices_of(mesh_, e)) sets.join(v, vertices_of(mesh_, e)[0]);
    for (std::size_t t = 0; t < mesh_.edge_nodes.size(); ++t)
      for (const Index v : mesh_.edge_nodes[t]) sets.join(v, mesh_.tetrahedra[t][0]);
    std::vector<Index> part_of_root(count, -1);
    for (Index v = 0; v < points_.rows(); ++v) {
      if (starts_[v] == starts_[v + 1] && !on_edge_[v]) continue;
      Index& part = part_of_root[sets.find(v)];
      if (part < 0) {
        part = check_.parts.size();
        check_.parts.emplace_back();
      }
      check_.parts[part].push_back(v);
    }
    std::stable_sort(check_.parts.begin(), check_.parts.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
  }

  const Mesh& mesh_;
  const Points& points_;
  MeshCheck& check_;
  std::vector<bool> kept_;   // per element: not a duplicate
  std::vector<bool> solid_;  // per element: not degenerate
  std::vector<std::array<Index, 2>> boundary_edges_;
  std::vector<bool> on_edge_;        // per vertex: the node of an edge
  std::vector<std::size_t> starts_;  // of each vertex's elements in around_
  std::vector<Index> around_;
};

}  // namespace

MeshCheck check_mesh(const Mesh& mesh) {
  MeshCheck check;
  const Points points = normalised(mesh.vertices);
  const Index prisms_from = mesh.tetrahedra.size();
  check_shapes(points, mesh.tetrahedra, 0, check);
  check_shapes(points, mesh.prisms, prisms_from, check);
  check.duplicate_vertices = duplicate_vertices(points);
  TopologyCheck(mesh, points, check).run();
  return check;
}

namespace {

/// Faces by their smallest vertex, each as the two vertices that determine the others and the orientation. Sorting the
/// few faces at a vertex is several times faster than sorting all faces.
class FacesByVertex {
 public:
  explicit FacesByVertex(Index count) : starts_(count + 1) {}

  template <class Visit>
  void fill(const Visit& visit_faces) {
    visit_faces([&](Index smallest, std::uint64_t) { ++starts_[smallest + 1]; });
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    faces_.resize(starts_.back());
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    visit_faces([&](Index smallest, std::uint64_t rest) { faces_[next[smallest]++] = rest; });
  }

  bool has_twins() {
    for (std::size_t v = 0; v + 1 < starts_.size(); ++v) {
      const auto begin = faces_.begin() + starts_[v], end = faces_.begin() + starts_[v + 1];
      std::sort(begin, end);
      if (std::adjacent_find(begin, end) != end) return true;
    }
    return false;
  }

 private:
  std::vector<std::uint32_t> starts_;
  std::vector<std::uint64_t> faces_;
};

std::uint64_t packed(Index a, Index b) {
  return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
}

/// Visits each face with its smallest vertex and the two neighbours of that in the face, in its orientation. They also
/// determine a quad, as two faces of valid elements with three common vertices are the same.
template <std::size_t N, std::size_t K, std::size_t M, class Visit>
void visit_faces(const std::vector<std::array<Index, N>>& elements, const int (&faces)[M][K], const Visit& visit) {
  for (const std::array<Index, N>& element : elements)
    for (const auto& face : faces) {
      std::size_t first = 0;
      for (std::size_t i = 1; i < K; ++i)
        if (element[face[i]] < element[face[first]]) first = i;
      const auto corner = [&](std::size_t i) { return element[face[(first + i) % K]]; };
      visit(corner(0), packed(corner(1), corner(K - 1)));
    }
}

}  // namespace

bool have_common_side(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Tetrahedron>& more,
                      const std::vector<Prism>& prisms, Index count) {
  FacesByVertex triangles(count), quads(count);
  triangles.fill([&](const auto& visit) {
    visit_faces(tetrahedra, tetrahedron_faces, visit);
    visit_faces(more, tetrahedron_faces, visit);
    visit_faces(prisms, prism_triangles, visit);
  });
  if (triangles.has_twins()) return true;
  if (prisms.empty()) return false;
  quads.fill([&](const auto& visit) { visit_faces(prisms, prism_quads, visit); });
  return quads.has_twins();
}

}  // namespace softkin
