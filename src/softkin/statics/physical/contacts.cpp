#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/contact_measure.hpp>
#include <softkin/statics/physical/contacts.hpp>

namespace softkin::physical {

using contact::Candidates;
using contact::Pair;

namespace {

/// Contact area of edges and of a vertex's guard, over the mean area of a robot's vertices. It changes a pressure by
/// this fraction only, and is enough to prevent penetration.
constexpr double guard_fraction = 0.01;
/// Minimum of the square of edges' spacing, over that mean: finer surfaces have the same area at each crossing of
/// edges.
constexpr double min_spacing = 1e-4;
/// Edges whose triangles' normals have at least this cosine get this fraction of the area of sharp edges.
constexpr double smooth_cosine = 0.87, smooth_fraction = 0.01;
/// Pairs within this multiple of the reach are part of the sparsity pattern.
constexpr double foresight = 2;
/// Margin of the search for pairs, over the reach, so that small motions need no new search.
constexpr double margin_fraction = 1;
/// Number of slots of a clique of four vertices.
constexpr std::int64_t clique_slots = 10;

ContactSurfaces surfaces_of(const Model& model, const Points& rest) {
  ContactSurfaces surfaces;
  surfaces.surface = contact::make_surface(model.contact.triangles, rest);
  surfaces.reach_mm = model.contact.distance_mm;
  surfaces.modulus_MPa = model.contact.modulus_MPa;
  surfaces.rules = &model.contact;
  return surfaces;
}

}  // namespace

Contacts::Contacts(const Model& model)
    : model_(model),
      points_(model),
      rest_(ContactPoints::in(model, model.rest)),
      surfaces_(surfaces_of(model, rest_)),
      friction_(surfaces_) {
  find_parts();
  choose_areas();
  margin_mm_ = margin_fraction * surfaces_.reach_mm;
  Team alone(1);
  broad_ = std::make_unique<contact::BroadPhase>(surfaces_.surface, rest_, exclusions());
  contact::Lists together;
  if (const auto& [first, end] = model.contact.sheets; first < end) {
    contact::Exclusions lying = exclusions();
    together = lying.neighbours = lying_together(rest_, *broad_, alone, surfaces_);
    broad_ = std::make_unique<contact::BroadPhase>(surfaces_.surface, rest_, std::move(lying));
  }
  leave_out_neighbours(rest_, *broad_, alone, surfaces_, together);
  potential_ = std::make_unique<ContactPotential>(surfaces_, rest_);
}

/// Finds the part of each vertex and edge. Where parts of the robot meet, it is the last of them.
void Contacts::find_parts() {
  const contact::Surface& surface = surfaces_.surface;
  surfaces_.triangle_part = surfaces_.rules->part_of;
  surfaces_.vertex_part.resize(surface.vertices.size());
  surfaces_.edge_part.resize(surface.edges.size());
  const auto last = [&](const contact::Lists& triangles, std::size_t of) {
    Index part = 0;
    for (Index i = triangles.begin[of]; i < triangles.begin[of + 1]; ++i)
      part = std::max(part, surfaces_.triangle_part[triangles.items[i]]);
    return part;
  };
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    surfaces_.vertex_part[v] = last(surface.vertex_triangles, v);
  for (std::size_t e = 0; e < surface.edges.size(); ++e) surfaces_.edge_part[e] = last(surface.edge_triangles, e);
}

/// Returns the contact area of an edge of a body or obstacle, over that of edges of the robot. Facets may be far finer
/// than the robot's elements. Edges between facets that approximate a smooth surface get little area. Edges have no
/// friction.
double Contacts::fraction_of_edge(std::size_t edge, double mean_area) const {
  const contact::Surface& surface = surfaces_.surface;
  const contact::Ends& ends = surface.edges[edge];
  const double length = (vertex_at(model_.rest, ends[1]) - vertex_at(model_.rest, ends[0])).norm();
  std::vector<Vec3> normals;
  double spacing = 0;  // estimated distance between similar edges: the mean height of the triangles
  for (Index i = surface.edge_triangles.begin[edge]; i < surface.edge_triangles.begin[edge + 1]; ++i) {
    const auto& [a, b, c] = surface.triangles[surface.edge_triangles.items[i]];
    const Vec3 from = vertex_at(model_.rest, a);
    normals.push_back((vertex_at(model_.rest, b) - from).cross(vertex_at(model_.rest, c) - from));
    spacing += normals.back().norm() / length;
  }
  spacing /= static_cast<double>(normals.size());
  const bool smooth = normals.size() == 2 && normals[0].normalized().dot(normals[1].normalized()) > smooth_cosine;
  return std::clamp(spacing * spacing / mean_area, min_spacing, 1.0) * (smooth ? smooth_fraction : 1);
}

void Contacts::choose_areas() {
  const auto rank_of = [&](Index part) { return surfaces_.rules->parts[part].rank; };
  double sum = 0;
  Index count = 0;
  for (std::size_t v = 0; v < surfaces_.surface.vertices.size(); ++v) {
    surfaces_.vertex_area.push_back(surfaces_.rules->area[surfaces_.surface.vertices[v]]);
    if (rank_of(surfaces_.vertex_part[v]) != ContactRank::robot) continue;
    sum += surfaces_.vertex_area.back();
    ++count;
  }
  surfaces_.guard_area = guard_fraction * sum / std::max<Index>(1, count);
  const double mean = sum / std::max<Index>(1, count);
  for (std::size_t e = 0; e < surfaces_.surface.edges.size(); ++e)
    surfaces_.edge_area.push_back(
        guard_fraction * mean *
        (rank_of(surfaces_.edge_part[e]) == ContactRank::robot ? 1 : fraction_of_edge(e, mean)));
}

/// Excludes contacts among obstacles, of a body with itself and, unless requested, of a robot with itself.
contact::Exclusions Contacts::exclusions() const {
  const ContactModel& rules = *surfaces_.rules;
  const Index parts = rules.parts.size();
  std::vector<Index> group_of_part;
  for (Index part = 0; part < parts; ++part) {
    const ContactRank rank = rules.parts[part].rank;
    const bool untouched = rank == ContactRank::obstacle || !rules.pair(part, part).touch;
    group_of_part.push_back(rank == ContactRank::obstacle ? 0
                            : !untouched                  ? -1
                            : rank == ContactRank::robot  ? 1 + rules.parts[part].robot
                                                          : 1 + part);
  }
  contact::Exclusions out;
  out.group.assign(model_.rest.rows(), -1);
  for (std::size_t v = 0; v < surfaces_.surface.vertices.size(); ++v)
    out.group[surfaces_.surface.vertices[v]] = group_of_part[surfaces_.vertex_part[v]];
  return out;
}

std::unique_ptr<Contacts::Scratch> Contacts::make_scratch() const {
  return std::make_unique<Scratch>(*broad_);
}

/// Keeps the candidates that are within each other's reach and interact, sorted.
void Contacts::keep_close(const Points& positions, const ContactStiffnessScale& stiffness_scale,
                          Candidates& pairs) const {
  const contact::Surface& surface = surfaces_.surface;
  std::erase_if(pairs.vertex_triangle, [&](const Pair& pair) {
    const contact::FourPoints x = contact::points_of(positions, nodes_of_vertex_triangle(surface, pair));
    const double reach = stiffness_scale.foresight * potential_->reach_of(pair.first, pair.second, stiffness_scale);
    return !potential_->felt(pair.first, pair.second) || contact::vertex_triangle(x).squared > reach * reach;
  });
  std::erase_if(pairs.edge_edge, [&](const Pair& pair) {
    const contact::FourPoints x = contact::points_of(positions, nodes_of_edge_edge(surface, pair));
    const double reach = stiffness_scale.foresight * potential_->reach_of_edges(pair, stiffness_scale);
    return !potential_->edges_felt(pair) || contact::edge_edge(x).squared > reach * reach;
  });
  sort_candidates(pairs);
}

/// Adds the gradient at the nodes that follows from the gradient at the contact points, which add(out) adds to out.
void Contacts::add_of_points(Points& gradient, const auto& add) const {
  if (points_.are_nodes()) return add(gradient);
  Points on_points = Points::Zero(gradient.rows(), 3);
  add(on_points);
  points_.add_forces(on_points, gradient);
}

double Contacts::energy(const Points& positions, const Scratch& scratch) const {
  Points room;
  const Points& points = points_.of(positions, room);
  return potential_->energy(points, scratch.terms) + friction_.energy(points, scratch.holds);
}

void Contacts::add_gradient(const Points& positions, const Scratch& scratch, Points& gradient) const {
  Points room;
  const Points& points = points_.of(positions, room);
  add_of_points(gradient, [&](Points& out) {
    potential_->add_gradient(points, scratch.terms, out);
    friction_.add_gradient(points, scratch.holds, out);
  });
}

void Contacts::evaluate(const Iterate& at, const LoadState& /*load_state*/, Term::Scratch& scratch, Sum& sum,
                        Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  own.evaluated = !sum.forbidden;
  if (!own.evaluated) return;
  find(at.positions, own, team);
  if (own.friction_follows) friction_.hold(own.terms, at.anchors, own.holds);
  sum.energy += energy(at.positions, own);
  sum.forbidden = !std::isfinite(sum.energy);
  own.evaluated = !sum.forbidden;
  if (own.evaluated) add_gradient(at.positions, own, sum.gradient);
}

void Contacts::add_cliques_of(const Iterate& at, Term::Scratch& scratch, linear::Cliques& cliques, Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  find_pairs(at.positions, own, team, own.slotted);
  own.first_slot = cliques.slots.back();
  add_cliques(own.slotted, cliques);
}

void Contacts::stiffness(const Iterate& at, const LoadState& /*load_state*/, bool projected, Term::Scratch& scratch,
                         LargeVector<double>& slots, Team& /*team*/) const {
  const auto& own = static_cast<const Scratch&>(scratch);
  stiffness(at.positions, projected, own, own.slotted, slots.data() + 9 * own.first_slot);
}

void Contacts::describe(const Iterate& at, const LoadState& /*load_state*/, Term::Scratch& scratch,
                        ElementDeformation& out, Team& /*team*/) const {
  const auto& own = static_cast<const Scratch&>(scratch);
  Points room;
  if (own.evaluated)
    out.contacts = contact_forces(surfaces_, *potential_, points_.of(at.positions, room), own.terms, friction_,
                                  own.holds, at.anchors);
}

Points Contacts::change_along(const Points& nodes, const Scratch& scratch, const Points& moves) const {
  Points room, room_of_moves;
  return contact_changes(*potential_, points_.of(nodes, room), scratch.terms, friction_, scratch.holds,
                         points_.of(moves, room_of_moves));
}

void Contacts::follow_pushes(const Points& moves, double fraction, Scratch& scratch) const {
  Points room;
  potential_->follow(scratch.terms, points_.of(moves, room), fraction, scratch.pushes);
}

void Contacts::add_friction_response(const Points& positions, const Scratch& scratch, const Points& moves,
                                     Points& gradient) const {
  Points room, room_of_moves;
  const Points &points = points_.of(positions, room), &of_points = points_.of(moves, room_of_moves);
  add_of_points(gradient, [&](Points& out) {
    friction_.add_response(*potential_, points, scratch.terms, scratch.holds, of_points, out);
  });
}

void Contacts::renew(const Points& from, const Points& to, const FreeMotion& free, const Scratch& scratch,
                     std::vector<Anchor>& anchors) const {
  Points room, room_of_end;
  FreeMotion rooms;
  const FreeMotion free_points{points_.of(free.straight, rooms.straight), points_.of(free.turned, rooms.turned)};
  friction_.renew(points_.of(from, room), points_.of(to, room_of_end), free_points, scratch.terms, anchors);
}

void Contacts::slide(const Points& nodes, const Scratch& scratch, std::vector<Anchor>& anchors) const {
  Points room;
  friction_.slide(points_.of(nodes, room), scratch.terms, scratch.holds, anchors);
}

double Contacts::disagreement(const Points& nodes, const Friction::Holds& before, const Friction::Holds& after) const {
  Points room;
  return friction_.disagreement(points_.of(nodes, room), before, after);
}

namespace {

/// Returns the index of a pair in a pattern, where pairs of edges follow those of vertices; -1: it is not there.
Index place_of(const Candidates& pairs, const Pair& pair, bool edges) {
  const std::vector<Pair>& all = edges ? pairs.edge_edge : pairs.vertex_triangle;
  const auto found = std::lower_bound(all.begin(), all.end(), pair);
  if (found == all.end() || *found != pair) return -1;
  return found - all.begin() + (edges ? static_cast<std::ptrdiff_t>(pairs.vertex_triangle.size()) : 0);
}

}  // namespace

bool Contacts::holds(const Candidates& pairs, const Scratch& scratch) {
  return std::all_of(scratch.terms.begin(), scratch.terms.end(),
                     [&](const auto& term) { return place_of(pairs, term.pair, term.threshold > 0) >= 0; }) &&
         std::all_of(scratch.holds.begin(), scratch.holds.end(),
                     [&](const auto& hold) { return place_of(pairs, hold.pair, false) >= 0; });
}

void Contacts::find_pairs(const Points& positions, Scratch& scratch, Team& team, Candidates& pairs) const {
  Points room;
  const Points& points = points_.of(positions, room);
  ContactStiffnessScale wide = scratch.stiffness_scale;
  wide.foresight *= foresight;
  scratch.broad.find(points, foresight * reach_mm(scratch), team, pairs);
  keep_close(points, wide, pairs);
  for (const Friction::Hold& hold : scratch.holds) pairs.vertex_triangle.push_back(hold.pair);
  sort_candidates(pairs);
  pairs.vertex_triangle.erase(std::unique(pairs.vertex_triangle.begin(), pairs.vertex_triangle.end()),
                              pairs.vertex_triangle.end());
}

contact::Nodes Contacts::nodes_of(const Pair& pair, bool edges) const {
  return edges ? nodes_of_edge_edge(surfaces_.surface, pair) : nodes_of_vertex_triangle(surfaces_.surface, pair);
}

namespace {

/// Calls visit(pair, edges) in the order of place_of.
void each_of(const Candidates& pairs, const auto& visit) {
  for (const Pair& pair : pairs.vertex_triangle) visit(pair, false);
  for (const Pair& pair : pairs.edge_edge) visit(pair, true);
}

void add_to_slots(const contact::Hessian& block, double* slot) {
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b <= a; ++b, slot += 9)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) slot[3 * r + c] += block(3 * a + r, 3 * b + c);
}

