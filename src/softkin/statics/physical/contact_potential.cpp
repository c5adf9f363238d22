#include <algorithm>
#include <bit>
#include <cmath>
#include <softkin/statics/physical/contact_potential.hpp>
#include <tuple>

namespace softkin::physical {

using contact::Candidates;
using contact::FourPoints;
using contact::Pair;
using contact::points_of;
using contact::Separation;

namespace {

bool contains(const contact::Lists& lists, Index of, Index item) {
  const auto begin = lists.items.begin() + lists.begin[of], end = lists.items.begin() + lists.begin[of + 1];
  return std::binary_search(begin, end, item);
}

contact::Lists lists_of(std::size_t count, std::vector<Pair>& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  contact::Lists lists;
  lists.begin.assign(count + 1, 0);
  for (const Pair& pair : pairs) {
    ++lists.begin[static_cast<std::size_t>(pair.first) + 1];
    lists.items.push_back(pair.second);
  }
  for (std::size_t i = 0; i < count; ++i) lists.begin[i + 1] += lists.begin[i];
  return lists;
}

bool same_robot(const ContactSurfaces& surfaces, const std::vector<Index>& a_parts, Index a,
                const std::vector<Index>& b_parts, Index b) {
  if (surfaces.rules == nullptr) return true;
  const auto robot = [&](const std::vector<Index>& parts, Index item) {
    return surfaces.rules->parts[parts[item]].robot;
  };
  return robot(a_parts, a) >= 0 && robot(a_parts, a) == robot(b_parts, b);
}

/// Returns the gradient by the points of a separation's length, for its unit normal.
contact::Gradient length_gradient(const Separation& separation, const Vec3& normal) {
  contact::Gradient out;
  for (int i = 0; i < 4; ++i) out.segment<3>(3 * i) = separation.weights[i] * normal;
  return out;
}

}  // namespace

double ContactSurfaces::area(Index vertex, Index triangle) const {
  const double own = vertex_area[vertex];
  if (rules == nullptr) return own;
  const Index a = vertex_part[vertex], b = triangle_part[triangle];
  if (!rules->pair(a, b).touch) return 0;
  const ContactRank rank = rules->parts[a].rank, before = rules->parts[b].rank;
  return rank < before ? own : rank == before ? 0.5 * own : guard_area;
}

double ContactSurfaces::area_of_edges(Index a, Index b) const {
  const double own = std::sqrt(edge_area[a] * edge_area[b]);
  if (rules == nullptr) return own;
  return rules->pair(edge_part[a], edge_part[b]).touch ? own : 0;
}

void sort_candidates(Candidates& candidates) {
  std::sort(candidates.vertex_triangle.begin(), candidates.vertex_triangle.end());
  std::sort(candidates.edge_edge.begin(), candidates.edge_edge.end());
}

namespace {

/// Returns the pairs of the same robot that are closer at rest than twice the reach.
Candidates near_at_rest(const Points& rest, contact::BroadPhase& broad, Team& team, const ContactSurfaces& surfaces) {
  const contact::Surface& surface = surfaces.surface;
  const double near = 4 * surfaces.reach_mm * surfaces.reach_mm;
  Candidates close;
  broad.find(rest, 2 * surfaces.reach_mm, team, close);
  std::erase_if(close.vertex_triangle, [&](const Pair& pair) {
    return !(same_robot(surfaces, surfaces.vertex_part, pair.first, surfaces.triangle_part, pair.second) &&
             contact::vertex_triangle(points_of(rest, nodes_of_vertex_triangle(surface, pair))).squared < near);
  });
  std::erase_if(close.edge_edge, [&](const Pair& pair) {
    return !(same_robot(surfaces, surfaces.edge_part, pair.first, surfaces.edge_part, pair.second) &&
             contact::edge_edge(points_of(rest, nodes_of_edge_edge(surface, pair))).squared < near);
  });
  return close;
}

}  // namespace

contact::Lists lying_together(const Points& rest, contact::BroadPhase& broad, Team& team,
                              const ContactSurfaces& surfaces) {
  const contact::Surface& surface = surfaces.surface;
  std::vector<Pair> together;
  const auto add = [&](const contact::Nodes& nodes, int of_first) {
    for (int i = 0; i < of_first; ++i)
      for (int j = of_first; j < 4; ++j) {
        const Index a = nodes[i], b = nodes[j];
        together.push_back({a, b});
        together.push_back({b, a});
      }
  };
  const auto sheet_at = [&](const contact::Lists& triangles, Index i) {
    return surfaces.rules->sheet(triangles.items[triangles.begin[i]]);
  };
  const Candidates close = near_at_rest(rest, broad, team, surfaces);
  for (const Pair& pair : close.vertex_triangle)
    if (sheet_at(surface.vertex_triangles, pair.first) || surfaces.rules->sheet(pair.second))
      add(nodes_of_vertex_triangle(surface, pair), 1);
  for (const Pair& pair : close.edge_edge)
    if (sheet_at(surface.edge_triangles, pair.first) || sheet_at(surface.edge_triangles, pair.second))
      add(nodes_of_edge_edge(surface, pair), 2);
  return lists_of(rest.rows(), together);
}

namespace {

/// Adds triangles and edges at vertices that lie on a vertex or on an end of an edge.
void add_lying_together(const contact::Surface& surface, const contact::Lists& together, std::vector<Pair>& triangles,
                        std::vector<Pair>& edges) {
  if (together.items.empty()) return;
  const auto each = [](const contact::Lists& lists, Index of, const auto& visit) {
    for (Index i = lists.begin[of]; i < lists.begin[of + 1]; ++i) visit(lists.items[i]);
  };
  std::vector<Pair> around, at;  // of every row its edges and triangles
  for (std::size_t e = 0; e < surface.edges.size(); ++e)
    for (const Index v : surface.edges[e]) around.push_back({v, static_cast<Index>(e)});
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const Index v : surface.triangles[t]) at.push_back({v, static_cast<Index>(t)});
  const contact::Lists edges_at = lists_of(together.begin.size() - 1, around),
                       triangles_at = lists_of(together.begin.size() - 1, at);
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    each(together, surface.vertices[v], [&](Index other) {
      each(triangles_at, other, [&](Index t) { triangles.push_back({static_cast<Index>(v), t}); });
    });
  for (std::size_t e = 0; e < surface.edges.size(); ++e)
    for (const Index v : surface.edges[e])
      each(together, v, [&](Index other) {
        each(edges_at, other, [&](Index f) {
          edges.push_back({std::min(static_cast<Index>(e), f), std::max(static_cast<Index>(e), f)});
        });
      });
}

}  // namespace

