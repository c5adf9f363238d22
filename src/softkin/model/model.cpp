#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <softkin/model/families.hpp>
#include <softkin/model/growth.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/mesh/surface_tree.hpp>
#include <softkin/model/model.hpp>
#include <type_traits>

namespace softkin {

namespace {

const CurveBranch* branch_of(const Actuator& actuator, Branch which) {
  if (!actuator.curve || (which == Branch::unloading && !actuator.curve->unloading)) return nullptr;
  return &actuator.curve->branch(which);
}

bool holds(const std::vector<double>& ascending, double value) {
  return value >= ascending.front() && value <= ascending.back();
}

/// Of the table that a kind has its data in, and along which axis, or by which command of that; -1: none.
std::pair<Index, int> place_of(const CableDrive&) {
  return {-1, -1};
}
std::pair<Index, int> place_of(const ChamberDrive&) {
  return {-1, -1};
}
std::pair<Index, int> place_of(const DeaDrive&) {
  return {-1, -1};
}
std::pair<Index, int> place_of(const MagneticDrive& field) {
  return {field.source, static_cast<int>(field.command)};
}
std::pair<Index, int> place_of(const GrowthDrive& growth) {
  return {growth.growth, -1};
}
std::pair<Index, int> place_of(const MotionCommand& motion) {
  return {motion.part, motion.axis};
}
std::pair<Index, int> place_of(const ForceCommand& force) {
  return {force.body, force.axis};
}
std::pair<Index, int> place_of(const HoldCommand& hold) {
  return {hold.body, -1};
}
std::pair<Index, int> place_of(const TurnCommand& turn) {
  return {turn.turn, -1};
}
std::pair<Index, int> place_of(const MomentCommand& moment) {
  return {moment.moment, moment.axis};
}
std::pair<Index, int> place_of(const PressureCommand& pressure) {
  return {pressure.traction, -1};
}

template <class Kind>
const Kind& as_or_empty(const Drive& drive) {
  static const Kind empty;
  const Kind* is = std::get_if<Kind>(&drive);
  return is ? *is : empty;
}

class Hash {
 public:
  template <class... Values>
  void add(const Values&... values) {
    (put(values), ...);
  }

  [[nodiscard]] std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(state_));
    return digits;
  }

