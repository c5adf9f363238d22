#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <softkin/contact/candidates.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/mesh/shells.hpp>
#include <softkin/model/mesh/surface_tree.hpp>
#include <softkin/statics/physical/contact_at_rest.hpp>
#include <softkin/statics/physical/contact_points.hpp>

namespace softkin::physical {

namespace {

constexpr double touching = 1e-9;      // over the robot's diagonal: nearer than this is no gap
constexpr double too_close = 2;        // over the contact distance
constexpr double advised = 2.2;        // gap over the distance to choose
constexpr double neighbourhood = 6;    // along the surface, over the contact distance
constexpr double facing_cosine = 0.5;  // between the line across the gap and the normals

/// Data of all checks: the surfaces in a shape, at rest mostly, and the part of each of their vertices and triangles.
class RestingSurfaces {
 public:
  RestingSurfaces(const Model& of, const Points& nodes)
      : model(of),
        points(ContactPoints::in(of, nodes)),
        surface(contact::make_surface(of.contact.triangles, points)),
        team(1) {
    contact::Exclusions exclusions;
    exclusions.group.assign(model.rest.rows(), -1);
    for (std::size_t t = 0; t < of.contact.triangles.size(); ++t) {
      const Index part = of.contact.part_of[t];
      const ContactRank rank = of.contact.parts[part].rank;
      for (const Index v : of.contact.triangles[t])
        exclusions.group[v] = rank == ContactRank::robot ? -1 : rank == ContactRank::obstacle ? 0 : 1 + part;
    }
    broad.emplace(surface, points, std::move(exclusions));
  }

  [[nodiscard]] Index part(Index triangle) const { return model.contact.part_of[triangle]; }
  [[nodiscard]] ContactRank rank(Index triangle) const { return model.contact.parts[part(triangle)].rank; }
  [[nodiscard]] bool of_robot(Index triangle) const { return rank(triangle) == ContactRank::robot; }
  /// The robot, body or obstacle whose triangle it is: the first of its parts.
  [[nodiscard]] Index solid(Index triangle) const {
    const ContactPart& of = model.contact.parts[part(triangle)];
    return of.rank == ContactRank::robot ? of.robot : part(triangle);
  }
  /// A triangle at a vertex or edge, by place.
  [[nodiscard]] static Index first_at(const contact::Lists& triangles, Index i) {
    return triangles.items[triangles.begin[i]];
  }
  [[nodiscard]] Index at_vertex(Index vertex) const { return first_at(surface.vertex_triangles, vertex); }
  [[nodiscard]] Index at_edge(Index edge) const { return first_at(surface.edge_triangles, edge); }
  [[nodiscard]] const contact::Corners& corners(Index triangle) const { return surface.triangles[triangle]; }
  [[nodiscard]] Vec3 rest(Index vertex) const { return vertex_at(points, vertex); }
  [[nodiscard]] bool may_touch(Index triangle, Index other) const {
    return model.contact.pair(part(triangle), part(other)).touch;
  }
  [[nodiscard]] bool sheet(Index triangle) const { return model.contact.sheet(triangle); }
  /// Are they a sheet and a surface of the same robot? Where these lie on each other at rest, contact between them is
  /// excluded.
  [[nodiscard]] bool sheet_on_own(Index triangle, Index other) const {
    return (sheet(triangle) || sheet(other)) && solid(triangle) == solid(other);
  }
  /// Must they be apart at rest?
  [[nodiscard]] bool kept_apart(Index triangle, Index other) const {
    return may_touch(triangle, other) && !sheet_on_own(triangle, other);
  }
  /// Is a side so near to a triangle at rest that contact between them is excluded?
  [[nodiscard]] bool near_at_rest(const contact::Ends& side, Index triangle) const {
    const contact::Corners& c = corners(triangle);
    double least = std::numeric_limits<double>::infinity();
    for (const Index v : side)
      least = std::min(least, contact::vertex_triangle(contact::points_of(model.rest, {v, c[0], c[1], c[2]})).squared);
    for (std::size_t k = 0; k < 3; ++k)
      least = std::min(
          least, contact::edge_edge(contact::points_of(model.rest, {side[0], side[1], c[k], c[(k + 1) % 3]})).squared);
    return std::sqrt(least) < too_close * model.contact.distance_mm;
  }