void leave_out_neighbours(const Points& rest, contact::BroadPhase& broad, Team& team, ContactSurfaces& surfaces,
                          const contact::Lists& together) {
  const contact::Surface& surface = surfaces.surface;
  Candidates close = near_at_rest(rest, broad, team, surfaces);
  std::vector<Pair>&triangles = close.vertex_triangle, &edges = close.edge_edge;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    for (Index i = surface.vertex_triangles.begin[v]; i < surface.vertex_triangles.begin[v + 1]; ++i)
      triangles.push_back({static_cast<Index>(v), surface.vertex_triangles.items[i]});
  add_lying_together(surface, together, triangles, edges);
  surfaces.unfelt_triangles = lists_of(surface.vertices.size(), triangles);
  surfaces.unfelt_edges = lists_of(surface.edges.size(), edges);
}

/// The triangle, edge or vertex of the surface to which a vertex is closest, and its multiplicity.
struct ContactPotential::Feature {
  int corners;  // 3: a triangle, 2: an edge, 1: a vertex
  Index place, count;
  Separation separation;
  Index pair;
};

ContactPotential::ContactPotential(const ContactSurfaces& surfaces, const Points& rest)
    : surfaces_(surfaces), rest_(rest), place_(rest.rows(), -1) {
  const contact::Surface& surface = surfaces.surface;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) place_[surface.vertices[v]] = v;
}

bool ContactPotential::felt(Index vertex, Index triangle) const {
  return !contains(surfaces_.unfelt_triangles, vertex, triangle) && surfaces_.area(vertex, triangle) > 0;
}

bool ContactPotential::edges_felt(const Pair& edges) const {
  return surfaces_.area_of_edges(edges.first, edges.second) > 0 &&
         !contains(surfaces_.unfelt_edges, edges.first, edges.second);
}

/// Returns the number of triangles at an edge that interact with a vertex.
Index ContactPotential::felt_at(Index vertex, Index edge) const {
  const contact::Lists& around = surfaces_.surface.edge_triangles;
  Index count = 0;
  for (Index i = around.begin[edge]; i < around.begin[edge + 1]; ++i) count += felt(vertex, around.items[i]);
  return count;
}

namespace {

/// Returns the side of a triangle that two of its corners form, by the bits of a separation's nodes.
int side_of(std::uint8_t nodes) {
  return nodes == 0b0111 ? 0 : nodes == 0b1101 ? 1 : 2;  // corners 0 1, 1 2, 2 0
}

void note_once(std::vector<Index>& seen, Index item, const auto& visit) {
  if (std::find(seen.begin(), seen.end(), item) != seen.end()) return;
  seen.push_back(item);
  visit();
}

}  // namespace

