#include <algorithm>
#include <array>
#include <softkin/model/mesh/element_order.hpp>
#include <softkin/model/mesh/mesh_findings.hpp>
#include <softkin/model/mesh/mesh_measures.hpp>

namespace softkin {

namespace {

constexpr std::size_t most_places = 5;
constexpr double farthest = 0.25, even = 1e-3;  // of an edge's node from its middle, shares of its length

/// The edges of tetrahedra of order 2 that are wrong or uneven: vertices, an edge's ends first, then its node.
struct EdgeCheck {
  std::vector<EdgeWithNode> far;            // nodes further than a quarter of the edge's length from its middle
  std::vector<EdgeWithNode> uneven;         // the others that are further than a thousandth of it
  std::vector<std::array<Index, 4>> split;  // edges on which tetrahedra have different nodes; two of these
  std::vector<Index> shared;                // nodes of several edges
};

/// Nodes that stand on several edges, once each.
std::vector<Index> shared_nodes(const std::vector<EdgeWithNode>& edges) {
  std::vector<Index> nodes, shared;
  nodes.reserve(edges.size());
  for (const auto& edge : edges) nodes.push_back(edge[2]);
  std::sort(nodes.begin(), nodes.end());
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i] == nodes[i - 1] && (shared.empty() || shared.back() != nodes[i])) shared.push_back(nodes[i]);
  return shared;
}

EdgeCheck check_edges(const Mesh& mesh) {
  EdgeCheck check;
  const std::vector<EdgeWithNode> edges = edges_with_nodes(mesh);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto& [a, b, node] = edges[i];
    const Vec3 start = mesh.vertices.row(a), end = mesh.vertices.row(b), at = mesh.vertices.row(node);
    const double distance = (at - (start + end) / 2).norm(), length = (end - start).norm();
    if (distance > farthest * length)
      check.far.push_back(edges[i]);
    else if (distance > even * length)
      check.uneven.push_back(edges[i]);
    if (i > 0 && edges[i - 1][0] == a && edges[i - 1][1] == b) check.split.push_back({a, b, edges[i - 1][2], node});
  }
  check.shared = shared_nodes(edges);
  return check;
}

class Collector {
 public:
  Collector(const Mesh& mesh, std::vector<MeshFinding>& findings) : mesh_(mesh), findings_(findings) {}

  void begin(MeshSeverity severity, const char* kind, const char* meaning) {
    findings_.push_back({kind, meaning, severity, 0, {}});
  }
  void add_elements(const std::vector<Index>& elements) {
    add(elements, [&](Index element) { return place_of(std::array{element}); });
  }
  template <std::size_t N>
  void add_elements(const std::vector<std::array<Index, N>>& groups) {
    add(groups, [&](const auto& group) { return place_of(group); });
  }
  void add_vertices(const std::vector<Index>& vertices) {
    add(vertices, [&](Index v) { return MeshPlace{{}, {}, {v}, mean_position(mesh_, std::array{v})}; });
  }
  template <std::size_t N>
  void add_vertices(const std::vector<std::array<Index, N>>& groups) {
    add(groups, [&](const auto& group) {
      return MeshPlace{{}, {}, {group.begin(), group.end()}, mean_position(mesh_, group)};
    });
  }

 private:
  template <class Items, class PlaceOf>
  void add(const Items& items, const PlaceOf& make_place) {
    MeshFinding& finding = findings_.back();
    finding.count += items.size();
    for (std::size_t i = 0; i < items.size() && finding.first.size() < most_places; ++i)
      finding.first.push_back(make_place(items[i]));
  }

  template <std::size_t N>
  MeshPlace place_of(const std::array<Index, N>& elements) const {
    MeshPlace place{{}, {}, {}, Vec3::Zero()};
    const auto prisms_from = static_cast<Index>(mesh_.tetrahedra.size());
    for (const Index element : elements) {
      const auto i = static_cast<std::size_t>(element);
      if (element < prisms_from) {
        place.tetrahedra.push_back(element);
        place.position += mean_position(mesh_, mesh_.tetrahedra[i]) / N;
      } else {
        place.prisms.push_back(element - prisms_from);
        place.position += mean_position(mesh_, mesh_.prisms[i - mesh_.tetrahedra.size()]) / N;
      }
    }
    return place;
  }

  const Mesh& mesh_;
  std::vector<MeshFinding>& findings_;
};

}  // namespace

std::vector<MeshFinding> findings_of(const Mesh& mesh, const MeshCheck& check) {
  std::vector<MeshFinding> findings;
  Collector collect(mesh, findings);
  collect.begin(MeshSeverity::error, "degenerate_elements", "without volume, or folded over");
  collect.add_elements(check.degenerate);
  collect.begin(MeshSeverity::error, "duplicate_elements", "same vertices as an earlier element");
  collect.add_elements(check.duplicate_elements);
  collect.begin(MeshSeverity::error, "overlapping_elements", "on the same side of a common face");
  collect.add_elements(check.overlapping);
  collect.begin(MeshSeverity::error, "nonmanifold_faces", "faces of more than two elements");
  collect.add_vertices(check.nonmanifold_faces);
  collect.add_vertices(check.nonmanifold_quads);
  const EdgeCheck edges = check_edges(mesh);
  const bool quadratic = !mesh.edge_nodes.empty();
  if (quadratic) {
    collect.begin(MeshSeverity::error, "split_edges",
                  "tetrahedra have different nodes on the edge: not connected there");
    collect.add_vertices(edges.split);
    collect.begin(MeshSeverity::error, "shared_edge_nodes", "nodes of several edges");
    collect.add_vertices(edges.shared);
    collect.begin(MeshSeverity::error, "far_edge_nodes", "more than a quarter of the edge's length from its middle");
    collect.add_vertices(edges.far);
  }
  collect.begin(MeshSeverity::warning, "duplicate_vertices", "same place as an earlier vertex: not connected there");
  collect.add_vertices(check.duplicate_vertices);
  collect.begin(MeshSeverity::warning, "nonmanifold_edges", "the body touches itself along an edge only");
  collect.add_vertices(check.nonmanifold_edges);
  collect.begin(MeshSeverity::warning, "nonmanifold_vertices", "the body touches itself in a point only");
  collect.add_vertices(check.nonmanifold_vertices);
  collect.begin(MeshSeverity::remark, "negative_elements", "vertices in reversed order: softkin reorders them");
  collect.add_elements(check.negative);
  if (quadratic) {
    collect.begin(MeshSeverity::remark, "uneven_edges", "node off the middle of the edge: curved, or of uneven halves");
    collect.add_vertices(edges.uneven);
  }
  collect.begin(MeshSeverity::remark, "unreferenced_vertices", "of no element: they stay where they are");
  collect.add_vertices(check.unreferenced);
  return findings;
}

}  // namespace softkin
