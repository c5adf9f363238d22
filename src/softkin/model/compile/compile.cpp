#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/curving.hpp>
#include <softkin/model/compile/layers.hpp>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

Index marker_of(const Model& model, const FootSpec& spec) {
  for (std::size_t m = 0; m < model.markers.size(); ++m)
    if (model.markers[m].name == spec.marker) return m;
  throw InvalidInput(spec.origin, "a foot stands at marker '" + spec.marker + "', which the robot does not have");
}

void check_friction(const FootSpec& spec, double friction, const char* direction) {
  if (!(friction >= 0) || !std::isfinite(friction))
    throw InvalidInput(spec.origin, "foot '" + spec.marker + "': the friction " + direction +
                                        " must be 0 N or more, not " + number(friction));
}

EmbeddedPoint embed_inside(Compilation& c, const Vec3& point, const PointRef& reference, const std::string& what) {
  const Origin& origin = reference.origin;
  const Body& body = body_of(c, reference.robot);
  if (!point.allFinite()) throw InvalidInput(origin, what + " is not finite");
  if (carries_nothing(body))
    throw InvalidInput(origin, what + " needs a body to lie in, but every element belongs to a chamber");
  EmbeddedPoint embedded;
  try {
    embedded = carried(body, c.model.rest, point);
  } catch (const InvalidInput& error) {
    throw InvalidInput(origin, what + ": " + error.what());
  }
  const std::string distance = number(embedded.distance_mm);
  if (const double most = max_outside(body, c.model.rest, point); embedded.distance_mm > most)
    throw InvalidInput(origin, what + " is " + distance + " mm from the mesh, " + too_far_text(most) +
                                   ": move it to the body, mesh what holds it, or check the unit");
  if (embedded.distance_mm > 1e-6 * c.model.diagonal_mm)
    c.model.notes.push_back(what + " is " + distance + " mm outside the body and follows its nearest element.");
  return embedded;
}

}  // namespace

std::string too_far_text(double max_mm) {
  return "farther than the " + number(max_mm) + " mm to which its nearest element can carry it";
}

EmbeddedPoint embed_point(Compilation& c, const PointRef& reference, const std::string& what) {
  if (const auto* point = std::get_if<Vec3>(&reference.point)) return embed_inside(c, *point, reference, what);
  const auto& name = std::get<std::string>(reference.point);
  const Region& region = c.regions.find(name, reference.origin);
  EmbeddedPoint mean;
  try {
    mean = mean_of(region, c.mesh, c.regions.edges());
  } catch (const InvalidInput& error) {
    throw InvalidInput(reference.origin, what + ": " + error.what());
  }
  for (const Index v : mean.vertices)
    if (!c.model.elements.used[v])
      throw InvalidInput(reference.origin, what + " is the mean of region '" + name + "', of which vertex " +
                                               std::to_string(v) + " (from 0) belongs to no element of the robot");
  return mean;
}

namespace {

/// A marker on a stem: mean of its region and what turns with it.
Marker on_stem(Compilation& c, const MarkerSpec& spec, const std::string& region) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(spec.at.origin, "marker '" + spec.name + "' " + why);
  };
  Marker marker{spec.name, embed_point(c, {region, spec.at.origin}, "marker '" + spec.name + "'")};
  const Vec3 mean = marker.point.at(c.model.rest);
  marker.stem = spec.offset ? *spec.offset : std::get<Vec3>(spec.at.point) - mean;
  if (!marker.stem.allFinite()) refuse("is not finite");
  if (marker.stem.norm() > c.model.diagonal_mm)
    refuse("is on a stem of " + number(marker.stem.norm()) + " mm, longer than the robot is from corner to corner, " +
           number(c.model.diagonal_mm) + " mm");
  if (!span_plane(c.model.rest, marker.point.vertices))
    refuse("stands on region '" + region + "', whose vertices are on a line: no stem turns with them");
  for (const Index v : marker.point.vertices) marker.arms.push_back(vertex_at(c.model.rest, v) - mean);
  return marker;
}

Marker made_marker(Compilation& c, const MarkerSpec& spec) {
  if (spec.carrier) return on_stem(c, spec, *spec.carrier);
  if (!spec.offset) return {spec.name, embed_point(c, spec.at, "marker '" + spec.name + "'")};
  return on_stem(c, spec, std::get<std::string>(spec.at.point));
}

}  // namespace

