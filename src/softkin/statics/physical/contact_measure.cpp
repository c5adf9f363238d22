#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/statics/physical/contact_measure.hpp>

namespace softkin::physical {

namespace {

/// A vertex is a guard if it carries pressure for an area of less than this many guard areas.
constexpr double guards_area = 2;
/// Smallest fraction of the area around a vertex that counts as facing a force: a force along the surface determines no
/// pressure.
constexpr double min_facing = 0.05;
/// Pressure below which a vertex does not count as in contact, over the largest.
constexpr double faint = 0.01;
constexpr double kPa_per_MPa = 1e3;

/// Converts forces on the vertices of a surface to pressures; vertices are numbered by their place in the surface.
class PressedSurface {
 public:
  PressedSurface(const ContactSurfaces& surfaces, const Points& positions) : surfaces_(surfaces) {
    const contact::Surface& surface = surfaces.surface;
    for (const contact::Corners& t : surface.triangles) {
      const Vec3 a = positions.row(t[0]), b = positions.row(t[1]), c = positions.row(t[2]);
      area_.push_back(0.5 * (b - a).cross(c - a));
    }
    place_.assign(positions.rows(), -1);
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) place_[surface.vertices[v]] = v;
  }

  /// The place of a vertex of the model.
  [[nodiscard]] Index place(Index vertex) const { return place_[vertex]; }
  [[nodiscard]] Index size() const { return surfaces_.surface.vertices.size(); }

  struct Pressures {
    std::vector<double> pressure_MPa, area_mm2;  // of every vertex; area: 0 of guards and where nothing presses
  };
  /// Returns the pressures under forces on the vertices [N].
  [[nodiscard]] Pressures under(const Points& forces) const {
    Points borne = Points::Zero(size(), 3);
    std::vector<Index> guards;
    for (Index v = 0; v < size(); ++v) {
      const Vec3 force = forces.row(v);
      if (force.isZero(0)) continue;
      const bool passed =
          visit_bearers(v, force, [&](Index by, double fraction) { borne.row(by) += fraction * force.transpose(); });
      if (passed) guards.push_back(v);
    }
    Pressures out{std::vector<double>(size()), {}};
    out.area_mm2 = out.pressure_MPa;
    for (Index v = 0; v < size(); ++v) {
      const double force = borne.row(v).norm();
      if (!(force > 0)) continue;
      const std::size_t at = v;
      out.area_mm2[at] = area_facing(v, borne.row(v) / force);
      out.pressure_MPa[at] = force / out.area_mm2[at];
    }
    for (const Index v : guards) {
      double mean = 0;
      visit_bearers(v, forces.row(v), [&](Index by, double fraction) { mean += fraction * out.pressure_MPa[by]; });
      out.pressure_MPa[v] = mean;
    }
    return out;
  }

 private:
  [[nodiscard]] bool is_guard(Index place) const {
    return surfaces_.vertex_area[place] < guards_area * surfaces_.guard_area;
  }

  /// Finds the corners of a triangle among which its area is divided: those that are no guards, or all if all are.
  [[nodiscard]] int bearers(Index triangle, std::array<Index, 3>& out) const {
    int count = 0;
    for (const bool all : {false, true}) {
      for (const Index node : surfaces_.surface.triangles[triangle])
        if (const Index v = place(node); all || !is_guard(v)) out[count++] = v;
      if (count > 0) break;
    }
    return count;
  }

  void visit_around(Index v, const auto& visit) const {
    const contact::Lists& around = surfaces_.surface.vertex_triangles;
    for (Index i = around.begin[v]; i < around.begin[v + 1]; ++i) visit(around.items[i]);
  }

  [[nodiscard]] double facing(Index triangle, const Vec3& direction) const {
    return std::max(0.0, -area_[triangle].dot(direction));
  }

  /// Calls visit(vertex, fraction) for the vertices that carry the force on a vertex; returns whether they are others.
  bool visit_bearers(Index v, const Vec3& force, const auto& visit) const {
    std::map<Index, double> fractions;
    if (is_guard(v)) {
      const Vec3 direction = force.normalized();
      for (const bool any : {false, true}) {  // any: where no triangle faces the force
        double sum = 0;
        visit_around(v, [&](Index t) {
          std::array<Index, 3> by{};
          const int count = bearers(t, by);
          const double fraction = any ? 1 : facing(t, direction);
          for (int i = 0; i < count; ++i) {
            const Index other = by[i];
            if (is_guard(other) || !(fraction > 0)) continue;
            fractions[other] += fraction / count;
            sum += fraction / count;
          }
        });
        if (!(sum > 0)) continue;
        for (auto& [other, fraction] : fractions) visit(other, fraction / sum);
        return true;
      }
    }
    visit(v, 1);
    return false;
  }