 private:
  void word(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) {
      state_ ^= (value >> shift) & 0xFF;
      state_ *= 0x100000001b3;
    }
  }
  void put(double value) { word(std::bit_cast<std::uint64_t>(value)); }
  template <class Whole>
  requires std::is_integral_v<Whole> || std::is_enum_v<Whole>
  void put(Whole value) { word(static_cast<std::uint64_t>(value)); }
  void put(const std::string& text) {
    put(text.size());
    for (const char c : text) put(c);
  }
  void put(const Points& points) {
    put(points.rows());
    for (Eigen::Index i = 0; i < points.size(); ++i) put(points.data()[i]);
  }
  template <class Item>
  void put(const std::vector<Item>& items) {
    put(items.size());
    for (const auto& item : items) put(item);
  }
  template <class Item, std::size_t N>
  void put(const std::array<Item, N>& items) {
    for (const Item& item : items) put(item);
  }
  void put(const Vec3& vector) { add(vector[0], vector[1], vector[2]); }
  void put(const UniformField& field) { put(field.direction); }
  void put(const CoilLoop& loop) { add(loop.center, loop.axis, loop.radius_mm, loop.turns); }
  void put(const CoilField& field) { put(field.loops); }
  void put(const GridField& field) { add(field.low, field.step, field.counts, field.per_ampere); }
  void put(const DipoleField& field) { add(field.position, field.moment); }
  void put(const FieldSource& source) {
    add(source.name, source.field.index());
    std::visit([this](const auto& field) { put(field); }, source.field);
  }
  void put(const std::optional<double>& value) { add(value.has_value(), value.value_or(0)); }
  void put(const ElementRole& role) { add(role.material, role.actuator, role.region); }
  // what a robot does not have leaves the digits of older versions
  void put(const ElasticLaw& e) {
    add(e.law, e.mu, e.lambda, e.c10, e.c01, e.c20, e.c30, e.bulk);
    if (e.jm != 0) add(e.jm);
    for (const OgdenTerm& term : e.ogden)
      if (term.alpha != 0) add(term.mu, term.alpha);
  }
  void put(const ViscousBranch& branch) { add(branch.modulus_MPa, branch.time_s); }
  void put(const Material& m) {
    add(m.region, m.shape_ratio, m.weight, m.elastic, m.density, m.linear_range);
    if (m.permittivity != 1) add(m.permittivity);
    if (!m.viscosity.empty()) add(m.viscosity);
    if (m.mixed) add(m.mixed);
    if (m.families) add(m.families->tetrahedra, m.families->prisms, m.families->families);
  }
  void put(const CavityFace& face) { add(face.corners, face.edges); }
  void put(const LoadedFace& loaded) { add(loaded.face, loaded.fraction); }
  void put(const FollowingTraction& t) {
    add(t.traction_MPa, t.pressure_MPa, t.faces);
    if (!t.deeper_MPa_mm.isZero(0)) add(t.deeper_MPa_mm, t.level_mm);
  }
  void put(const RegionMoment& m) { add(m.vertices, m.moment_Nmm); }
  void put(const Families::Family& f) { add(f.k1_MPa, f.k2, f.dispersion, f.directions); }
  void put(const EmbeddedPoint& p) { add(p.vertices, p.weights); }
  void put(const FibrePlace& p) { add(p.vertices, p.slopes, p.length_mm); }
  void put(const Fibre& f) { add(f.name, f.stiffness_N, f.tension_only, f.places); }
  void put(const Eigen::Vector2d& vector) { add(vector[0], vector[1]); }
  void put(const Mat3& matrix) { add(Vec3(matrix.col(0)), Vec3(matrix.col(1)), Vec3(matrix.col(2))); }
  void put(const LayerPlace& p) { add(p.vertices, p.slopes, p.area_mm2); }
  void put(const Eigen::Matrix<double, 5, 1>& v) { add(v[0], v[1], v[2], v[3], v[4]); }
  void put(const LayerBend& b) { add(b.vertices, b.parts, b.place.stiffness, b.place.rest); }
  void put(const LayerJoint& j) {
    for (const LayerJoint::Side& side : j.sides) add(side.vertices, side.parts);
    add(j.joint.length, j.joint.penalty, j.joint.moment, j.joint.angle);
  }
  void put(const std::shared_ptr<const Layer>& l) {
    add(l->name, l->thickness_mm, l->law.stiffness, l->law.tension_only, l->places, l->bends, l->joints);
  }
  void put(const CableGap& gap) { add(gap.segment, gap.apex); }
  void put(const Marker& marker) {
    add(marker.name, marker.point);
    if (!marker.arms.empty()) add(marker.stem);
  }
  void put(const SupportTurn& t) { add(t.axis, t.about, t.displacement, t.vertices); }
  void put(const RigidRegion& region) { add(region.name, region.vertices); }
  void put(const FreeBody& body) { add(body.name, body.vertices, body.center, body.mass_kg); }
  void put(const ContactPart& part) { add(part.name, part.rank, part.halfspace); }
  void put(const ContactPair& pair) { add(pair.touch, pair.friction); }
  void put(const ContactModel& c) {
    add(c.distance_mm, c.modulus_MPa, c.parts, c.pairs, c.triangles, c.part_of, c.area, c.other_vertices);
  }
  void put(const Filling& f) {
    add(f.liquid, f.pushed, f.exponent, f.compressibility, f.atmosphere_MPa, f.dead_mm3, f.syringe_mm3, f.chamber_mm3);
  }
  void put(const GrowthCurve& curve) { add(curve.reference_C(), curve.values()); }
  void put(const std::shared_ptr<const Growth>& g) {
    add(g->actuator, g->tetrahedra, g->prisms, g->directions, g->keeps_volume, g->temperature.has_value());
    if (g->temperature) put(*g->temperature);
  }
  void put(const ConnectedChamber& chamber) { add(chamber.region, chamber.end); }
  // of every kind the same members in the same order, as in older versions, whatever it has of them
  void put(const Drive& drive) {
    const auto& cable = as_or_empty<CableDrive>(drive);
    const auto& chamber = as_or_empty<ChamberDrive>(drive);
    const auto& force = as_or_empty<ForceCommand>(drive);
    std::vector<EmbeddedPoint> points = cable.points.empty() ? chamber.points : cable.points;
    if (force.place) points = {*force.place};
    add(chamber.tetrahedra, force.faces.empty() ? chamber.cavity : force.faces, as_or_empty<DeaDrive>(drive).prisms,
        points, chamber.surface, cable.gaps);
    const auto [index, axis] = std::visit([](const auto& of) { return place_of(of); }, drive);
    add(index, axis);
  }
  void put(const Actuator& a) {
    add(a.name, a.drive.index(), a.control, a.rest, a.weight, a.distribution == Distribution::minimum_norm, a.drive,
        a.rest_measure);
    if (a.factor != 1 || a.offset != 0) add(a.factor, a.offset);
    if (a.backlash != 0) add(a.backlash);
    if (has_friction(a)) add(a.as<CableDrive>()->friction, a.as<CableDrive>()->sheath);
    if (under_voltage(a)) add(a.as<DeaDrive>()->fractions, a.as<DeaDrive>()->prestretch);
    if (a.distribution == Distribution::proportional) add(a.distribution);
    if (const Filling* filling = filling_of(a)) put(*filling);
    if (!connected_chambers(a).empty()) add(connected_chambers(a));
  }

  std::uint64_t state_ = 0xcbf29ce484222325;
};