void compile_markers(Compilation& c) {
  std::set<std::string> names;
  for (const MarkerSpec& spec : c.spec.markers) {
    if (spec.name.empty()) throw InvalidInput(spec.at.origin, "a marker needs a name");
    if (!names.insert(spec.name).second)
      throw InvalidInput(spec.at.origin, "there are two markers '" + spec.name + "'");
    c.model.markers.push_back(made_marker(c, spec));
  }
}

namespace {

/// The mesh where the model takes it in another order than it has.
std::optional<Mesh> in_other_order(const RobotSpec& spec, std::vector<std::string>& notes) {
  const Origin origin{.file = spec.name};
  const bool is_quadratic = order_of(spec.mesh) == 2;
  if (spec.formulation == Formulation::physical) {
    if (!spec.mesh_options.quadratic || is_quadratic) return std::nullopt;
    if (!spec.mesh.prisms.empty())
      throw InvalidInput(origin, "a mesh with prisms cannot be of order 2: prisms are linear");
    check_cells(spec.mesh, origin);
    return elevated(spec.mesh);
  }
  if (is_quadratic)
    notes.emplace_back("The mesh is of order 2: its edge nodes are left out, target shapes are of linear elements.");
  else if (spec.mesh_options.quadratic)
    notes.emplace_back("The elements stay linear: target shapes are not of order 2.");
  if (!is_quadratic) return std::nullopt;
  check_cells(spec.mesh, origin);
  return lowered(spec.mesh);
}

}  // namespace

Model compile(const RobotSpec& spec) {
  std::vector<std::string> notes = spec.notes;
  const std::optional<Mesh> other = in_other_order(spec, notes);
  const Mesh& straight = other ? *other : spec.mesh;
  std::optional<Mesh> curved;
  if (spec.mesh_options.curve && order_of(straight) == 2) curved = straight;
  Compilation c(spec, curved ? *curved : straight, straight);
  if (curved) curve_mesh(spec, *curved, notes);
  c.model.notes = std::move(notes);
  c.model.name = spec.name;
  c.model.formulation = spec.formulation;
  if (spec.formulation == Formulation::target_shape) c.model.weights = spec.weights;
  if (spec.mesh.no_sidecars) c.model.warnings = spec.mesh.missing;
  refuse_too_large(c);
  check_contact(c);
  compile_elements(c);
  refuse_mesh_errors(c);
  compile_actuator_elements(c);
  compile_materials(c);
  compile_magnetism(c);
  compile_growth(c);
  compile_families(c);
  compile_actuator_points(c);
  compile_supports(c);
  check_openings(c);
  compile_caps(c);
  compile_markers(c);
  compile_feet(c);
  compile_loads(c);
  compile_fibres(c);
  compile_layers(c);
  compile_sensors(c);
  check_anchoring(c.model, c.origin);
  check_hinges(c.model, c.origin);
  doubt_units(c);
  doubt_places(c);
  doubt_linear_tetrahedra(c);
  doubt_straight_edges(c);
  add_turn_commands(c);
  add_force_commands(c);
  compile_contact(c);
  return std::move(c.model);
}

void compile_feet(Compilation& c) {
  const std::vector<FootSpec>& feet = c.spec.feet;
  if (feet.empty()) return;
  if (feet.size() != 2)
    throw InvalidInput(feet.back().origin, "a robot walks on two feet, the rear one and the front one, not on " +
                                               std::to_string(feet.size()));
  for (const FootSpec& spec : feet) {
    check_friction(spec, spec.forward, "forward");
    check_friction(spec, spec.backward, "backward");
    c.model.feet.push_back({marker_of(c.model, spec), spec.forward, spec.backward});
  }
  for (std::size_t f = 0; f < feet.size(); ++f)
    if (!c.model.markers[c.model.feet[f].marker].arms.empty())
      throw InvalidInput(feet[f].origin, "marker '" + feet[f].marker + "' is on a stem: a foot stands on the body");
  if (c.model.feet[0].marker == c.model.feet[1].marker)
    throw InvalidInput(feet[1].origin, "both feet stand at marker '" + feet[1].marker + "'");
}

}  // namespace softkin
