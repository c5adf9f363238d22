#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/mesh/surface_tree.hpp>
#include <softkin/model/mesh/tetrahedra.hpp>
#include <softkin/statics/self_overlap.hpp>
#include <unordered_set>

namespace softkin {

namespace {

constexpr double touching = 1e-5;  // of the diagonal: parts that only touch are no deeper than a solve's tolerance
constexpr double margin = 1e-9;    // in barycentric coordinates: a point between two cells is in both

bool is_air(const Model& model, const ElementRole& role) {
  return role.actuator >= 0 && model.actuators[role.actuator].is<ChamberDrive>();
}

std::vector<Tetrahedron> body_cells(const Model& model) {
  std::vector<Tetrahedron> cells;
  cells.reserve(model.elements.tetrahedra.size() * (model.elements.edge_nodes.empty() ? 1 : 8) +
                3 * model.elements.prisms.size());
  const auto add = [&cells](const auto& pieces) { cells.insert(cells.end(), pieces.begin(), pieces.end()); };
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    if (is_air(model, model.elements.tetrahedron_roles[e])) continue;
    if (model.elements.edge_nodes.empty())
      cells.push_back(model.elements.tetrahedra[e]);
    else
      add(split(model.elements.tetrahedra[e], model.elements.edge_nodes[e]));
  }
  for (const Prism& prism : model.elements.prisms) add(split(prism));
  return cells;
}

bool holds(const Tetrahedron& cell, Index vertex) {
  return std::find(cell.begin(), cell.end(), vertex) != cell.end();
}

/// Across the face of each cell that lies opposite each corner; -1: the boundary.
std::vector<std::array<Index, 4>> neighbours_of(const std::vector<Tetrahedron>& cells) {
  std::vector<std::array<Index, 4>> neighbours(cells.size(), {-1, -1, -1, -1});
  const auto set = [&](const Triangle& face, Index cell, Index across) {
    const Tetrahedron& corners = cells[cell];
    for (std::size_t i = 0; i < 4; ++i)
      if (std::find(face.begin(), face.end(), corners[i]) == face.end()) neighbours[cell][i] = across;
  };
  ElementFaces faces = faces_of(cells, {});
  visit_same_faces(faces.triangles, [&](const ElementFace<3>* begin, const ElementFace<3>* end) {
    const Index first = begin->owner, last = (end - 1)->owner;
    if (first == last) return;
    set(begin->sorted, first, last);
    set(begin->sorted, last, first);
  });
  return neighbours;
}

}  // namespace

/// Data of a shape that are computed once.
class OverlapSearch::Shape {
 public:
  Shape(const OverlapSearch& search, const Points& positions)
      : cells_(search.cells_),
        positions_(positions),
        bounds_(bounds_of(positions, cells_)),
        tree_(*search.tree_),
        inverted_(positions.rows()) {
    tree_.refit(bounds_);
    for (const Tetrahedron& cell : cells_)
      if (!(signed_volume(positions, cell) > 0))
        for (const Index v : cell) inverted_[v] = true;
  }

  /// A cell that the vertex lies in without being one of its corners; -1: none.
  [[nodiscard]] Index around(Index vertex) const {
    Index inside = -1;
    if (is_inverted(vertex)) return inside;
    const Vec3 point = vertex_at(positions_, vertex);
    tree_.visit_at(point, [&](Index cell) {
      const Tetrahedron& corners = cells_[cell];
      if (holds(corners, vertex) || !covers(corners, point)) return true;
      inside = cell;
      return false;
    });
    return inside;
  }

  /// From a vertex in a cell to the nearest boundary that is reached through cells no farther away [mm].
  [[nodiscard]] double depth(Index vertex, Index cell) {
    using Reached = std::pair<double, Index>;  // squared distance of the cell's box, cell
    if (neighbours_.empty()) neighbours_ = neighbours_of(cells_);
    const Vec3 point = vertex_at(positions_, vertex);
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
    std::unordered_set<Index> seen{cell};
    double nearest = std::numeric_limits<double>::infinity();
    for (next.emplace(0.0, cell); !next.empty() && next.top().first < nearest;) {
      const std::size_t at = next.top().second;
      next.pop();
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const Index across = neighbours_[at][corner];
        if (across < 0)
          nearest = std::min(nearest, squared_distance(point, at, corner, vertex));
        else if (seen.insert(across).second)
          next.emplace(bounds_[across].squaredExteriorDistance(point), across);
      }
    }
    return std::sqrt(nearest);
  }

 private:
  [[nodiscard]] bool is_inverted(Index vertex) const { return inverted_[vertex]; }

  [[nodiscard]] bool covers(const Tetrahedron& cell, const Vec3& point) const {
    if (std::any_of(cell.begin(), cell.end(), [this](Index v) { return is_inverted(v); })) return false;
    Vec3 corners[4];
    for (std::size_t i = 0; i < 4; ++i) corners[i] = vertex_at(positions_, cell[i]);
    return barycentric(corners, point).minCoeff() > -margin;
  }

  /// To the face opposite a corner; infinite where the vertex is one of its own.
  [[nodiscard]] double squared_distance(const Vec3& point, std::size_t cell, std::size_t corner, Index vertex) const {
    Vec3 face[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const Index v = cells_[cell][(corner + 1 + i) % 4];
      if (v == vertex) return std::numeric_limits<double>::infinity();
      face[i] = vertex_at(positions_, v);
    }
    return squared_distance_to_triangle(point, face[0], face[1], face[2]);
  }

  const std::vector<Tetrahedron>& cells_;
  const Points& positions_;
  std::vector<Bounds> bounds_;
  BoxTree tree_;
  std::vector<bool> inverted_;                    // vertices of inverted cells
  std::vector<std::array<Index, 4>> neighbours_;  // once they are needed
};

OverlapSearch::OverlapSearch(const Model& model)
    : cells_(body_cells(model)),
      tree_(std::make_shared<BoxTree>(bounds_of(model.rest, cells_))),
      min_mm_(touching * model.diagonal_mm) {
  for (const Triangle& face : boundary_of(cells_, {}).triangles)
    surface_.insert(surface_.end(), face.begin(), face.end());
  sort_unique(surface_);
}

SelfOverlap OverlapSearch::in(const Points& positions) const {
  SelfOverlap overlap;
  if (!positions.allFinite()) return overlap;
  Shape shape(*this, positions);
  for (const Index vertex : surface_) {
    const Index cell = shape.around(vertex);
    if (cell < 0) continue;
    const double deep = shape.depth(vertex, cell);
    if (!(deep > min_mm_)) continue;
    ++overlap.points;
    if (deep <= overlap.deepest_mm) continue;
    overlap.deepest_mm = deep;
    overlap.where = vertex_at(positions, vertex);
  }
  return overlap;
}

}  // namespace softkin
