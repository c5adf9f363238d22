#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/tetrahedra.hpp>

namespace softkin {

namespace {

constexpr double shortest_mm = 1e-9;    // between two corners
constexpr double unstretchable = 1e4;   // E A of a fibre that does not stretch, over E l^2 of the softest material
constexpr int corners_per_turn = 120;   // a helix is shorter by 1.1e-4 through them
constexpr double max_corners = 100000;  // of a helix

/// Curves of sensors are cut as fibres are, and have none of their stiffness.
bool is_sensor(const FibreSpec& spec) {
  return spec.stiffness_N == 0.0;
}

[[noreturn]] void refuse_fibre(const FibreSpec& spec, const std::string& what) {
  throw InvalidInput(spec.origin, (is_sensor(spec) ? "sensor '" : "fibre '") + spec.name + "' " + what);
}

std::vector<Vec3> corners_of(const FibreSpec& spec, const Helix& helix) {
  const auto above_0 = [&](double value, const char* name) {
    if (!(value > 0) || !std::isfinite(value)) refuse_fibre(spec, std::string("needs ") + name + " above 0");
  };
  above_0(helix.radius, "a radius");
  above_0(helix.turns, "turns");
  if (!(helix.pitch >= 0) || !std::isfinite(helix.pitch)) refuse_fibre(spec, "needs a pitch of 0 or more");
  if (!helix.start.allFinite() || !helix.axis.allFinite() || !(helix.axis.norm() > 0))
    refuse_fibre(spec, "needs an axis with a direction");
  if (helix.turns * corners_per_turn > max_corners) refuse_fibre(spec, "has too many turns to follow");
  const Vec3 along = helix.axis.normalized();
  const Vec3 across = helix.first - helix.first.dot(along) * along;
  if (!(across.norm() > 0) || !across.allFinite()) refuse_fibre(spec, "begins on its axis");
  const Vec3 first = across.normalized(), second = along.cross(first);
  const int count = std::max(2, static_cast<int>(std::ceil(helix.turns * corners_per_turn)));
  std::vector<Vec3> corners;
  for (int i = 0; i <= count; ++i) {
    const double turned = helix.turns * i / count;
    const double angle = (helix.left_handed ? -2 : 2) * std::numbers::pi * turned;
    corners.push_back(helix.start + helix.pitch * turned * along +
                      helix.radius * (std::cos(angle) * first + std::sin(angle) * second));
  }
  return corners;
}

std::vector<Vec3> corners_of(const FibreSpec& spec) {
  if (const auto* helix = std::get_if<Helix>(&spec.path)) return corners_of(spec, *helix);
  const auto& points = std::get<std::vector<Vec3>>(spec.path);
  if (points.size() < 2) refuse_fibre(spec, "needs at least two points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) refuse_fibre(spec, "has a point that is not finite");
    if (i > 0 && !((points[i] - points[i - 1]).norm() > shortest_mm))
      refuse_fibre(spec,
                   "has no length between points " + std::to_string(i - 1) + " and " + std::to_string(i) + " (from 0)");
  }
  return points;
}

/// The elements with which a fibre moves: those of its region, or all of its robot.
class Carrier {
 public:
  Carrier(Compilation& c, const FibreSpec& spec) : whole_(body_of(c, spec.robot)) {
    if (!spec.region) return;
    const Region& region = c.regions.find(*spec.region, spec.origin);
    std::vector<Tetrahedron> tetrahedra;
    std::vector<EdgeNodes> edge_nodes;
    std::vector<Prism> prisms;
    for (const Index e : region.tetrahedra) {
      const Index own = c.tetrahedron_at[e];
      if (own < 0 || c.model.elements.tetrahedron_roles[own].material < 0) continue;
      tetrahedra.push_back(c.model.elements.tetrahedra[own]);
      if (!c.model.elements.edge_nodes.empty()) edge_nodes.push_back(c.model.elements.edge_nodes[own]);
    }
    for (const Index e : region.prisms)
      if (const Index own = c.prism_at[e]; own >= 0) prisms.push_back(c.model.elements.prisms[own]);
    if (tetrahedra.empty() && prisms.empty())
      refuse_fibre(spec, "runs in region '" + *spec.region + "', which has no element of the body");
    own_ = std::make_unique<const Embedder>(c.model.rest, tetrahedra, prisms, edge_nodes);
  }

