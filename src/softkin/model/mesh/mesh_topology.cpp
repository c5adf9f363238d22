#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/mesh_topology.hpp>
#include <utility>

namespace softkin {

namespace {

struct Corners {
  const Index* begin_;
  const Index* end_;
  [[nodiscard]] const Index* begin() const { return begin_; }
  [[nodiscard]] const Index* end() const { return end_; }
};

Corners corners_of(const Mesh& mesh, Index element) {
  const auto i = static_cast<std::size_t>(element);
  if (i < mesh.tetrahedra.size()) return {mesh.tetrahedra[i].data(), mesh.tetrahedra[i].data() + 4};
  const Prism& prism = mesh.prisms[i - mesh.tetrahedra.size()];
  return {prism.data(), prism.data() + 6};
}

Index element_count(const Mesh& mesh) {
  return static_cast<Index>(mesh.tetrahedra.size() + mesh.prisms.size());
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

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), Index{0}); }

  Index find(Index i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  void join(Index a, Index b) { parent(find(a)) = find(b); }

 private:
  Index& parent(Index i) { return parents_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parents_;
};

template <std::size_t K>
struct Face {
  std::array<Index, K> sorted, vertices;
  Index owner;
};

class TopologyCheck {
 public:
  TopologyCheck(const Mesh& mesh, const Points& points, MeshCheck& check)
      : mesh_(mesh), points_(points), check_(check), kept_(size(element_count(mesh)), true), solid_(kept_) {}

  void run() {
    find_duplicates(mesh_.tetrahedra, 0, check_.duplicate_elements);
    find_duplicates(mesh_.prisms, static_cast<Index>(mesh_.tetrahedra.size()), check_.duplicate_elements);
    std::sort(check_.duplicate_elements.begin(), check_.duplicate_elements.end());
    for (const Index element : check_.duplicate_elements) kept_[size(element)] = false;
    for (const Index element : check_.degenerate) solid_[size(element)] = false;
    check_faces();
    check_edges();
    list_elements_of_vertices();
    find_edge_nodes();
    check_vertices();
    find_parts();
  }

 private:
  static std::size_t size(Index i) { return static_cast<std::size_t>(i); }

  template <std::size_t K, std::size_t N, std::size_t M>
  void collect(const std::vector<std::array<Index, N>>& elements, Index first, const int (&faces)[M][K],
               std::vector<Face<K>>& all) const {
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const Index owner = first + static_cast<Index>(e);
      if (!kept_[size(owner)]) continue;
      for (const auto& corners : faces) {
        Face<K> face;
        for (std::size_t i = 0; i < K; ++i) face.vertices[i] = elements[e][static_cast<std::size_t>(corners[i])];
        face.sorted = face.vertices;
        std::sort(face.sorted.begin(), face.sorted.end());
        face.owner = owner;
        all.push_back(face);
      }
    }
  }

  void check_faces() {
    const auto prisms_from = static_cast<Index>(mesh_.tetrahedra.size());
    std::vector<Face<3>> triangles;
    triangles.reserve(4 * mesh_.tetrahedra.size() + 2 * mesh_.prisms.size());
    collect(mesh_.tetrahedra, 0, tetrahedron_faces, triangles);
    collect(mesh_.prisms, prisms_from, prism_triangles, triangles);
    check_shared(triangles, check_.nonmanifold_faces);
    std::vector<Face<4>> quads;
    quads.reserve(3 * mesh_.prisms.size());
    collect(mesh_.prisms, prisms_from, prism_quads, quads);
    check_shared(quads, check_.nonmanifold_quads);
    std::sort(check_.overlapping.begin(), check_.overlapping.end());
    check_.overlapping.erase(std::unique(check_.overlapping.begin(), check_.overlapping.end()),
                             check_.overlapping.end());
  }

  template <std::size_t K>
  void check_shared(std::vector<Face<K>>& faces, std::vector<std::array<Index, K>>& nonmanifold) {
    std::sort(faces.begin(), faces.end(), [](const Face<K>& a, const Face<K>& b) {
      return a.sorted != b.sorted ? a.sorted < b.sorted : a.owner < b.owner;
    });
    for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
      for (j = i + 1; j < faces.size() && faces[j].sorted == faces[i].sorted;) ++j;
      if (j == i + 1) add_edges(faces[i].vertices);
      if (j > i + 2) nonmanifold.push_back(faces[i].vertices);
      if (j > i + 1) check_sides(&faces[i], &faces[i] + (j - i));
    }
  }

  /// Among the elements at one face, pairs each with the first on its side.
  template <std::size_t K>
  void check_sides(const Face<K>* begin, const Face<K>* end) {
    Index first[2] = {-1, -1};
    for (const Face<K>* face = begin; face != end; ++face) {
      if (!solid_[size(face->owner)]) continue;
      const double height = height_over(begin->vertices, face->owner);
      if (height == 0) continue;
      Index& other = first[height > 0 ? 1 : 0];
      if (other < 0)
        other = face->owner;
      else if (other != face->owner)
        check_.overlapping.push_back({other, face->owner});
    }
  }

  /// Height of an element's mean over the plane of one of its faces, times the face's size: its sign tells the side.
  template <std::size_t K>
  double height_over(const std::array<Index, K>& face, Index element) const {
    Vec3 p[K], foot = Vec3::Zero(), mean = Vec3::Zero();
    for (std::size_t i = 0; i < K; ++i) {
      p[i] = points_.row(face[i]).transpose();
      foot += p[i] / K;
    }
    const Corners corners = corners_of(mesh_, element);
    for (const Index corner : corners)
      mean += points_.row(corner).transpose() / double(corners.end() - corners.begin());
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
    starts_.assign(size(static_cast<Index>(points_.rows())) + 1, 0);
    for (Index e = 0; e < element_count(mesh_); ++e)
      for (const Index v : corners_of(mesh_, e)) ++starts_[size(v) + 1];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    around_.resize(starts_.back());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (Index e = 0; e < element_count(mesh_); ++e)
      for (const Index v : corners_of(mesh_, e)) around_[next[size(v)]++] = e;
  }

  void find_edge_nodes() {
    on_edge_.assign(size(static_cast<Index>(points_.rows())), false);
    for (const EdgeNodes& nodes : mesh_.edge_nodes)
      for (const Index v : nodes) on_edge_[size(v)] = true;
  }

  /// Elements around a vertex belong together where they share another vertex.
  void check_vertices() {
    std::vector<Index> seen_from(size(static_cast<Index>(points_.rows())), -1), seen_by(seen_from);
    for (Index v = 0; v < points_.rows(); ++v) {
      const std::size_t begin = starts_[size(v)], count = starts_[size(v) + 1] - begin;
      if (count == 0 && !on_edge_[size(v)]) check_.unreferenced.push_back(v);
      DisjointSets groups(count);
      for (std::size_t i = 0; i < count; ++i)
        for (const Index w : corners_of(mesh_, around_[begin + i])) {
          if (w == v) continue;
          if (seen_from[size(w)] == v) groups.join(static_cast<Index>(i), seen_by[size(w)]);
          seen_from[size(w)] = v;
          seen_by[size(w)] = static_cast<Index>(i);
        }
      bool one = true;
      for (std::size_t i = 1; i < count; ++i) one = one && groups.find(static_cast<Index>(i)) == groups.find(0);
      if (!one) check_.nonmanifold_vertices.push_back(v);
    }
  }

  void find_parts() {
    const auto count = size(static_cast<Index>(points_.rows()));
    DisjointSets sets(count);
    for (Index e = 0; e < element_count(mesh_); ++e)
      for (const Index v : corners_of(mesh_, e)) sets.join(v, *corners_of(mesh_, e).begin());
    for (std::size_t t = 0; t < mesh_.edge_nodes.size(); ++t)
      for (const Index v : mesh_.edge_nodes[t]) sets.join(v, mesh_.tetrahedra[t][0]);
    std::vector<Index> part_of_root(count, -1);
    for (Index v = 0; v < points_.rows(); ++v) {
      if (starts_[size(v)] == starts_[size(v) + 1] && !on_edge_[size(v)]) continue;
      Index& part = part_of_root[size(sets.find(v))];
      if (part < 0) {
        part = static_cast<Index>(check_.parts.size());
        check_.parts.emplace_back();
      }
      check_.parts[size(part)].push_back(v);
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

void check_topology(const Mesh& mesh, const Points& points, MeshCheck& check) {
  TopologyCheck(mesh, points, check).run();
}

}  // namespace softkin
