#include <Eigen/Dense>
#include <algorithm>
#include <softkin/model/mesh/edge_bulges.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>

namespace softkin {

namespace {

constexpr double min_quality = 0.1;         // Jacobian over that with straight edges
constexpr double good_quality = 0.7;        // below it nodes inside make room
constexpr double farthest_fraction = 0.24;  // of an edge's length; compile() refuses a node beyond a quarter

}  // namespace

EdgeBulges::EdgeBulges(Mesh& mesh) : mesh_(mesh), nodes_(mesh.vertices.rows()) {
  std::vector<std::pair<Index, Index>> at;  // node and element
  at.reserve(6 * mesh.edge_nodes.size());
  for (std::size_t t = 0; t < mesh.edge_nodes.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const Index node = mesh.edge_nodes[t][e];
      nodes_[node].low = mesh.tetrahedra[t][tetrahedron_edges[e][0]];
      nodes_[node].high = mesh.tetrahedra[t][tetrahedron_edges[e][1]];
      at.emplace_back(node, static_cast<Index>(t));
    }
  std::sort(at.begin(), at.end());
  for (std::size_t i = 0; i < at.size(); ++i) {
    around_.push_back(at[i].second);
    Node& node = nodes_[at[i].first];
    if (i == 0 || at[i].first != at[i - 1].first) node.begin = i;
    node.end = i + 1;
  }
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (nodes_[v].low >= 0) place(v);
}

Vec3 EdgeBulges::middle(const Node& node) const {
  return 0.5 * (vertex_at(mesh_.vertices, node.low) + vertex_at(mesh_.vertices, node.high));
}

void EdgeBulges::place(Index node) {
  mesh_.vertices.row(node) = (middle(nodes_[node]) + nodes_[node].fraction * nodes_[node].bulge).transpose();
}

/// No further than a quarter of the edge's length.
Vec3 EdgeBulges::allowed(const Node& node, const Vec3& path) const {
  const double most = farthest_fraction * (mesh_.vertices.row(node.low) - mesh_.vertices.row(node.high)).norm();
  const Vec3 inside = path - path.dot(node.plane) * node.plane;
  return inside.norm() > most ? Vec3(most * inside.normalized()) : inside;
}

void EdgeBulges::aim(Index node, const Vec3& bulge, const Vec3& plane) {
  Node& aimed = nodes_[node];
  aimed.bulge = allowed(aimed, bulge);
  aimed.plane = plane;
  aimed.surface = true;
  aimed.aimed = !bulge.isZero(0);
}

bool EdgeBulges::may_yield(const Node& node) const {
  return !node.aimed && (!node.surface || !node.plane.isZero(0));
}

double EdgeBulges::quality(Index element) const {
  TetrahedronNodes nodes = nodes_of(mesh_.vertices, mesh_.tetrahedra[element], mesh_.edge_nodes[element]);
  double straight = 6 * signed_volume(mesh_.vertices, mesh_.tetrahedra[element]);
  if (straight < 0) {  // reversed: seen in a mirror
    nodes.col(0) *= -1;
    straight = -straight;
  }
  return straight > 0 ? min_jacobian_bound(nodes) / straight : 1;  // one without volume is refused elsewhere
}

/// Returns the sum of the missing quality of the elements around a node.
double EdgeBulges::deficit_around(Index node, double wanted) const {
  double deficit = 0;
  for (std::size_t i = nodes_[node].begin; i < nodes_[node].end; ++i)
    deficit += std::max(0.0, wanted - quality(around_[i]));
  return deficit;
}

std::vector<Index> EdgeBulges::elements_below(double least) const {
  std::vector<Index> bad;
  for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) {
    const EdgeNodes& nodes = mesh_.edge_nodes[t];
    const bool straight = std::all_of(nodes.begin(), nodes.end(),
                                      [&](Index n) { return nodes_[n].fraction == 0 || nodes_[n].bulge.isZero(0); });
    if (!straight && quality(t) < least) bad.push_back(t);
  }
  return bad;
}