// Three times the volume between a face and the origin.
double linear_face(const Points& positions, const CavityFace& face, const Vec3& origin) {
  const Vec3 a = vertex_at(positions, face.corners[0]) - origin, b = vertex_at(positions, face.corners[1]) - origin,
             c = vertex_at(positions, face.corners[2]) - origin;
  return 0.5 * a.dot(b.cross(c));
}

double quadratic_face(const Points& positions, const CavityFace& face, const Vec3& origin) {
  TriangleNodes nodes;
  for (int i = 0; i < 3; ++i) {
    nodes.row(i) = positions.row(face.corners[i]) - origin.transpose();
    nodes.row(i + 3) = positions.row(face.edges[i]) - origin.transpose();
  }
  double sum = 0;
  for (const TrianglePoint& point : triangle_rule()) {
    const Vec3 x = nodes.transpose() * point.shape, u = nodes.transpose() * point.along_u,
               v = nodes.transpose() * point.along_v;
    sum += point.weight * x.dot(u.cross(v));
  }
  return sum;
}

}  // namespace

std::vector<Index> nodes_of(const CavityFace& face) {
  std::vector<Index> nodes(face.corners.begin(), face.corners.end());
  if (face.edges[0] >= 0) nodes.insert(nodes.end(), face.edges.begin(), face.edges.end());
  return nodes;
}

int order_of(const Model& model) {
  const auto is_quadratic = [](const auto& layer) { return !layer->faces.empty() && layer->faces[0].edges[0] >= 0; };
  return !model.elements.edge_nodes.empty() ||
                 std::any_of(model.reinforcement.layers.begin(), model.reinforcement.layers.end(), is_quadratic)
             ? 2
             : 1;
}

std::vector<Triangle> flat_triangles(const CavityFace& face) {
  if (face.edges[0] < 0) return {face.corners};
  const std::array<Triangle, 4> parts = quarters(face.corners, face.edges);
  return {parts.begin(), parts.end()};
}

std::vector<bool> vertices_of_elements(const Model& model) {
  std::vector<bool> of_element(model.rest.rows());
  const auto mark = [&](const auto& elements) {
    for (const auto& element : elements)
      for (const Index v : element) of_element[v] = true;
  };
  mark(model.elements.tetrahedra);
  mark(model.elements.edge_nodes);
  mark(model.elements.prisms);
  return of_element;
}

double enclosed_volume(const Points& positions, const std::vector<CavityFace>& faces) {
  if (faces.empty()) return 0;
  // relative to a point of the boundary: far from the origin the terms would cancel
  const Vec3 origin = vertex_at(positions, faces.front().corners[0]);
  double three_volumes = 0;
  for (const CavityFace& face : faces)
    three_volumes += face.edges[0] < 0 ? linear_face(positions, face, origin) : quadratic_face(positions, face, origin);
  return three_volumes / 3;
}

std::vector<double> connected_volumes(const Actuator& actuator, const Points& positions) {
  std::vector<double> volumes;
  const auto* chambers = actuator.as<ChamberDrive>();
  if (!chambers) return volumes;
  auto begin = chambers->cavity.begin();
  for (const ConnectedChamber& chamber : chambers->connected) {
    const auto end = chambers->cavity.begin() + chamber.end;
    volumes.push_back(enclosed_volume(positions, std::vector<CavityFace>(begin, end)));
    begin = end;
  }
  return volumes;
}

Eigen::VectorXd Model::rest_actuation() const {
  Eigen::VectorXd ratios(actuators.size());
  for (std::size_t i = 0; i < actuators.size(); ++i)
    ratios[i] = std::clamp(actuators[i].rest, actuators[i].low, actuators[i].high);
  return ratios;
}

double ratio_by_curve(const Actuator& actuator, double input, Branch branch) {
  if (!actuator.curve) throw InvalidInput("actuator '" + actuator.name + "' has no curve");
  return actuator.rest * actuator.curve->ratio(input, branch);
}

