#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/refine_surface.hpp>

namespace softkin {

namespace {

constexpr double min_size = 0.01, max_size = 3;  // of a surface's diagonal, over the body's
constexpr double min_alike = 0.8;                // of the smaller volume over the larger one
constexpr double max_apart = 0.25;               // of the distance, over the mean edge
constexpr double max_aside = 0.15;  // of the distance, over 6 volumes / area: the edge of a cube, a ball's diameter
constexpr double max_filled = 0.1, noted_filled = 0.001;  // of the volume
constexpr double finest = 0.1;                            // edges of an embedded surface, over those of elements
constexpr std::size_t max_triangles = 500000;

std::string text_of(const Shell& shell) {
  return number(std::abs(shell.volume)) + " mm^3 around " + point_text(shell.center) + " mm";
}

std::vector<Triangle> triangles_of(const TriangleSurface& surface, const Shell& shell) {
  std::vector<Triangle> triangles;
  for (const Index t : shell.triangles) triangles.push_back(surface.triangles[t]);
  return triangles;
}

void refuse_nested(const ActuatorSpec& spec, const TriangleSurface& surface, const std::vector<Shell>& shells) {
  if (shells.size() < 2) return;
  for (const Shell& outer : shells) {
    const SurfaceTree tree(surface.vertices, triangles_of(surface, outer));
    for (const Shell& inner : shells) {
      if (&inner == &outer || !outer.bounds.contains(inner.bounds)) continue;
      const Triangle& t = surface.triangles[inner.triangles[0]];
      const Vec3 point =
          (vertex_at(surface.vertices, t[0]) + vertex_at(surface.vertices, t[1]) + vertex_at(surface.vertices, t[2])) /
          3;
      const bool apart = tree.distance(point) > 1e-9 * outer.bounds.diagonal().norm();
      if (apart && tree.contains(point))
        refuse(spec, "has a surface of " + std::to_string(shells.size()) + " shells, of which one of " +
                         text_of(inner) + " lies inside one of " + text_of(outer) +
                         ": leave out all but the wall of the cavity, such as the robot's skin");
    }
  }
}

double area_of(const Points& vertices, const std::vector<Triangle>& triangles) {
  double area = 0;
  for (const auto& [a, b, c] : triangles)
    area +=
        0.5 *
        (vertex_at(vertices, b) - vertex_at(vertices, a)).cross(vertex_at(vertices, c) - vertex_at(vertices, a)).norm();
  return area;
}

double mean_edge(const Points& vertices, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles)
    for (int i = 0; i < 3; ++i) sum += (vertices.row(t[i]) - vertices.row(t[(i + 1) % 3])).norm();
  return sum / (3.0 * static_cast<double>(triangles.size()));
}

/// The farthest that a corner or a middle of the triangles lies from another surface [mm].
double distance(const Points& vertices, const std::vector<Triangle>& triangles, const SurfaceTree& other) {
  double farthest = 0;
  for (const Triangle& t : triangles) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : t) {
      const Vec3 corner = vertex_at(vertices, v);
      farthest = std::max(farthest, other.distance(corner));
      middle += corner / 3;
    }
    farthest = std::max(farthest, other.distance(middle));
  }
  return farthest;
}

struct Match {
  std::size_t space = 0;
  double distance = 0;  // [mm]
  double most = 0;      // that it may be [mm]
  [[nodiscard]] bool is_near() const { return distance <= most; }
};

/// The empty space that a shell of the surface bounds, or the nearest one of a like volume; none where there is none.
std::optional<Match> matching_space(Compilation& c, const TriangleSurface& surface, const Shell& shell) {
  const std::vector<EmptySpace>& spaces = empty_spaces(c);
  const std::vector<Triangle> triangles = triangles_of(surface, shell);
  std::optional<Match> best;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    const EmptySpace& space = spaces[i];
    const auto [low, high] = std::minmax(space.volume, shell.volume);
    if (low < min_alike * high || !space.bounds.intersects(shell.bounds)) continue;
    const double edge = std::max(mean_edge(surface.vertices, triangles), mean_edge(c.model.rest, space.triangles));
    const double size = 6 * space.volume / area_of(c.model.rest, space.triangles);
    const double apart = std::max(distance(surface.vertices, triangles, SurfaceTree(c.model.rest, space.triangles)),
                                  distance(c.model.rest, space.triangles, SurfaceTree(surface.vertices, triangles)));
    const Match match{i, apart, std::min(max_apart * edge, max_aside * size)};
    if (!best || std::pair(!match.is_near(), apart) < std::pair(!best->is_near(), best->distance)) best = match;
  }
  return best;
}