/// Of the nodes on the other edges of the faces that it is on.
Vec3 EdgeBulges::mean_bulge(Index node) const {
  const Node& own = nodes_[node];
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (std::size_t i = own.begin; i < own.end; ++i)
    for (const Index other : mesh_.edge_nodes[around_[i]]) {
      const Node& near = nodes_[other];
      const bool touches = near.low == own.low || near.low == own.high || near.high == own.low || near.high == own.high;
      if (other == node || !touches) continue;
      sum += near.fraction * near.bulge;
      ++count;
    }
  return count > 0 ? Vec3(sum / count) : sum;
}

/// Nodes inside bad elements go along with the sheets on both sides of them, all at once.
void EdgeBulges::go_along(const std::vector<Index>& bad, const SmoothSurface& surface) {
  for (const Index element : bad)
    for (const Index v : mesh_.edge_nodes[element]) {
      Node& node = nodes_[v];
      if (!may_yield(node) || !node.bulge.isZero(0)) continue;
      node.bulge = allowed(node, surface.inner_bulge(node.low, node.high));
      place(v);
    }
}

void EdgeBulges::make_room(Index node, const SmoothSurface& surface, double wanted) {
  Node& own = nodes_[node];
  if (!may_yield(own)) return;
  const Vec3 mean = mean_bulge(node), inner = surface.inner_bulge(own.low, own.high);
  Vec3 best = own.bulge;
  double least = deficit_around(node, wanted);
  for (const Vec3& path : {inner, mean, Vec3(2 * mean), Vec3(0.5 * (inner + mean)), Vec3(0.5 * mean), Vec3(0 * mean)}) {
    if (!(least > 0)) break;
    own.bulge = allowed(own, path);
    place(node);
    if (const double left = deficit_around(node, wanted); left < least) {
      least = left;
      best = own.bulge;
    }
  }
  own.bulge = best;
  place(node);
}

/// Draws an element's nodes back until it is good.
///
/// wholly  to the middles: to come to an end where neighbours undo each other
void EdgeBulges::hold_back(Index element, bool wholly) {
  const EdgeNodes& nodes = mesh_.edge_nodes[element];
  std::array<double, 6> fractions;
  for (int e = 0; e < 6; ++e) fractions[e] = nodes_[nodes[e]].fraction;
  const auto draw = [&](double left) {
    for (int e = 0; e < 6; ++e) {
      nodes_[nodes[e]].fraction = left * fractions[e];
      place(nodes[e]);
    }
  };
  constexpr int steps = 20;
  for (int step = wholly ? steps : 1; step <= steps; ++step) {
    draw(1 - static_cast<double>(step) / steps);
    if (step == steps || quality(element) >= min_quality) break;
  }
  for (const Index node : nodes)  // a node without a target does not count as held back
    if (nodes_[node].bulge.isZero(0)) nodes_[node].fraction = 1;
}

void EdgeBulges::go(const SmoothSurface& surface) {
  constexpr int sweeps = 4, rounds = 100;
  for (Index v = 0; v < mesh_.vertices.rows(); ++v)
    if (nodes_[v].surface) place(v);
  std::vector<Index> bad = elements_below(good_quality);
  for (int sweep = 0; sweep < sweeps && !bad.empty(); ++sweep) {
    go_along(bad, surface);
    bad = elements_below(good_quality);
  }
  for (const double wanted : {good_quality, min_quality}) {
    bad = elements_below(wanted);
    for (int sweep = 0; sweep < sweeps && !bad.empty(); ++sweep) {
      for (const Index element : bad)
        for (const Index node : mesh_.edge_nodes[element]) make_room(node, surface, wanted);
      bad = elements_below(wanted);
    }
  }
  for (int round = 0; !bad.empty(); ++round) {
    for (const Index element : bad)
      if (round >= rounds || quality(element) < min_quality) hold_back(element, round >= rounds);
    bad = elements_below(min_quality);
  }
}

void EdgeBulges::describe(CurvedEdges& result) const {
  constexpr double held = 1 - 1e-9;
  for (const Node& node : nodes_) {
    if (node.low < 0 || node.bulge.isZero(0)) continue;
    result.farthest_mm = std::max(result.farthest_mm, node.fraction * node.bulge.norm());
    if (!node.aimed) {
      ++result.inside;
      continue;
    }
    ++result.moved;
    if (node.fraction < held) ++result.held_back;
    result.min_fraction = std::min(result.min_fraction, node.fraction);
  }
}

}  // namespace softkin