  [[nodiscard]] double area_facing(Index v, const Vec3& direction) const {
    double seen = 0, all = 0;
    visit_around(v, [&](Index t) {
      std::array<Index, 3> by{};
      const int count = bearers(t, by);
      if (std::find(by.begin(), by.begin() + count, v) == by.begin() + count) return;
      seen += facing(t, direction) / count;
      all += area_[t].norm() / count;
    });
    return std::max(seen, min_facing * all);
  }

  const ContactSurfaces& surfaces_;
  std::vector<Vec3> area_;  // of triangles, along their normals
  std::vector<Index> place_;
};

/// A side of a term: a vertex or a triangle, or one of two edges.
struct Side {
  Index part;
  int begin, end;  // of its nodes
};

std::array<Side, 2> sides_of(const ContactSurfaces& surfaces, const ContactPotential::Term& term) {
  const auto part = [](const std::vector<Index>& parts, Index of) { return parts[of]; };
  if (term.threshold > 0)
    return {{{part(surfaces.edge_part, term.pair.first), 0, 2}, {part(surfaces.edge_part, term.pair.second), 2, 4}}};
  return {
      {{part(surfaces.vertex_part, term.pair.first), 0, 1}, {part(surfaces.triangle_part, term.pair.second), 1, 4}}};
}

/// Where a term presses on a side.
Vec3 place_of(const Points& positions, const ContactPotential::Term& term, const Side& side) {
  Vec3 place = Vec3::Zero();
  for (int i = side.begin; i < side.end; ++i)
    place += std::abs(term.separation.weights[i]) * positions.row(term.nodes[i]).transpose();
  return place;
}

/// The sum of the terms between two parts, as forces on the first one.
struct PairSum {
  PairForces forces;
  Vec3 moment = Vec3::Zero(), pressed = Vec3::Zero();  // about the origin; places by their normal force
  Points on_vertices;                                  // by their place
  double rubbing = 0, slipping = 0;                    // normal forces [N]
};

/// Adds the forces on the nodes of a side.
void add_forces(const ContactPotential::Term& term, const contact::Gradient& gradient, const Side& side,
                const PressedSurface& surface, Points& on_vertices) {
  for (int i = side.begin; i < side.end; ++i)
    on_vertices.row(surface.place(term.nodes[i])) -= gradient.segment<3>(3 * i).transpose();
}

void add_term(const Points& positions, const ContactPotential::Term& term, const contact::Gradient& gradient,
              std::array<Side, 2> sides, const PressedSurface& surface, PairSum& sum) {
  const double gap = std::sqrt(term.separation.squared);
  Vec3 apart = Vec3::Zero();  // on the side at which the separation ends
  for (int i = sides[0].begin; i < sides[0].end; ++i) apart -= gradient.segment<3>(3 * i);
  const double normal = apart.dot(term.separation.vector) / gap;
  PairForces& out = sum.forces;
  const bool itself = out.a == out.b;
  if (sum.on_vertices.rows() == 0) {
    sum.on_vertices.setZero(surface.size(), 3);
    out.gap_mm = gap;
  }
  out.gap_mm = std::min(out.gap_mm, gap);
  out.normal_N += normal;
  for (const Side& side : sides) {
    if (side.part != out.a) continue;
    add_forces(term, gradient, side, surface, sum.on_vertices);
    sum.pressed += (itself ? 0.5 : 1) * normal * place_of(positions, term, side);
    for (int i = side.begin; !itself && i < side.end; ++i) {
      const Vec3 force = -gradient.segment<3>(3 * i);
      out.force += force;
      sum.moment += Vec3(positions.row(term.nodes[i])).cross(force);
    }
  }
}

/// Adds the friction of a vertex on a triangle.
void add_friction(const Points& positions, const Friction& friction, const Friction::Hold& hold, double coefficient,
                  Index vertex_part, PairSum& sum) {
  constexpr double at_limit = 0.999;  // of the creep
  const double normal = hold.limit / coefficient;
  sum.rubbing += normal;
  if (Friction::slip(positions, hold).norm() >= at_limit * friction.creep_mm()) sum.slipping += normal;
  if (sum.forces.a == sum.forces.b) return;
  const Vec3 force = friction.force(positions, hold);
  const auto [begin, end] = vertex_part == sum.forces.a ? std::pair(0, 1) : std::pair(1, 4);
  for (int i = begin; i < end; ++i) {
    sum.forces.force += hold.weights[i] * force;
    sum.moment += Vec3(positions.row(hold.nodes[i])).cross(hold.weights[i] * force);
  }
}

PairForces finished(const PairSum& sum, const PressedSurface& surface) {
  PairForces out = sum.forces;
  out.center = sum.pressed / out.normal_N;
  if (sum.rubbing > 0) out.slipping = sum.slipping / sum.rubbing;
  if (out.a != out.b) out.moment = sum.moment - out.center.cross(out.force);
  const PressedSurface::Pressures found = surface.under(sum.on_vertices);
  const double most = *std::max_element(found.pressure_MPa.begin(), found.pressure_MPa.end());
  for (std::size_t v = 0; v < found.area_mm2.size(); ++v)
    if (found.pressure_MPa[v] > faint * most) out.area_mm2 += (out.a == out.b ? 0.5 : 1) * found.area_mm2[v];
  out.pressure_kPa = kPa_per_MPa * most;
  return out;
}

}  // namespace