/// The spaces that the surface's shells bound; nothing where one of them bounds none.
///
/// too_far  the spaces that shells would bound if they lay nearer
std::vector<Match> matching_spaces(Compilation& c, const TriangleSurface& surface, const std::vector<Shell>& shells,
                                   std::vector<Match>& too_far) {
  std::vector<Match> matches;
  bool all = true;
  for (const Shell& shell : shells) {
    const auto match = matching_space(c, surface, shell);
    all = all && match && match->is_near();
    if (match) (match->is_near() ? matches : too_far).push_back(*match);
  }
  return all ? matches : std::vector<Match>{};
}

/// Reports why a surface is cut by the elements although the body has an empty space like it.
void note_distance(Compilation& c, const ActuatorSpec& spec, const Match& match) {
  const EmptySpace& space = empty_spaces(c)[match.space];
  c.model.notes.push_back("The surface of actuator '" + spec.name + "' lies up to " + number(match.distance, 3) +
                          " mm from the faces of the empty space of " + softkin::text_of(space) + ", more than the " +
                          number(match.most, 3) +
                          " mm (a quarter of an edge, at most 0.15 of the space's width) within which it bounds that "
                          "space. So it is cut at every element, which takes long: take 'void_at' with a point of "
                          "that space, such as its centre, or a surface that follows its faces.");
}

void check_size(const Compilation& c, const ActuatorSpec& spec, const TriangleSurface& surface) {
  Bounds bounds;
  for (Index v = 0; v < surface.vertices.rows(); ++v) bounds.extend(vertex_at(surface.vertices, v));
  const double body = diagonal_of(c, spec.robot), diagonal = bounds.diagonal().norm(), ratio = diagonal / body;
  if (ratio < min_size || ratio > max_size)
    refuse(spec, "has a surface of " + number(diagonal) + " mm from corner to corner, " + number(ratio, 3) +
                     " times the body's " + number(body) +
                     " mm: it is of another unit; name that of its file, `surface: {file: F, unit: mm}`");
}

/// A surface well inside an empty space would push at walls that are elsewhere.
void refuse_inside_space(Compilation& c, const ActuatorSpec& spec, const Shell& shell) {
  for (const EmptySpace& space : empty_spaces(c)) {
    if (shell.volume >= min_alike * space.volume || !space.bounds.contains(shell.center)) continue;
    if (!SurfaceTree(c.model.rest, space.triangles).contains(shell.center)) continue;
    refuse(spec, "has a surface of " + text_of(shell) + " inside an empty space of the body of " +
                     softkin::text_of(space) +
                     ": let it bound that space, or leave `surface` out where the body has no other");
  }
}

double filled_volume(const Compilation& c, const SurfaceTree& tree) {
  double filled = 0;
  const auto add = [&](const auto& elements, const std::vector<double>& volumes) {
    for (std::size_t e = 0; e < elements.size(); ++e) {
      Vec3 middle = Vec3::Zero();
      for (const Index v : elements[e]) middle += vertex_at(c.model.rest, v) / double(elements[e].size());
      if (tree.contains(middle)) filled += volumes[e];
    }
  };
  add(c.model.elements.tetrahedra, c.model.elements.tetrahedron_volumes);
  add(c.chamber_tetrahedra, c.chamber_volumes);
  add(c.model.elements.prisms, c.model.elements.prism_volumes);
  return filled;
}

std::string percent(double fraction) {
  return number(100 * fraction, 3) + " %";
}

}  // namespace

TriangleSurface checked_surface(const ActuatorSpec& spec, TriangleSurface surface) {
  try {
    if (!surface.vertices.allFinite()) throw InvalidInput("the surface has a vertex that is not finite");
    surface.triangles = turned_outwards(surface.vertices, std::move(surface.triangles));
  } catch (const InvalidInput& error) {
    refuse(spec, std::string("needs a closed surface: ") + error.what());
  }
  refuse_nested(spec, surface, shells_of(surface.vertices, surface.triangles));
  return surface;
}

ChamberWall checked_wall(const Compilation& c, const ActuatorSpec& spec, const std::string& name) {
  const Region& region = c.regions.find(name, spec.origin);
  if (region.dimension != 2)
    refuse(spec, "has a wall, region '" + name + "', that is no group of faces" +
                     (region.dimension == 3 ? "; a volume is named with `region: " + name + "`" : ""));
  ChamberWall wall;
  for (const Index i : region.triangles) wall.triangles.push_back(c.mesh.triangles[i]);
  for (const Index i : region.quads) {
    const Quad& q = c.mesh.quads[i];
    wall.triangles.insert(wall.triangles.end(), {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}});
  }
  const Points& rest = c.model.rest;
  try {
    wall.triangles = turned_alike(rest, std::move(wall.triangles));
    if (rim_of(wall.triangles).empty())
      wall.triangles = c.sheets.empty() ? turned_outwards(rest, std::move(wall.triangles))
                                        : turned_outwards_or_flat(rest, std::move(wall.triangles));
  } catch (const InvalidInput& error) {
    refuse(spec, "has a wall, region '" + name + "', that bounds no chamber: " + error.what() +
                     "; the region must hold every face around the chamber and no other");
  }
  if (rim_of(wall.triangles).empty())
    wall.closed = {rest, wall.triangles};
  else
    wall = closed_by_planes(c, spec, name, std::move(wall.triangles));
  refuse_nested(spec, wall.closed, shells_of(wall.closed.vertices, wall.closed.triangles));
  return wall;
}