  [[nodiscard]] const Embedder& embedder() const { return own_ ? *own_ : whole_.embedder; }
  [[nodiscard]] const Body& whole() const { return whole_; }

 private:
  const Body& whole_;
  std::unique_ptr<const Embedder> own_;
};

/// Returns the place between two points of one element: its stretch, 1 at rest, as a function of the element's
/// vertices.
FibrePlace place_between(const Points& rest, const EmbeddedPoint& a, const EmbeddedPoint& b, double length_mm) {
  FibrePlace place{{}, {}, {}, length_mm};
  const double apart = (b.at(rest) - a.at(rest)).norm();
  const auto add = [&](const EmbeddedPoint& point, double sign) {
    for (std::size_t i = 0; i < point.vertices.size(); ++i) {
      const std::size_t at =
          std::find(place.vertices.begin(), place.vertices.end(), point.vertices[i]) - place.vertices.begin();
      if (at == place.vertices.size()) {
        place.vertices.push_back(point.vertices[i]);
        place.weights.push_back(0);
        place.slopes.push_back(0);
      }
      place.weights[at] += point.weights[i] / 2;
      place.slopes[at] += sign * point.weights[i] / apart;
    }
  };
  add(a, -1);
  add(b, 1);
  Vec3 along = Vec3::Zero();
  for (std::size_t i = 0; i < place.vertices.size(); ++i) along += place.slopes[i] * vertex_at(rest, place.vertices[i]);
  for (double& slope : place.slopes) slope /= along.norm();
  return place;
}

/// The places of a straight piece: its middle, or Gauss' two of order 2. The shape functions of straight elements are
/// quadratic along it at most, so that the secant about a place is the tangent there.
void add_places(const Compilation& c, const Embedder& embedder, Index element, const Vec3& from, const Vec3& to,
                Fibre& fibre) {
  constexpr double shortest_secant = 1e-3;  // over the element's longest edge: weights are known to 1e-13
  const bool quadratic = !c.model.elements.edge_nodes.empty();
  const double length = (to - from).norm(), off = quadratic ? 0.5 / std::sqrt(3.0) : 0;
  const Vec3 along = (to - from) / length;
  const Vec3 half = std::max((quadratic ? 0.2 : 0.5) * length, shortest_secant * embedder.edge_of(element)) * along;
  for (const double side : quadratic ? std::vector<double>{-1, 1} : std::vector<double>{0}) {
    const Vec3 middle = from + (0.5 + side * off) * length * along;
    fibre.places.push_back(place_between(c.model.rest, embedder.embed_in(element, middle - half),
                                         embedder.embed_in(element, middle + half), quadratic ? length / 2 : length));
  }
}

void check_numbers(const FibreSpec& spec, const std::set<std::string>& names) {
  if (names.contains(spec.name)) throw InvalidInput(spec.origin, "there are two fibres '" + spec.name + "'");
  if (spec.stiffness_N && (!(*spec.stiffness_N > 0) || !std::isfinite(*spec.stiffness_N)))
    throw InvalidInput(spec.origin, "fibre '" + spec.name +
                                        "' needs a stiffness above 0 N, Young's modulus times the area of its section");
}

/// Returns the stiffness of a fibre that does not stretch [N].
double unstretchable_N(const Compilation& c, const Embedder& embedder, const std::vector<Vec3>& corners) {
  double softest = std::numeric_limits<double>::infinity(), longest = 0;
  for (const Material& material : c.model.elements.materials)
    softest = std::min(softest, stiffness_at_rest(material.elastic).youngs_modulus_MPa);
  for (const Vec3& corner : corners) longest = std::max(longest, embedder.edge_near(corner));
  return unstretchable * softest * longest * longest;
}

/// The point of a fibre that is farthest outside the elements with which it moves.
struct Outside {
  Vec3 point = Vec3::Zero();
  double distance_mm = 0;
};

Outside cut(const Compilation& c, const Embedder& embedder, const std::vector<Vec3>& corners, Fibre& fibre) {
  Outside outside;
  const auto look = [&](const EmbeddedPoint& embedded, const Vec3& point) {
    if (embedded.distance_mm > outside.distance_mm) outside = {point, embedded.distance_mm};
  };
  fibre.knots.push_back(embedder.embed(corners.front()));
  look(fibre.knots.front(), corners.front());
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vec3 &from = corners[i], along = corners[i + 1] - from;
    for (const Embedder::Piece& piece : embedder.pieces(from, corners[i + 1])) {
      const Vec3 begin = from + piece.begin * along, end = from + piece.end * along;
      add_places(c, embedder, piece.element, begin, end, fibre);
      fibre.knots.push_back(embedder.embed_in(piece.element, end));
      look(fibre.knots.back(), end);
    }
  }
  return outside;
}

Fibre fibre_of(Compilation& c, const FibreSpec& spec, std::vector<std::pair<double, std::string>>& reported) {
  if (body_of(c, spec.robot).embedder.empty())
    refuse_fibre(spec, "needs a body to run in, but every element belongs to a chamber");
  const Carrier carrier(c, spec);
  const std::vector<Vec3> corners = corners_of(spec);
  Fibre fibre{spec.name, 0, spec.tension_only, {}, {}};
  fibre.stiffness_N = spec.stiffness_N ? *spec.stiffness_N : unstretchable_N(c, carrier.embedder(), corners);
  Outside outside;
  try {
    outside = cut(c, carrier.embedder(), corners, fibre);
  } catch (const InvalidInput& error) {
    refuse_fibre(spec, std::string("runs where ") + error.what());
  }
  const auto& [point, distance] = outside;
  if (const double most = max_outside(carrier.whole(), c.model.rest, point); distance > most)
    refuse_fibre(spec, "runs " + number(distance) + " mm from the elements that carry it, " + too_far_text(most) +
                           ", at (" + number(point[0]) + ", " + number(point[1]) + ", " + number(point[2]) +
                           ") mm: move it into the body or onto it, or check the unit");
  reported.push_back({distance, spec.name});
  return fibre;
}

}  // namespace

