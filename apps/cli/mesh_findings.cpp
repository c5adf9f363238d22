#include "mesh_findings.hpp"

#include <algorithm>
#include <array>

#include "mesh_edges.hpp"
#include "mesh_measures.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t most_places = 5;

class Collector {
 public:
  Collector(const Mesh& mesh, std::vector<Finding>& findings) : mesh_(mesh), findings_(findings) {}

  void begin(Severity severity, const char* kind, const char* meaning) {
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
    add(vertices, [&](Index v) { return Place{{}, {}, {v}, mean_position(mesh_, std::array{v})}; });
  }
  template <std::size_t N>
  void add_vertices(const std::vector<std::array<Index, N>>& groups) {
    add(groups, [&](const auto& group) {
      return Place{{}, {}, {group.begin(), group.end()}, mean_position(mesh_, group)};
    });
  }

 private:
  template <class Items, class PlaceOf>
  void add(const Items& items, const PlaceOf& make_place) {
    Finding& finding = findings_.back();
    finding.count += items.size();
    for (std::size_t i = 0; i < items.size() && finding.first.size() < most_places; ++i)
      finding.first.push_back(make_place(items[i]));
  }

  template <std::size_t N>
  Place place_of(const std::array<Index, N>& elements) const {
    Place place{{}, {}, {}, Vec3::Zero()};
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
  std::vector<Finding>& findings_;
};

}  // namespace

std::vector<Finding> findings_of(const Mesh& mesh, const MeshCheck& check) {
  std::vector<Finding> findings;
  Collector collect(mesh, findings);
  collect.begin(Severity::error, "degenerate_elements", "without volume, or folded over");
  collect.add_elements(check.degenerate);
  collect.begin(Severity::error, "duplicate_elements", "same vertices as an earlier element");
  collect.add_elements(check.duplicate_elements);
  collect.begin(Severity::error, "overlapping_elements", "on the same side of a common face");
  collect.add_elements(check.overlapping);
  collect.begin(Severity::error, "nonmanifold_faces", "faces of more than two elements");
  collect.add_vertices(check.nonmanifold_faces);
  collect.add_vertices(check.nonmanifold_quads);
  const EdgeCheck edges = check_edges(mesh);
  const bool quadratic = !mesh.edge_nodes.empty();
  if (quadratic) {
    collect.begin(Severity::error, "split_edges", "tetrahedra have different nodes on the edge: not connected there");
    collect.add_vertices(edges.split);
    collect.begin(Severity::error, "shared_edge_nodes", "nodes of several edges");
    collect.add_vertices(edges.shared);
    collect.begin(Severity::error, "far_edge_nodes", "more than a quarter of the edge's length from its middle");
    collect.add_vertices(edges.far);
  }
  collect.begin(Severity::warning, "duplicate_vertices", "same place as an earlier vertex: not connected there");
  collect.add_vertices(check.duplicate_vertices);
  collect.begin(Severity::warning, "nonmanifold_edges", "the body touches itself along an edge only");
  collect.add_vertices(check.nonmanifold_edges);
  collect.begin(Severity::warning, "nonmanifold_vertices", "the body touches itself in a point only");
  collect.add_vertices(check.nonmanifold_vertices);
  collect.begin(Severity::remark, "negative_elements", "vertices in reversed order: softkin reorders them");
  collect.add_elements(check.negative);
  if (quadratic) {
    collect.begin(Severity::remark, "uneven_edges", "node off the middle of the edge: curved, or of uneven halves");
    collect.add_vertices(edges.uneven);
  }
  collect.begin(Severity::remark, "unreferenced_vertices", "of no element: they stay where they are");
  collect.add_vertices(check.unreferenced);
  return findings;
}

}  // namespace softkin::cli