double ContactPotential::reach_of(Index vertex, Index triangle, const ContactStiffnessScale& stiffness_scale) const {
  const bool wider = stiffness_scale.reach != 1 &&
                     !same_robot(surfaces_, surfaces_.vertex_part, vertex, surfaces_.triangle_part, triangle);
  return wider ? stiffness_scale.reach * surfaces_.reach_mm : surfaces_.reach_mm;
}

double ContactPotential::reach_of_edges(const Pair& edges, const ContactStiffnessScale& stiffness_scale) const {
  const bool wider = stiffness_scale.reach != 1 &&
                     !same_robot(surfaces_, surfaces_.edge_part, edges.first, surfaces_.edge_part, edges.second);
  return wider ? stiffness_scale.reach * surfaces_.reach_mm : surfaces_.reach_mm;
}

/// count  multiplicity of the triangle, or of the side or corner of it, to which the separation was computed
void ContactPotential::count(Index triangle, const Separation& separation, Index count, Index pair, double reach,
                             std::vector<Feature>& features) const {
  if (!(separation.squared < reach * reach)) return;
  const contact::Surface& surface = surfaces_.surface;
  const std::size_t t = triangle;
  const int corners = std::popcount(static_cast<unsigned>(separation.nodes)) - 1;
  Index place = triangle;
  if (corners == 2) place = surface.triangle_edges[t][side_of(separation.nodes)];
  if (corners == 1) place = surface.triangles[t][std::countr_zero(static_cast<unsigned>(separation.nodes) >> 1u)];
  for (Feature& feature : features)
    if (feature.corners == corners && feature.place == place) {
      feature.count += count;
      return;
    }
  features.push_back({corners, place, count, separation, pair});
}

/// Returns the multiplicity of a corner: 1, minus the interacting triangles around it, plus the edges of these at it.
Index ContactPotential::count_at(Index vertex, Index corner) const {
  const contact::Surface& surface = surfaces_.surface;
  const std::size_t place = place_[corner];
  Index triangles = 0;
  std::vector<Index> edges;
  for (Index i = surface.vertex_triangles.begin[place]; i < surface.vertex_triangles.begin[place + 1]; ++i) {
    const Index t = surface.vertex_triangles.items[i];
    if (!felt(vertex, t)) continue;
    ++triangles;
    for (const Index e : surface.triangle_edges[t]) {
      const contact::Ends& ends = surface.edges[e];
      if (ends[0] == corner || ends[1] == corner) note_once(edges, e, [] {});
    }
  }
  return 1 + triangles - std::ssize(edges);  // every triangle has two of the edges
}

namespace {

/// Returns the barrier law of a gap, per area and the scene's modulus.
energy::LengthLaw law_of(const Separation& separation, double reach, const ContactStiffnessScale& stiffness_scale) {
  energy::LengthLaw law = energy::barrier(std::sqrt(separation.squared), reach);
  if (stiffness_scale.modulus == 1) return law;
  return {stiffness_scale.modulus * law.value, stiffness_scale.modulus * law.slope,
          stiffness_scale.modulus * law.curvature};
}

}  // namespace

void ContactPotential::add_vertex(const Points& positions, const Candidates& candidates, std::size_t begin,
                                  std::size_t end, const ContactStiffnessScale& stiffness_scale,
                                  std::vector<Term>& terms) const {
  const contact::Surface& surface = surfaces_.surface;
  const Index vertex = candidates.vertex_triangle[begin].first;
  std::vector<Feature> features;
  std::vector<std::size_t> near;
  for (std::size_t i = begin; i < end; ++i) {
    const Pair& pair = candidates.vertex_triangle[i];
    if (!felt(vertex, pair.second)) continue;
    const Separation found = contact::vertex_triangle(points_of(positions, nodes_of_vertex_triangle(surface, pair)));
    const double reach = stiffness_scale.foresight * reach_of(vertex, pair.second, stiffness_scale);
    if (!(found.squared < reach * reach)) continue;
    count(pair.second, found, 1, i, reach, features);
    near.push_back(i);
  }
  std::vector<Index> edges, corners;
  for (const std::size_t i : near) {
    const Pair& pair = candidates.vertex_triangle[i];
    const FourPoints x = points_of(positions, nodes_of_vertex_triangle(surface, pair));
    const double reach = stiffness_scale.foresight * reach_of(vertex, pair.second, stiffness_scale);
    for (int k = 0; k < 3; ++k) {
      const Index edge = surface.triangle_edges[pair.second][k];
      note_once(edges, edge, [&] {
        const Index more = felt_at(vertex, edge) - 1;
        if (more != 0) count(pair.second, contact::vertex_side(x, k), -more, i, reach, features);
      });
      const Index corner = surface.triangles[pair.second][k];
      note_once(corners, corner, [&] {
        const Index more = count_at(vertex, corner);
        if (more != 0) count(pair.second, contact::vertex_corner(x, k), more, i, reach, features);
      });
    }
  }
  for (const Feature& feature : features) {
    if (feature.count == 0) continue;
    const Pair& pair = candidates.vertex_triangle[feature.pair];
    const double weight = surfaces_.modulus_MPa * surfaces_.area(vertex, pair.second);
    terms.push_back({nodes_of_vertex_triangle(surface, pair), feature.separation, feature.count * weight, 0, pair,
                     law_of(feature.separation, reach_of(vertex, pair.second, stiffness_scale), stiffness_scale)});
  }
}