/// Adds a block to the slots of the nodes that carry the contact points.
void add_to_slots(const contact::Hessian& block, const ContactPoints::Carriers& by, double* slot) {
  for (int a = 0; a < by.count; ++a) {
    Eigen::Matrix<double, 3, 12> row = Eigen::Matrix<double, 3, 12>::Zero();
    for (int i = 0; i < 4; ++i)
      if (by.fractions(i, a) != 0) row += by.fractions(i, a) * block.middleRows<3>(3 * i);
    for (int b = 0; b <= a; ++b, slot += 9) {
      Mat3 of_nodes = Mat3::Zero();
      for (int i = 0; i < 4; ++i)
        if (by.fractions(i, b) != 0) of_nodes += by.fractions(i, b) * row.middleCols<3>(3 * i);
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{slot} += of_nodes;
    }
  }
}

}  // namespace

void Contacts::add_cliques(const Candidates& pairs, linear::Cliques& cliques) const {
  each_of(pairs, [&](const Pair& pair, bool edges) {
    const contact::Nodes points = nodes_of(pair, edges);
    if (points_.are_nodes()) return cliques.add(points);
    const ContactPoints::Carriers by = points_.carriers(points);
    cliques.add({by.nodes.data(), static_cast<std::size_t>(by.count)});
  });
}