Points contact_changes(const ContactPotential& potential, const Points& positions,
                       const std::vector<ContactPotential::Term>& terms, const Friction& friction,
                       const Friction::Holds& holds, const Points& moves) {
  Points change = Points::Zero(positions.rows(), 3);
  contact::Hessian block;
  const auto add = [&](const contact::Nodes& nodes) {
    contact::Gradient motion;
    for (int i = 0; i < 4; ++i) motion.segment<3>(3 * i) = moves.row(nodes[i]).transpose();
    const contact::Gradient pull = block * motion;
    for (int i = 0; i < 4; ++i) change.row(nodes[i]) += pull.segment<3>(3 * i).transpose();
  };
  for (const ContactPotential::Term& term : terms) {
    potential.stiffness(positions, term, false, block);
    add(term.nodes);
  }
  for (const Friction::Hold& hold : holds) {
    friction.stiffness(positions, hold, block);
    add(hold.nodes);
  }
  if (friction.any()) friction.add_response(potential, positions, terms, holds, moves, change);
  return change;
}

ContactForces contact_forces(const ContactSurfaces& surfaces, const ContactPotential& potential,
                             const Points& positions, const std::vector<ContactPotential::Term>& terms,
                             const Friction& friction, const Friction::Holds& holds,
                             const std::vector<Anchor>& anchors) {
  const std::vector<ContactPart>& parts = surfaces.rules->parts;
  const auto rank = [&](Index part) { return parts[part].rank; };
  const PressedSurface surface(surfaces, positions);
  std::map<std::pair<Index, Index>, PairSum> sums;
  Points all = Points::Zero(surface.size(), 3);
  for (const ContactPotential::Term& term : terms) {
    const contact::Gradient gradient = potential.gradient(positions, term);
    const std::array<Side, 2> sides = sides_of(surfaces, term);
    Index a = sides[0].part, b = sides[1].part;
    if (std::pair(rank(b), b) < std::pair(rank(a), a)) std::swap(a, b);
    PairSum& sum = sums[{a, b}];
    sum.forces.a = a;
    sum.forces.b = b;
    add_term(positions, term, gradient, sides, surface, sum);
    for (const Side& side : sides)
      if (rank(side.part) != ContactRank::obstacle) add_forces(term, gradient, side, surface, all);
  }
  for (const Friction::Hold& hold : holds) {
    const Index own = surfaces.vertex_part[hold.pair.first];
    const bool swapped = std::pair(rank(hold.part), hold.part) < std::pair(rank(own), own);
    const auto found = sums.find(swapped ? std::pair(hold.part, own) : std::pair(own, hold.part));
    if (found != sums.end())
      add_friction(positions, friction, hold, surfaces.rules->pair(own, hold.part).friction, own, found->second);
  }
  ContactForces out;
  if (friction.any()) out.slip_mm.assign(positions.rows(), 0);
  for (const Anchor& anchor : anchors) {
    if (anchor.vertex >= surface.size()) continue;  // of no surface
    const Index vertex = surfaces.surface.vertices[anchor.vertex];
    double& slip = out.slip_mm[vertex];
    slip = std::max(slip, anchor.slipped_mm);
  }
  for (const auto& [pair, sum] : sums)
    if (sum.forces.normal_N > 0) out.pairs.push_back(finished(sum, surface));
  out.pressure_kPa.assign(positions.rows(), 0);
  const PressedSurface::Pressures found = surface.under(all);
  for (Index v = 0; v < surface.size(); ++v)
    out.pressure_kPa[surfaces.surface.vertices[v]] = kPa_per_MPa * found.pressure_MPa[v];
  return out;
}

}  // namespace softkin::physical
