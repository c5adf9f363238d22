#include <algorithm>
#include <cmath>
#include <softkin/contact/apart.hpp>
#include <softkin/contact/candidates.hpp>
#include <utility>

namespace softkin::contact {

namespace {

std::array<Index, 1> vertices_of(Index vertex) {
  return {vertex};
}

template <std::size_t N>
const std::array<Index, N>& vertices_of(const std::array<Index, N>& vertices) {
  return vertices;
}

template <class Items>
Points centres_of(const Items& items, const Points& rest) {
  Points centres = Points::Zero(items.size(), 3);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto& vertices = vertices_of(items[i]);
    for (const Index v : vertices) centres.row(i) += rest.row(v) / static_cast<double>(vertices.size());
  }
  return centres;
}

/// Where an item of the list is, and how it moves.
template <class Items>
auto boxes_of(const Items& items, const Points& from, const Points& to) {
  return [&](Index item) {
    MovingBox box;
    for (const Index v : vertices_of(items[item])) {
      const Vec3 x = from.row(v).transpose();
      box.at.extend(x);
      box.move.extend(Vec3(to.row(v).transpose() - x));
    }
    return box;
  };
}

MovingBox enlarged(MovingBox box, double reach) {
  box.at.min().array() -= reach;
  box.at.max().array() += reach;
  return box;
}

}  // namespace

Lists neighbours_of(const Surface& surface, Index rows, int edges) {
  std::vector<std::vector<Index>> next(rows);
  for (const auto& [a, b] : surface.edges) {
    next[a].push_back(b);
    next[b].push_back(a);
  }
  Lists lists;
  lists.begin.assign(1, 0);
  for (Index row = 0; row < rows; ++row) {
    std::vector<Index> reached{row};
    for (int ring = 0; ring < edges; ++ring) {
      const std::vector<Index> before = reached;
      for (const Index v : before) {
        const auto& around = next[v];
        reached.insert(reached.end(), around.begin(), around.end());
      }
      std::sort(reached.begin(), reached.end());
      reached.erase(std::unique(reached.begin(), reached.end()), reached.end());
    }
    lists.items.insert(lists.items.end(), reached.begin(), reached.end());
    lists.begin.push_back(lists.items.size());
  }
  return lists;
}

template <int vertices>
template <class Items>
BroadPhase::Features<vertices>::Features(const Items& items, const Points& rest)
    : tree(centres_of(items, rest)), nodes(tree.groups()) {
  for (Index place = 0; place < tree.size(); ++place) {
    const auto& of_item = vertices_of(items[tree.item(place / 8, place % 8)]);
    for (std::size_t k = 0; k < vertices; ++k) nodes[place / 8].node[k][place % 8] = of_item[k];
  }
}

BroadPhase::BroadPhase(const Surface& surface, const Points& rest, Exclusions exclusions)
    : surface_(surface),
      exclusions_(std::move(exclusions)),
      vertices_(surface.vertices, rest),
      edges_(surface.edges, rest),
      triangles_(surface.triangles, rest) {}

bool BroadPhase::neighbours(Index a, Index b) const {
  const auto* items = exclusions_.neighbours.items.data();
  const auto& begin = exclusions_.neighbours.begin;
  return std::binary_search(items + begin[a], items + begin[a + 1], b);
}

bool BroadPhase::left_out(const Index* a, int of_a, const Index* b, int of_b) const {
  if (!exclusions_.group.empty()) {
    const auto group = [&](Index v) { return exclusions_.group[v]; };
    const auto same = [&](Index v) { return group(v) == group(a[0]); };
    if (group(a[0]) >= 0 && std::all_of(a, a + of_a, same) && std::all_of(b, b + of_b, same)) return true;
  }
  if (exclusions_.neighbours.items.empty()) return false;
  for (int i = 0; i < of_a; ++i)
    for (int j = 0; j < of_b; ++j)
      if (neighbours(a[i], b[j])) return true;
  return false;
}

/// Of features and themselves each pair is looked at once.
template <int of_query, int of_other, class Keep>
void BroadPhase::pair_up(const Features<of_query>& queries, const Features<of_other>& others, double reach, Team& team,
                         const Keep& keep, std::vector<Pair>& out) {
  constexpr Index groups_a_piece = 32;
  constexpr bool same = of_query == of_other;
  const WideTree &query_tree = queries.tree, &tree = others.tree;
  out.clear();
  if (tree.size() == 0) return;
  const TreeLevels levels = tree.levels(others.nodes.data());
  const Index pieces = (query_tree.groups() + groups_a_piece - 1) / groups_a_piece;
  if (found_.size() < static_cast<std::size_t>(pieces)) found_.resize(pieces);
  const auto pair_group = [&](Index group, std::vector<Pair>& found) {
    EightBoxes boxes;
    const int lanes = static_cast<int>(std::min<Index>(8, query_tree.size() - 8 * group));
    for (int lane = 0; lane < lanes; ++lane) boxes.set(lane, enlarged(query_tree.boxes(group).at(lane), reach));
    const auto met = [&](Index other, int lane, unsigned bits) {
      for (; bits != 0; bits &= bits - 1) {
        const Pair pair{query_tree.item(group, lane), tree.item(other, __builtin_ctz(bits))};
        if (keep(pair)) found.push_back(pair);
      }
    };
    const Askers askers{boxes, &queries.nodes[group], lanes, same ? group : 0, same ? group : -1};
    run_meet<of_query, of_other>(askers, levels, met);
  };
  team.each(pieces, [&](Index piece) {
    std::vector<Pair>& found = found_[piece];
    found.clear();
    const Index end = std::min(query_tree.groups(), (piece + 1) * groups_a_piece);
    for (Index group = piece * groups_a_piece; group < end; ++group) pair_group(group, found);
  });
  for (Index piece = 0; piece < pieces; ++piece) {
    const std::vector<Pair>& found = found_[piece];
    out.insert(out.end(), found.begin(), found.end());
  }
}

void BroadPhase::find(const Points& positions, double reach, Team& team, Candidates& out) {
  find(positions, positions, reach, team, out);
}

void BroadPhase::find(const Points& from, const Points& to, double reach, Team& team, Candidates& out) {
  vertices_.tree.refit(boxes_of(surface_.vertices, from, to), team);
  edges_.tree.refit(boxes_of(surface_.edges, from, to), team);
  triangles_.tree.refit(boxes_of(surface_.triangles, from, to), team);
  const auto apart = [&](const Nodes& n, const auto& pairs, auto separation) {
    const FourPoints start = points_of(from, n), end = points_of(to, n);
    if (clearly_apart(start, end, pairs, reach)) return true;
    const Separation last = separation(end);
    return last.squared > reach * reach && apart_along(last.vector, start, pairs, reach * std::sqrt(last.squared));
  };
  const auto keep_vertex = [&](const Pair& pair) {
    const Nodes n = nodes_of_vertex_triangle(surface_, pair);
    return !left_out(n.data(), 1, n.data() + 1, 3) && !apart(n, of_triangle, vertex_triangle);
  };
  const auto keep_edges = [&](const Pair& pair) {
    const Nodes n = nodes_of_edge_edge(surface_, pair);
    return !left_out(n.data(), 2, n.data() + 2, 2) && !apart(n, of_edges, edge_edge);
  };
  pair_up(vertices_, triangles_, reach, team, keep_vertex, out.vertex_triangle);
  pair_up(edges_, edges_, reach, team, keep_edges, out.edge_edge);
  for (Pair& pair : out.edge_edge)
    if (pair.second < pair.first) std::swap(pair.first, pair.second);
}

}  // namespace softkin::contact