void check_filling(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& surface) {
  const double filled = filled_volume(c, SurfaceTree(surface.vertices, surface.triangles)),
               volume = enclosed_volume(surface.vertices, surface.triangles);
  if (filled > max_filled * volume)
    refuse(spec, "has a surface around " + number(volume) + " mm^3, of which " +
                     percent(std::min(1.0, filled / volume)) +
                     " are elements of the body or of another chamber, which resist inside: make them a region and "
                     "list it under `void`, or name it as the chamber (`region`)");
  if (filled > noted_filled * volume)
    c.model.notes.push_back(percent(filled / volume) + " of the volume in the surface of actuator '" + spec.name +
                            "' are elements of the body, which resist inside.");
}

void select_cavity(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& given, Actuator& actuator) {
  TriangleSurface surface = checked_surface(spec, given);
  check_size(c, spec, given);
  const std::vector<Shell> shells = shells_of(surface.vertices, surface.triangles);
  std::vector<Match> too_far;
  const std::vector<Match> matches = matching_spaces(c, surface, shells, too_far);
  for (const Match& match : matches) {
    take_empty_space(c, spec, match.space, actuator);
    c.model.notes.push_back("The surface of actuator '" + spec.name + "' bounds the empty space of " +
                            softkin::text_of(empty_spaces(c)[match.space]) +
                            ", whose own faces take the pressure; it lies up to " + number(match.distance, 3) +
                            " mm from them.");
  }
  if (!matches.empty()) return;
  for (const Match& match : too_far) note_distance(c, spec, match);
  for (const Shell& shell : shells) refuse_inside_space(c, spec, shell);
  check_filling(c, spec, surface);
  std::get<ChamberDrive>(actuator.drive).surface = std::move(surface.triangles);
}

void embed_surface(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& given, Actuator& actuator) {
  const bool physical = c.spec.formulation == Formulation::physical;
  const Body& body = body_of(c, spec.robot);
  auto& chamber = std::get<ChamberDrive>(actuator.drive);
  TriangleSurface surface{given.vertices, chamber.surface};
  if (physical) {
    try {
      surface = refined(
          std::move(surface), [&](const Vec3& middle) { return finest * body.embedder.edge_near(middle); },
          max_triangles);
    } catch (const InvalidInput& error) {
      refuse(spec, std::string("has a surface that cuts through too many elements: ") + error.what() +
                       "; mesh the chamber and name it as `region` or `void`");
    }
  }
  chamber.surface = surface.triangles;
  chamber.points.reserve(surface.vertices.rows());
  std::size_t outside = 0;
  double farthest = 0;
  for (Index i = 0; i < surface.vertices.rows(); ++i) {
    const Vec3 vertex = vertex_at(surface.vertices, i);
    try {
      chamber.points.push_back(body.embedder.embed(vertex));
    } catch (const InvalidInput& error) {
      refuse(spec, "has a surface whose point " + point_text(vertex) + " mm cannot be embedded: " + error.what());
    }
    const double distance = chamber.points.back().distance_mm;
    if (!(distance > 1e-6 * c.model.diagonal_mm)) continue;
    farthest = std::max(farthest, distance);
    ++outside;
    if (const double most = max_outside(body, c.model.rest, vertex); distance > most)
      refuse(spec, "has a surface whose point " + point_text(vertex) + " mm is " + number(distance) +
                       " mm from the body, " + too_far_text(most) +
                       ": let the surface run along the body, or check its unit");
  }
  if (outside > 0)
    c.model.notes.push_back(counted(outside, "vertex", "vertices") + " of the surface of actuator '" + spec.name +
                            "' " + (outside == 1 ? "is" : "are") + " up to " + number(farthest) +
                            " mm outside the body and follow" + (outside == 1 ? "s" : "") + " its nearest elements.");
  if (!physical) return;
  Points embedded(surface.vertices.rows(), 3);
  for (Index i = 0; i < embedded.rows(); ++i) embedded.row(i) = chamber.points[i].at(c.model.rest).transpose();
  actuator.rest_measure = enclosed_volume(embedded, chamber.surface);
}

}  // namespace softkin