  const Model& model;
  Points points;
  contact::Surface surface;
  Team team;
  std::optional<contact::BroadPhase> broad;
};

const ContactPart& part_at(const Model& model, Index part) {
  return model.contact.parts[part];
}

/// "the robot's body", "the body of robot 'left'"
std::string of_robot_text(const Model& model, Index robot, const std::string& what) {
  const std::string label = model.contact.label(robot);
  return part_at(model, robot).name == robot_part_name ? label + "'s " + what : "the " + what + " of " + label;
}

std::string kind_of(const ContactPart& part) {
  return part.rank == ContactRank::body ? "body" : "obstacle";
}

std::string place_text(const Vec3& point) {
  return "at " + point_text(point) + " mm";
}

std::vector<Triangle> triangles_where(const RestingSurfaces& at, const std::function<bool(Index)>& accept) {
  std::vector<Triangle> triangles;
  for (std::size_t t = 0; t < at.surface.triangles.size(); ++t)
    if (accept(t)) triangles.push_back(at.surface.triangles[t]);
  return triangles;
}

bool is_closed(const Points& vertices, const std::vector<Triangle>& triangles) {
  const std::vector<Shell> shells = shells_of(vertices, triangles);
  return std::all_of(shells.begin(), shells.end(), [](const Shell& shell) { return shell.closed; });
}

/// "[0, 0, 1]", the opposite of a unit normal.
std::string turned_text(const Vec3& normal) {
  std::string text;
  for (const double x : normal) text += (text.empty() ? "[" : ", ") + number(std::abs(x) < 1e-9 ? 0 : -x, 4);
  return text + "]";
}

/// Rejects vertices on the wrong side of half-spaces.
void refuse_behind_planes(const RestingSurfaces& at) {
  const Model& model = at.model;
  for (std::size_t t = 0; t < at.surface.triangles.size(); ++t) {
    const Index plane = at.part(t);
    const ContactPart& part = part_at(model, plane);
    if (!part.halfspace) continue;
    const auto& [a, b, c] = at.surface.triangles[t];
    const Vec3 normal = (at.rest(b) - at.rest(a)).cross(at.rest(c) - at.rest(a)).normalized();
    double least = std::numeric_limits<double>::infinity(), most = -least;
    Vec3 lowest;
    Index deepest = -1;
    for (std::size_t i = 0; i < at.surface.vertices.size(); ++i) {
      const Index v = at.surface.vertices[i], own = at.at_vertex(i);
      if (at.rank(own) == ContactRank::obstacle) continue;
      const double height = normal.dot(at.rest(v) - at.rest(a));
      most = std::max(most, height);
      if (!(height < least)) continue;
      least = height;
      lowest = at.rest(v);
      deepest = at.part(own);
    }
    if (least > touching * model.diagonal_mm) continue;
    if (most <= touching * model.diagonal_mm)
      throw InvalidInput(part.origin, "all that may touch " + model.contact.label(plane) +
                                          " lies behind it at rest: its normal points out of the solid, towards the "
                                          "robot; turn it round, 'normal: " +
                                          turned_text(normal) + "'");
    const bool deep = least < -touching * model.diagonal_mm;
    throw InvalidInput(part.origin, model.contact.label_of_solid(deepest) + " " +
                                        (deep ? "lies " + number(-least) + " mm deep in " : std::string("touches ")) +
                                        model.contact.label(plane) + " at rest, " + place_text(lowest) +
                                        ": move it by more than " + number(std::max(0.0, -least)) +
                                        " mm against its normal, so that a gap is left");
  }
}

/// Where an edge passes through a triangle.
std::optional<Vec3> crossing(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto hit = meet_plane(from, to - from, a, b, c);
  if (!hit || hit->t < 0 || hit->t > 1 || hit->weights.minCoeff() < 0) return std::nullopt;
  return from + hit->t * (to - from);
}

/// Estimates the translation that separates two crossing surfaces: the depth of the deepest vertex of either in the
/// other; 0 where none is inside.
double depth_of(const Points& rest, const std::vector<Triangle>& one, const std::vector<Triangle>& other) {
  double deepest = 0;
  const auto look = [&](const std::vector<Triangle>& triangles, const std::vector<Triangle>& around) {
    if (!is_closed(rest, around)) return;
    const SurfaceTree tree(rest, around);
    for (const Triangle& t : triangles)
      for (const Index v : t)
        if (tree.contains(vertex_at(rest, v))) deepest = std::max(deepest, tree.distance(vertex_at(rest, v)));
  };
  look(one, other);
  look(other, one);
  return deepest;
}

[[noreturn]] void refuse_crossing(const RestingSurfaces& at, Index triangle, Index other, const Vec3& place) {
  if (at.part(other) < at.part(triangle)) std::swap(triangle, other);  // robots, bodies, obstacles
  const Index first = at.part(triangle), second = at.part(other);
  const ContactModel& contact = at.model.contact;
  const Origin& origin = part_at(at.model, second).origin;
  const std::string where = " at rest, " + place_text(place) + ": ";
  const std::string both = contact.label(first) + " and " + contact.label(second) + " touch or cross";
  if (at.solid(triangle) == at.solid(other))
    throw InvalidInput(part_at(at.model, first).origin,
                       (first == second ? contact.label(first) + " touches or crosses itself" : both) + where +
                           "leave a gap there or join the surfaces in the mesh, or set " + "'self: false'");
  const auto all_of = [&](Index solid) { return triangles_where(at, [&](Index t) { return at.solid(t) == solid; }); };
  const double depth = depth_of(at.points, all_of(at.solid(triangle)), all_of(at.solid(other)));
  throw InvalidInput(
      origin, both + where + "move " +
                  (at.of_robot(other) ? "one of the robots" : "the " + kind_of(part_at(at.model, second))) + " away" +
                  (depth > 0 ? " by about " + number(depth, 2) + " mm or more" : "") + ", so that a gap is left");
}

struct Crossing {
  Index triangle, other;
  Vec3 place;
};

/// Where surfaces pass through each other: every piece of their common line ends where an edge meets a triangle.
std::optional<Crossing> find_crossing(RestingSurfaces& at) {
  std::optional<Crossing> found;
  const contact::Surface& surface = at.surface;
  Points centres(surface.triangles.size(), 3);
  const auto box_of = [&](Index t) {
    contact::Box box;
    for (const Index v : at.corners(t)) box.extend(at.rest(v));
    return box;
  };
  for (Index t = 0; t < centres.rows(); ++t) centres.row(t) = box_of(t).center().transpose();
  contact::WideTree tree(centres);
  const auto still = [](const contact::Box& box) { return contact::MovingBox{box, contact::Box(Vec3::Zero())}; };
  tree.refit([&](Index t) { return still(box_of(t)); }, at.team);
  for (std::size_t e = 0; e < surface.edges.size() && !found; ++e) {
    const Index p = surface.edges[e][0], q = surface.edges[e][1];
    const Index own = at.at_edge(e);
    contact::Box box(at.rest(p));
    box.extend(at.rest(q));
    tree.each_met(still(box), [&](Index t) {
      const contact::Corners& c = at.corners(t);
      const bool shared = std::any_of(c.begin(), c.end(), [p, q](Index v) { return v == p || v == q; });
      if (shared || found || !at.may_touch(own, t)) return;
      if (at.sheet_on_own(own, t) && at.near_at_rest({p, q}, t)) return;
      if (const auto place = crossing(at.rest(p), at.rest(q), at.rest(c[0]), at.rest(c[1]), at.rest(c[2])))
        found = Crossing{own, t, *place};
    });
  }
  return found;
}

/// Rejects surfaces without a gap that do not pass through each other.
void refuse_touching(RestingSurfaces& at) {
  const double least = touching * at.model.diagonal_mm;
  contact::Candidates near;
  at.broad->find(at.points, least, at.team, near);
  for (const contact::Pair& pair : near.vertex_triangle) {
    const Index own = at.at_vertex(pair.first);
    if (!at.kept_apart(own, pair.second)) continue;
    const auto nodes = contact::nodes_of_vertex_triangle(at.surface, pair);
    if (contact::vertex_triangle(contact::points_of(at.points, nodes)).squared <= least * least)
      refuse_crossing(at, own, pair.second, at.rest(nodes[0]));
  }
  for (const contact::Pair& pair : near.edge_edge) {
    const Index own = at.at_edge(pair.first), other = at.at_edge(pair.second);
    if (!at.kept_apart(own, other)) continue;
    const auto x = contact::points_of(at.points, contact::nodes_of_edge_edge(at.surface, pair));
    const contact::Separation separation = contact::edge_edge(x);
    if (separation.squared <= least * least)
      refuse_crossing(at, own, other, separation.weights[0] * x.col(0) + separation.weights[1] * x.col(1));
  }
}

/// A vertex of each piece of a surface.
std::vector<Vec3> one_of_each(const Points& rest, const std::vector<Triangle>& triangles) {
  std::vector<Vec3> points;
  for (const Shell& shell : shells_of(rest, triangles))
    points.push_back(vertex_at(rest, triangles[shell.triangles[0]][0]));
  return points;
}

/// Rejects pieces inside a solid. One vertex of each is enough, as surfaces do not cross.
void refuse_inside(const RestingSurfaces& at) {
  const Points& rest = at.points;
  struct Solid {
    Index part;
    ContactRank rank;
    std::vector<Triangle> triangles;
    std::vector<Vec3> points;
    std::optional<SurfaceTree> tree;  // where it is closed
  };
  std::vector<Solid> solids;
  for (Index p = 0; p < std::ssize(at.model.contact.parts); ++p) {
    const ContactPart& part = part_at(at.model, p);
    if (part.halfspace || (part.rank == ContactRank::robot && part.robot != p)) continue;
    Solid solid{p, part.rank, triangles_where(at, [&](Index t) { return at.solid(t) == p; }), {}, {}};
    solid.points = one_of_each(rest, solid.triangles);
    std::vector<Triangle> around = triangles_where(at, [&](Index t) { return at.solid(t) == p && !at.sheet(t); });
    const bool any = !around.empty() && (part.rank == ContactRank::robot || is_closed(rest, around));
    if (any) solid.tree.emplace(rest, std::move(around));
    solids.push_back(std::move(solid));
  }
  for (const Solid& inner : solids)
    for (const Solid& outer : solids) {
      if (&inner == &outer || !outer.tree) continue;
      if (inner.rank == ContactRank::obstacle && outer.rank == ContactRank::obstacle) continue;
      for (const Vec3& point : inner.points) {
        if (!outer.tree->contains(point)) continue;
        const bool robot = outer.rank == ContactRank::robot;
        const ContactPart& named = part_at(at.model, robot ? inner.part : outer.part);
        throw InvalidInput(
            named.origin,
            at.model.contact.label(inner.part) + " lies inside " +
                (robot ? of_robot_text(at.model, outer.part, "body") : at.model.contact.label(outer.part)) +
                " at rest, " + place_text(point) + ": " +
                (robot ? "move it out" : "move the " + kind_of(named) + " away") + ", so that a gap is left");
      }
    }
}

/// Unit normals of the robot's vertices, by place: the mean over their triangles, weighted by area.
std::vector<Vec3> vertex_normals(const RestingSurfaces& at) {
  std::vector<Vec3> normals(at.surface.vertices.size(), Vec3::Zero());
  const contact::Lists& around = at.surface.vertex_triangles;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    for (Index i = around.begin[v]; i < around.begin[v + 1]; ++i) {
      const auto& [a, b, c] = at.corners(around.items[i]);
      normals[v] += (at.rest(b) - at.rest(a)).cross(at.rest(c) - at.rest(a));
    }
    normals[v].normalize();
  }
  return normals;
}

/// Finds distances along a surface.
class SurfaceWalk {
 public:
  explicit SurfaceWalk(const RestingSurfaces& at)
      : at_(at), next_(contact::neighbours_of(at.surface, at.points.rows(), 1)) {}

