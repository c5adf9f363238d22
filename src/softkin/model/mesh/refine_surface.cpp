#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/refine_surface.hpp>

namespace softkin {

namespace {

using Edge = std::pair<Index, Index>;

Edge edge_of(const Triangle& t, int side) {
  return std::minmax(t[side], t[(side + 1) % 3]);
}

class Edges {
 public:
  explicit Edges(const TriangleSurface& surface) : surface_(surface) {
    for (const Triangle& t : surface.triangles)
      for (int i = 0; i < 3; ++i) edges_.push_back(edge_of(t, i));
    sort_unique(edges_);
    middle_.assign(edges_.size(), -1);
  }

  bool mark_longer(const std::function<double(const Vec3&)>& limit) {
    bool any = false;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const Vec3 a = vertex_at(surface_.vertices, edges_[e].first), b = vertex_at(surface_.vertices, edges_[e].second);
      if (!((b - a).norm() > limit(0.5 * (a + b)))) continue;
      middle_[e] = 0;
      any = true;
    }
    return any;
  }

  void mark_longest_of_marked() {
    for (bool changed = true; changed;) {
      changed = false;
      for (const Triangle& t : surface_.triangles) {
        if (at(t, 0) < 0 && at(t, 1) < 0 && at(t, 2) < 0) continue;
        Index& longest = at(t, longest_side(t));
        changed = changed || longest < 0;
        longest = 0;
      }
    }
  }

  /// The vertices with those in the middle of marked edges.
  Points split() {
    Index count = surface_.vertices.rows();
    for (Index& middle : middle_)
      if (middle >= 0) middle = count++;
    Points vertices(count, 3);
    vertices.topRows(surface_.vertices.rows()) = surface_.vertices;
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (middle_[e] >= 0)
        vertices.row(middle_[e]) =
            0.5 * (surface_.vertices.row(edges_[e].first) + surface_.vertices.row(edges_[e].second));
    return vertices;
  }

  /// The vertex in the middle of a side, or -1.
  Index& at(const Triangle& t, int side) {
    return middle_[std::lower_bound(edges_.begin(), edges_.end(), edge_of(t, side)) - edges_.begin()];
  }

 private:
  // Of equal ones that which stands first in edges_, so that two triangles agree.
  int longest_side(const Triangle& t) const {
    int longest = 0;
    for (int i = 1; i < 3; ++i) {
      const double more = squared_length(t, i) - squared_length(t, longest);
      if (more > 0 || (more == 0 && edge_of(t, i) < edge_of(t, longest))) longest = i;
    }
    return longest;
  }
  double squared_length(const Triangle& t, int side) const {
    const Edge edge = edge_of(t, side);
    return (surface_.vertices.row(edge.first) - surface_.vertices.row(edge.second)).squaredNorm();
  }

  const TriangleSurface& surface_;
  std::vector<Edge> edges_;
  std::vector<Index> middle_;  // -1: not marked
};

/// Where two sides are marked, from the middle of the longer one to the opposite corner.
void split(const Points& vertices, const Triangle& t, const Index (&middle)[3], std::vector<Triangle>& out) {
  const auto marked = std::count_if(middle, middle + 3, [](Index m) { return m >= 0; });
  int first = 0;  // the side that is marked alone, or the one after the only side that is not
  for (int i = 0; i < 3; ++i)
    if (marked == 1 ? middle[i] >= 0 : middle[(i + 2) % 3] < 0) first = i;
  const Index p = t[first], q = t[(first + 1) % 3], r = t[(first + 2) % 3], pq = middle[first],
              qr = middle[(first + 1) % 3], rp = middle[(first + 2) % 3];
  if (marked == 0)
    out.push_back(t);
  else if (marked == 1)
    out.insert(out.end(), {{p, pq, r}, {pq, q, r}});
  else if (marked == 2 && (vertices.row(p) - vertices.row(q)).norm() > (vertices.row(q) - vertices.row(r)).norm())
    out.insert(out.end(), {{pq, q, qr}, {p, pq, r}, {pq, qr, r}});
  else if (marked == 2)
    out.insert(out.end(), {{pq, q, qr}, {p, pq, qr}, {p, qr, r}});
  else
    out.insert(out.end(), {{p, pq, rp}, {pq, q, qr}, {rp, qr, r}, {pq, qr, rp}});
}

}  // namespace

TriangleSurface refined(TriangleSurface surface, const std::function<double(const Vec3&)>& limit, std::size_t most) {
  while (true) {
    Edges edges(surface);
    if (!edges.mark_longer(limit)) return surface;
    edges.mark_longest_of_marked();
    TriangleSurface finer;
    finer.vertices = edges.split();
    for (const Triangle& t : surface.triangles) {
      const Index middle[3] = {edges.at(t, 0), edges.at(t, 1), edges.at(t, 2)};
      split(surface.vertices, t, middle, finer.triangles);
    }
    if (finer.triangles.size() > most)
      throw InvalidInput("the surface would take more than " + std::to_string(most) + " triangles");
    surface = std::move(finer);
  }
}

}  // namespace softkin