void ContactPotential::find(const Points& positions, const Candidates& candidates, std::vector<Term>& terms,
                            const ContactStiffnessScale& stiffness_scale) const {
  terms.clear();
  const std::vector<Pair>& vertices = candidates.vertex_triangle;
  for (std::size_t i = 0, j = 0; i < vertices.size(); i = j) {
    for (j = i + 1; j < vertices.size() && vertices[j].first == vertices[i].first;) ++j;
    add_vertex(positions, candidates, i, j, stiffness_scale, terms);
  }
  const contact::Surface& surface = surfaces_.surface;
  for (std::size_t i = 0; i < candidates.edge_edge.size(); ++i) {
    const Pair& pair = candidates.edge_edge[i];
    if (!edges_felt(pair)) continue;
    const contact::Nodes nodes = nodes_of_edge_edge(surface, pair);
    const Separation found = contact::edge_edge(points_of(positions, nodes));
    const double reach = reach_of_edges(pair, stiffness_scale);
    if (!(std::sqrt(found.squared) < stiffness_scale.foresight * reach)) continue;
    terms.push_back({nodes, found, surfaces_.modulus_MPa * surfaces_.area_of_edges(pair.first, pair.second),
                     contact::mollifier_threshold(points_of(rest_, nodes)), pair,
                     law_of(found, reach, stiffness_scale)});
  }
}

double ContactPotential::energy(const Points& positions, const std::vector<Term>& terms) const {
  double sum = 0;
  for (const Term& term : terms) {
    const double smooth = term.threshold > 0 ? contact::mollifier(points_of(positions, term.nodes), term.threshold) : 1;
    sum += smooth * term.weight * term.law.value;
  }
  return sum;
}

contact::Gradient ContactPotential::gradient(const Points& positions, const Term& term) const {
  const double gap = std::sqrt(term.separation.squared);
  const energy::LengthLaw& law = term.law;
  contact::Gradient of_term = law.slope * length_gradient(term.separation, term.separation.vector / gap);
  if (term.threshold > 0) {
    contact::Gradient of_mollifier;
    contact::Hessian unused;
    of_term *= contact::mollifier(points_of(positions, term.nodes), term.threshold, of_mollifier, unused);
    of_term += law.value * of_mollifier;
  }
  return term.weight * of_term;
}

void ContactPotential::add_gradient(const Points& positions, const std::vector<Term>& terms, Points& gradient) const {
  for (const Term& term : terms) {
    const contact::Gradient of_term = this->gradient(positions, term);
    for (int i = 0; i < 4; ++i) gradient.row(term.nodes[i]) += of_term.segment<3>(3 * i).transpose();
  }
}

void ContactPotential::stiffness(const Points& positions, const Term& term, bool projected,
                                 contact::Hessian& out) const {
  const double gap = std::sqrt(term.separation.squared);
  const energy::LengthLaw& law = term.law;
  const Vec3 normal = term.separation.vector / gap;
  const contact::Gradient along = length_gradient(term.separation, normal);
  const contact::Relief relief = contact::relief(term.separation);
  const double turning = law.slope / gap;  // <= 0
  const bool attracts = term.weight < 0;
  // of d: (c c^T (x) (I - n n^T) - Z Z^T) / d
  out.setZero();
  if (!projected || !attracts) out += law.curvature * along * along.transpose() - turning * relief * relief.transpose();
  if (!projected || attracts) {
    const Mat3 across = Mat3::Identity() - normal * normal.transpose();
    const Eigen::Vector4d& c = term.separation.weights;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) out.block<3, 3>(3 * i, 3 * j) += turning * c[i] * c[j] * across;
  }
  if (term.threshold > 0) {
    contact::Gradient of_mollifier;
    contact::Hessian bend;
    out *= contact::mollifier(points_of(positions, term.nodes), term.threshold, of_mollifier, bend);
    if (!projected)
      out += law.slope * (of_mollifier * along.transpose() + along * of_mollifier.transpose()) + law.value * bend;
  }
  out *= term.weight;
}

}  // namespace softkin::physical