/// Returns the first slot of each pair, then their number; nothing if every pair has the same number of slots.
std::vector<std::int64_t> Contacts::slots_of(const Candidates& pairs) const {
  std::vector<std::int64_t> slots;
  if (points_.are_nodes()) return slots;
  slots.push_back(0);
  each_of(pairs, [&](const Pair& pair, bool edges) {
    const int count = points_.carriers(nodes_of(pair, edges)).count;
    slots.push_back(slots.back() + count * (count + 1) / 2);
  });
  return slots;
}

void Contacts::stiffness(const Points& positions, bool projected, const Scratch& scratch, const Candidates& pairs,
                         double* slots) const {
  Points room;
  const Points& points = points_.of(positions, room);
  const std::vector<std::int64_t> starts = slots_of(pairs);
  const auto slot_of = [&](Index place) {
    return starts.empty() ? clique_slots * static_cast<std::int64_t>(place) : starts[place];
  };
  std::fill_n(slots, 9 * slot_of(pairs.vertex_triangle.size() + pairs.edge_edge.size()), 0.0);
  contact::Hessian block;
  const auto add = [&](const Pair& pair, bool edges) {
    double* slot = slots + 9 * slot_of(place_of(pairs, pair, edges));
    if (points_.are_nodes())
      add_to_slots(block, slot);
    else
      add_to_slots(block, points_.carriers(nodes_of(pair, edges)), slot);
  };
  for (const ContactPotential::Term& term : scratch.terms) {
    potential_->stiffness(points, term, projected, block);
    add(term.pair, term.threshold > 0);
  }
  for (const Friction::Hold& hold : scratch.holds) {
    friction_.stiffness(points, hold, block);
    add(hold.pair, false);
  }
}

}  // namespace softkin::physical