  /// Is the point of a triangle within a length of the vertex, along edges to a corner and from there straight [mm]?
  [[nodiscard]] bool reaches(Index vertex, const contact::Corners& corners, const Vec3& point, double length) const {
    using Reached = std::pair<double, Index>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> waiting;
    std::map<Index, double> shortest{{vertex, 0.0}};
    for (waiting.emplace(0.0, vertex); !waiting.empty();) {
      const auto [gone, from] = waiting.top();
      waiting.pop();
      if (gone > shortest[from]) continue;
      if (std::find(corners.begin(), corners.end(), from) != corners.end() &&
          gone + (at_.rest(from) - point).norm() <= length)
        return true;
      const std::size_t v = from;
      for (Index i = next_.begin[v]; i < next_.begin[v + 1]; ++i) {
        const Index to = next_.items[i];
        const double motion = gone + (at_.rest(to) - at_.rest(from)).norm();
        if (motion > length) continue;
        const auto [known, fresh] = shortest.emplace(to, motion);
        if (!fresh && known->second <= motion) continue;
        known->second = motion;
        waiting.emplace(motion, to);
      }
    }
    return false;
  }

 private:
  const RestingSurfaces& at_;
  contact::Lists next_;  // of every vertex of the model those an edge away, itself included
};

/// Rejects gaps of the robot that are too narrow for the contact distance.
void refuse_narrow_gaps(RestingSurfaces& at) {
  const double distance = at.model.contact.distance_mm;
  contact::Candidates near;
  at.broad->find(at.points, too_close * distance, at.team, near);
  const std::vector<Vec3> normals = vertex_normals(at);
  std::optional<SurfaceWalk> walk;
  double gap = too_close * distance;
  Index robot = 0;
  std::optional<Vec3> where;
  for (const contact::Pair& pair : near.vertex_triangle) {
    const Index own = at.at_vertex(pair.first);
    if (!at.of_robot(own) || at.solid(own) != at.solid(pair.second) || !at.kept_apart(own, pair.second)) continue;
    const auto nodes = contact::nodes_of_vertex_triangle(at.surface, pair);
    const contact::FourPoints x = contact::points_of(at.points, nodes);
    const contact::Separation separation = contact::vertex_triangle(x);
    const double apart = std::sqrt(separation.squared);
    if (!(apart < gap)) continue;
    const Vec3 motion = -separation.vector / apart;  // from the vertex to the triangle
    const Vec3 normal = (x.col(2) - x.col(1)).cross(x.col(3) - x.col(1)).normalized();
    if (!(motion.dot(normals[pair.first]) > facing_cosine && -motion.dot(normal) > facing_cosine)) continue;
    const double edge =
        std::max({(x.col(2) - x.col(1)).norm(), (x.col(3) - x.col(2)).norm(), (x.col(1) - x.col(3)).norm()});
    if (!walk) walk.emplace(at);
    if (walk->reaches(nodes[0], at.corners(pair.second), x.col(0) - separation.vector, neighbourhood * distance + edge))
      continue;
    gap = apart;
    where = x.col(0);
    robot = at.solid(own);
  }
  if (where)
    throw InvalidInput(at.model.contact.parts[0].origin,
                       "contact distance " + number(distance) + " mm is too large: " + place_text(*where) + " " +
                           of_robot_text(at.model, robot, "surfaces") + " are only " + number(gap, 3) +
                           " mm apart; choose at most " + number(gap / advised, 3) + " mm");
}

}  // namespace

void check_contact_at_rest(const Model& model) {
  if (!model.contact.any()) return;
  RestingSurfaces at(model, model.rest);
  refuse_behind_planes(at);
  if (const auto found = find_crossing(at)) refuse_crossing(at, found->triangle, found->other, found->place);
  refuse_touching(at);
  refuse_inside(at);
  refuse_narrow_gaps(at);
}

void check_contact_of_start(const Model& model, const Points& positions) {
  if (!model.contact.any()) return;
  RestingSurfaces at(model, positions);
  const auto found = find_crossing(at);
  if (!found) return;
  const Index first = at.part(found->triangle), second = at.part(found->other);
  const ContactModel& contact = model.contact;
  throw InvalidInput(
      "the start " +
      (first == second ? "has " + contact.label(first) + " pass through itself"
                       : "has " + contact.label(first) + " and " + contact.label(second) + " pass through each other") +
      " " + place_text(found->place) + ": contact keeps apart what is apart; start from another shape");
}

}  // namespace softkin::physical