std::optional<double> input_by_curve(const Actuator& actuator, double ratio, Branch branch) {
  const CurveBranch* curve = branch_of(actuator, branch);
  const double relative = ratio / actuator.rest;
  if (curve == nullptr || !holds(curve->ratio.y(), relative)) return std::nullopt;
  return curve->ratio.inverse(relative);
}

std::optional<double> spread_by_curve(const Actuator& actuator, double input, Branch branch) {
  const CurveBranch* curve = branch_of(actuator, branch);
  if (curve == nullptr || curve->spread.empty() || !holds(curve->ratio.x(), input)) return std::nullopt;
  const std::vector<double>& x = curve->ratio.x();
  const auto above = std::max<std::ptrdiff_t>(1, std::lower_bound(x.begin(), x.end(), input) - x.begin());
  const std::size_t i = above;
  const double fraction = (input - x[i - 1]) / (x[i] - x[i - 1]);
  return actuator.rest * ((1 - fraction) * curve->spread[i - 1] + fraction * curve->spread[i]);
}

std::array<Index, 2> Model::vertices_of_part(Index part) const {
  std::array<Index, 2> range{static_cast<Index>(rest.rows()), 0};
  for (std::size_t t = 0; t < contact.triangles.size(); ++t)
    if (contact.part_of[t] == part)
      for (const Index v : contact.triangles[t]) range = {std::min(range[0], v), std::max(range[1], v + 1)};
  return range;
}

const Filling* filling_of(const Actuator& actuator) {
  const auto* chamber = actuator.as<ChamberDrive>();
  return chamber && chamber->filling ? &*chamber->filling : nullptr;
}

bool flat_at_rest(const Actuator& actuator) {
  const auto* chamber = actuator.as<ChamberDrive>();
  return chamber && chamber->flat;
}

const std::vector<ConnectedChamber>& connected_chambers(const Actuator& actuator) {
  static const std::vector<ConnectedChamber> none;
  const auto* chamber = actuator.as<ChamberDrive>();
  return chamber ? chamber->connected : none;
}

bool drives(const Actuator& actuator) {
  return traits(actuator.drive).drives;
}

bool loads_robot(const Actuator& actuator) {
  const auto* force = actuator.as<ForceCommand>();
  return actuator.is<MomentCommand>() || actuator.is<PressureCommand>() || (force && force->place);
}

bool has_friction(const Actuator& actuator) {
  const auto* cable = actuator.as<CableDrive>();
  return cable && (cable->friction > 0 || cable->sheath > 0);
}

bool has_friction(const Model& model) {
  return model.contact.has_friction() || std::any_of(model.actuators.begin(), model.actuators.end(),
                                                     [](const Actuator& actuator) { return has_friction(actuator); });
}

bool under_voltage(const Actuator& actuator) {
  return actuator.is<DeaDrive>() && actuator.control == Control::load;
}

bool varies(const Actuator& actuator) {
  return drives(actuator) && actuator.low < actuator.high;
}

std::string fingerprint_of(const Model& model) {
  Hash hash;
  hash.add(model.formulation, model.rest, model.elements.tetrahedra, model.elements.edge_nodes, model.elements.prisms,
           model.elements.tetrahedron_roles, model.elements.prism_roles, model.elements.region_names,
           model.elements.materials, model.actuators, model.markers, model.rigid, model.held.fixed, model.held.at,
           model.loads.dead);
  if (model.weights != ElementWeights::printed) hash.add(model.weights);
  if (!model.held.turns.empty()) hash.add(model.held.turns);
  if (!model.loads.tractions.empty()) hash.add(model.loads.tractions);
  if (!model.loads.moments.empty()) hash.add(model.loads.moments);
  if (!model.reinforcement.fibres.empty()) hash.add(model.reinforcement.fibres);
  if (!model.reinforcement.layers.empty()) hash.add(model.reinforcement.layers);
  if (!model.growths.empty()) hash.add(model.growths);
  if (model.contact.any()) hash.add(model.contact, model.bodies);
  if (model.magnetism) {
    hash.add(model.magnetism->remanence, model.magnetism->sources);
    const std::vector<Magnetisation>& all = model.magnetism->magnetisation;
    if (std::find(all.begin(), all.end(), Magnetisation::turns) != all.end()) hash.add(all);
  }
  return hash.text();
}

std::string fingerprint_of(const Points& positions) {
  Hash hash;
  hash.add(positions);
  return hash.text();
}

}  // namespace softkin