std::vector<FibrePlace> places_along(Compilation& c, const std::string& name, const std::vector<Vec3>& points,
                                     const std::string& robot, const Origin& origin) {
  FibreSpec spec{.name = name, .path = points, .stiffness_N = 0.0, .region = {}, .robot = robot, .origin = origin};
  std::vector<std::pair<double, std::string>> outside;
  std::vector<FibrePlace> places = fibre_of(c, spec, outside).places;
  if (outside.front().first > 1e-6 * c.model.diagonal_mm)
    c.model.notes.push_back("Sensor '" + name + "' runs outside the elements, by " + number(outside.front().first) +
                            " mm: the nearest elements carry it there.");
  return places;
}

void compile_fibres(Compilation& c) {
  if (c.spec.fibres.empty()) return;
  if (c.spec.formulation != Formulation::physical) {
    c.model.notes.push_back(counted(c.spec.fibres.size(), "fibre is", "fibres are") +
                            " left out: the target-shape formulation knows no forces.");
    return;
  }
  std::set<std::string> names;
  std::vector<std::pair<double, std::string>> outside;  // by how much [mm], which
  for (const FibreSpec& spec : c.spec.fibres) {
    check_numbers(spec, names);
    names.insert(spec.name);
    c.model.reinforcement.fibres.push_back(fibre_of(c, spec, outside));
  }
  std::erase_if(outside, [&](const auto& fibre) { return fibre.first <= 1e-6 * c.model.diagonal_mm; });
  if (outside.empty()) return;
  const auto& [distance, name] = *std::max_element(outside.begin(), outside.end());
  c.model.notes.push_back(counted(outside.size(), "fibre runs", "fibres run") + " outside the elements, at most '" +
                          name + "', by " + number(distance) + " mm: the nearest elements carry it there.");
}

}  // namespace softkin
