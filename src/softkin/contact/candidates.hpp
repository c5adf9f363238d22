#pragma once

#include <compare>
#include <softkin/contact/distance.hpp>
#include <softkin/contact/surface.hpp>
#include <softkin/contact/wide_tree.hpp>
#include <softkin/core/team.hpp>

namespace softkin::contact {

/// Places in a surface's lists: of a vertex and a triangle, or of two edges, the lower one first.
struct Pair {
  Index first, second;
  friend auto operator<=>(const Pair&, const Pair&) = default;
};

struct Candidates {
  std::vector<Pair> vertex_triangle, edge_edge;
};

/// The vertices of a pair in the order of FourPoints.
using Nodes = std::array<Index, 4>;
[[nodiscard]] inline Nodes nodes_of_vertex_triangle(const Surface& surface, const Pair& pair) {
  const Corners& t = surface.triangles[pair.second];
  return {surface.vertices[pair.first], t[0], t[1], t[2]};
}
[[nodiscard]] inline Nodes nodes_of_edge_edge(const Surface& surface, const Pair& pair) {
  const Ends &a = surface.edges[pair.first], &b = surface.edges[pair.second];
  return {a[0], a[1], b[0], b[1]};
}

[[nodiscard]] inline FourPoints points_of(const Points& positions, const Nodes& nodes) {
  FourPoints x;
  for (int i = 0; i < 4; ++i) x.col(i) = positions.row(nodes[i]).transpose();
  return x;
}

/// Pairs that are left out besides those with a common vertex. Nothing prevents these from passing through each other.
struct Exclusions {
  /// For every row of the positions others, ascending, e.g. neighbours_of: a pair is left out where a vertex of one
  /// feature has one of the other in its list. Lists that are empty: none.
  Lists neighbours;
  /// Of every row of the positions: pairs whose four vertices are of one group, 0 or more, are left out, such as those
  /// of a rigid region, or of obstacles among themselves. Empty: none.
  std::vector<Index> group;
};

/// Of every row the vertices, ascending, that are at most so many edges away, itself included.
///
/// rows  number of rows of the positions
[[nodiscard]] Lists neighbours_of(const Surface& surface, Index rows, int edges);

/// Finds the pairs of a surface that may be close. One caller at a time.
class BroadPhase {
 public:
  /// rest        positions [mm], by which the order of the trees is chosen once
  /// surface     outlives this
  BroadPhase(const Surface& surface, const Points& rest, Exclusions exclusions = {});

  /// All pairs whose boxes are at most `reach` [mm] apart along each axis, less those that are clearly farther apart,
  /// which holds all that are at most `reach` apart; always in the same order, whatever the team.
  ///
  /// positions  finite [mm]
  void find(const Points& positions, double reach, Team& team, Candidates& out);

  /// The same along a linear motion: all pairs whose boxes come within reach at any instant of it. Boxes bound the
  /// moves, too, so that a common motion brings no pair into reach. Pairs are left out that stay clearly apart along
  /// the direction between their centroids, averaged over both ends, or along the shortest vector at the end.
  void find(const Points& from, const Points& to, double reach, Team& team, Candidates& out);

 private:
  /// Things of so many vertices.
  template <int vertices>
  struct Features {
    WideTree tree;
    std::vector<EightNodes> nodes;  // of the tree's groups

    template <class Items>
    Features(const Items& items, const Points& rest);
  };

  template <int of_query, int of_other, class Keep>
  void pair_up(const Features<of_query>& queries, const Features<of_other>& others, double reach, Team& team,
               const Keep& keep, std::vector<Pair>& out);
  /// Besides those with a common vertex.
  [[nodiscard]] bool left_out(const Index* a, int of_a, const Index* b, int of_b) const;
  [[nodiscard]] bool neighbours(Index a, Index b) const;

  const Surface& surface_;
  Exclusions exclusions_;
  Features<1> vertices_;
  Features<2> edges_;
  Features<3> triangles_;
  std::vector<std::vector<Pair>> found_;  // by piece of the queries
};

}  // namespace softkin::contact
