#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

constexpr double cubic_metres = 1e-9;  // in a mm^3

using PrismIntegrals = Eigen::Matrix<double, 6, 1>;

/// Integrals of a prism's shape functions L_i (1 -+ z) / 2 over it [mm^3]. They are of degree 2 in the triangle and 3
/// along z: three points by two are exact.
PrismIntegrals prism_integrals(const Points& vertices, const Prism& prism) {
  Eigen::Matrix<double, 6, 3> nodes;
  for (int i = 0; i < 6; ++i) nodes.row(i) = vertices.row(prism[i]);
  const double gauss = 1 / std::sqrt(3.0);
  PrismIntegrals integrals = PrismIntegrals::Zero();
  for (int i = 0; i < 3; ++i)
    for (const double z : {-gauss, gauss}) {
      const Vec3 l = Vec3::Constant(1.0 / 6) + 0.5 * Vec3::Unit(i);
      PrismIntegrals shape, across;
      shape << (1 - z) / 2 * l, (1 + z) / 2 * l;
      across << -0.5 * l, 0.5 * l;
      const Vec3 u = (1 - z) / 2 * (nodes.row(1) - nodes.row(0)) + (1 + z) / 2 * (nodes.row(4) - nodes.row(3));
      const Vec3 v = (1 - z) / 2 * (nodes.row(2) - nodes.row(0)) + (1 + z) / 2 * (nodes.row(5) - nodes.row(3));
      integrals += u.cross(v).dot(nodes.transpose() * across) / 6 * shape;
    }
  return integrals;
}

void add_weight(Compilation& c) {
  Model& model = c.model;
  const auto per_volume = [&](const ElementRole& role) {  // [N/mm^3]
    return Eigen::RowVector3d(model.elements.materials[role.material].density * cubic_metres *
                              c.spec.loads.gravity.transpose());
  };
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    const Eigen::RowVector3d weight = per_volume(model.elements.tetrahedron_roles[e]);
    if (model.elements.edge_nodes.empty()) {
      for (const Index v : model.elements.tetrahedra[e])
        model.loads.dead.row(v) += model.elements.tetrahedron_volumes[e] / 4 * weight;
      continue;
    }
    const TetrahedronWeights integrals =
        shape_integrals(nodes_of(model.rest, model.elements.tetrahedra[e], model.elements.edge_nodes[e]));
    for (int i = 0; i < 10; ++i)
      model.loads.dead.row(i < 4 ? model.elements.tetrahedra[e][i] : model.elements.edge_nodes[e][i - 4]) +=
          integrals[i] * weight;
  }
  for (std::size_t e = 0; e < model.elements.prisms.size(); ++e) {
    const PrismIntegrals integrals = prism_integrals(model.rest, model.elements.prisms[e]);
    const Eigen::RowVector3d weight = per_volume(model.elements.prism_roles[e]);
    for (int i = 0; i < 6; ++i) model.loads.dead.row(model.elements.prisms[e][i]) += integrals[i] * weight;
  }
}

void check_density(Compilation& c) {
  std::vector<bool> has_element(c.model.elements.materials.size());
  for (const auto* roles : {&c.model.elements.tetrahedron_roles, &c.model.elements.prism_roles})
    for (const ElementRole& role : *roles) has_element[role.material] = true;
  bool any = c.spec.contact && std::any_of(c.spec.contact->bodies.begin(), c.spec.contact->bodies.end(),
                                           [](const BodySpec& body) { return body.density > 0; });
  any = any ||
        std::any_of(c.spec.layers.begin(), c.spec.layers.end(), [](const auto& layer) { return layer->density > 0; });
  for (std::size_t m = 0; m < has_element.size(); ++m)
    any = any || (has_element[m] && c.model.elements.materials[m].density > 0);
  if (!any) throw InvalidInput(c.origin, "there is gravity but no material or layer has a density");
  for (std::size_t m = 0; m < has_element.size(); ++m)
    if (has_element[m] && c.model.elements.materials[m].density == 0)
      c.model.notes.push_back("The material of region '" + c.model.elements.materials[m].region +
                              "' has no density and so no weight.");
}

std::string label(const ForceSpec& spec) {
  return spec.name.empty() ? "a force" : "force '" + spec.name + "'";
}

/// The force of an entry, or its moment.
struct Commanded {
  const ForceSpec& spec;
  bool is_moment = false;

  [[nodiscard]] const Vec3& value() const { return is_moment ? spec.moment : spec.force; }
  [[nodiscard]] const std::optional<std::array<Vec3, 2>>& range() const {
    return is_moment ? spec.moment_range : spec.range;
  }
  /// Is it commanded along an axis, and not held to one value there.
  [[nodiscard]] bool along(int axis) const { return range() && (*range())[0][axis] < (*range())[1][axis]; }
};

void check_values(const Commanded& of) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(of.spec.at.origin, (of.is_moment ? "the moment of " : "") + label(of.spec) + " " + why);
  };
  if (!of.value().allFinite()) refuse("is not finite");
  if (!of.range()) return;
  const char* const unit = of.is_moment ? " N mm" : " N";
  const auto& [low, high] = *of.range();
  if (of.spec.name.empty()) refuse("is commanded, and so needs a name");
  if (!low.allFinite() || !high.allFinite()) refuse("has a range that is not finite");
  for (int axis = 0; axis < 3; ++axis) {
    const std::string along = std::string(" along ") + "xyz"[axis];
    if (low[axis] > high[axis])
      refuse("has the range " + interval_text(low[axis], high[axis]) + unit + along + ": the low end comes first");
    if (of.value()[axis] < low[axis] || of.value()[axis] > high[axis])
      refuse("is " + number(of.value()[axis]) + unit + along + ", outside its range " +
             interval_text(low[axis], high[axis]) + unit);
  }
}

Actuator command_of(const Commanded& of, int axis, Drive drive) {
  Actuator command;
  command.name = of.spec.name + (of.is_moment ? "_m" : "_f") + "xyz"[axis];
  command.drive = std::move(drive);
  command.control = Control::load;
  command.low = (*of.range())[0][axis];
  command.high = (*of.range())[1][axis];
  command.rest = of.value()[axis];
  return command;
}

/// Of a rigid region's vertices four that are far apart, or three where all are in a plane: those farthest from the
/// first, from the line of two, from the plane of three.
std::vector<Index> spread_out(const Points& rest, const std::vector<Index>& vertices) {
  const auto at = [&](Index v) { return vertex_at(rest, v); };
  std::vector<Index> spread{vertices.front()};
  const auto farthest = [&](const auto& distance) {
    const Index found = *std::max_element(vertices.begin(), vertices.end(),
                                          [&](Index a, Index b) { return distance(a) < distance(b); });
    spread.push_back(found);
    return distance(found);
  };
  const double length = farthest([&](Index v) { return (at(v) - at(spread[0])).norm(); });
  const Vec3 along = (at(spread[1]) - at(spread[0])).normalized();
  farthest([&](Index v) { return along.cross(at(v) - at(spread[0])).norm(); });
  const Vec3 normal = along.cross(at(spread[2]) - at(spread[0])).normalized();
  constexpr double flat = 1e-3;
  if (farthest([&](Index v) { return std::abs(normal.dot(at(v) - at(spread[0]))); }) < flat * length) spread.pop_back();
  return spread;
}

/// The vertices by which a moment takes hold of the rigid region that holds all of an entry's.
std::vector<Index> moment_vertices(const Compilation& c, const ForceSpec& spec) {
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(spec.at.origin, "the moment of " + label(spec) + why);
  };
  const auto* region = std::get_if<std::string>(&spec.at.point);
  if (region == nullptr) refuse(" acts on a rigid region: give 'region' in place of 'point'");
  const std::vector<Index> vertices = c.regions.resolve({*region, spec.at.origin}).vertices;
  for (const RigidRegion& rigid : c.model.rigid)
    if (std::all_of(vertices.begin(), vertices.end(), [&](Index v) {
          return !c.model.elements.used[v] || std::binary_search(rigid.vertices.begin(), rigid.vertices.end(), v);
        }))
      return spread_out(c.model.rest, rigid.vertices);
  refuse(" acts on a rigid region, which '" + *region + "' is not: list it under 'rigid'");
  return {};
}

void add_moment(Compilation& c, const ForceSpec& spec) {
  const Commanded moment{spec, true};
  check_values(moment);
  if (spec.moment.isZero(0) && !spec.moment_range) return;
  RegionMoment of{moment_vertices(c, spec)};
  for (int axis = 0; axis < 3; ++axis)
    if (moment.along(axis)) {
      const Index index = c.model.loads.moments.size();
      c.force_commands.push_back(command_of(moment, axis, MomentCommand{index, axis}));
    } else {
      of.moment_Nmm[axis] = spec.moment[axis];
    }
  c.model.loads.moments.push_back(std::move(of));
}

void add_force(Compilation& c, const ForceSpec& spec) {
  const Commanded force{spec};
  check_values(force);
  const EmbeddedPoint at = embed_point(c, spec.at, "the point of " + label(spec));
  std::vector<CavityFace> faces;
  if (const auto* region = std::get_if<std::string>(&spec.at.point); region != nullptr && spec.range)
    for (const LoadedFace& face : surface_faces(c, {*region, spec.at.origin})) faces.push_back(face.face);
  for (int axis = 0; axis < 3; ++axis) {
    if (force.along(axis)) {
      c.force_commands.push_back(command_of(force, axis, ForceCommand{.axis = axis, .place = at, .faces = faces}));
      continue;
    }
    for (std::size_t i = 0; i < at.vertices.size(); ++i)
      c.model.loads.dead(at.vertices[i], axis) += at.weights[i] * spec.force[axis];
  }
  add_moment(c, spec);
}

}  // namespace

void compile_loads(Compilation& c) {
  const bool weight = !c.spec.loads.gravity.isZero(0);
  if (c.spec.formulation != Formulation::physical) {
    if (weight) c.model.notes.emplace_back("Gravity is left out: the target-shape formulation knows no forces.");
    if (!c.spec.loads.forces.empty())
      c.model.notes.push_back(counted(c.spec.loads.forces.size(), "force is", "forces are") +
                              " left out: the target-shape formulation knows none.");
    if (!c.spec.loads.tractions.empty())
      c.model.notes.push_back(counted(c.spec.loads.tractions.size(), "traction is", "tractions are") +
                              " left out: the target-shape formulation knows no forces.");
    if (c.spec.loads.liquid_around)
      c.model.notes.emplace_back("The liquid around it is left out: the target-shape formulation knows no forces.");
    return;
  }
  if (!c.spec.loads.gravity.allFinite()) throw InvalidInput(c.origin, "gravity is not finite");
  c.model.loads.dead = Points::Zero(c.model.rest.rows(), 3);
  if (weight) {
    check_density(c);
    add_weight(c);
  }
  std::set<std::string> names;
  for (const ForceSpec& spec : c.spec.loads.forces) {
    if (!spec.name.empty() && !names.insert(spec.name).second)
      throw InvalidInput(spec.at.origin, "there are two forces '" + spec.name + "'");
    add_force(c, spec);
  }
  compile_tractions(c);
  compile_liquid_around(c);
}

void add_force_commands(Compilation& c) {
  for (Actuator& command : c.force_commands) {
    if (find_actuator(c.model, command.name))
      throw InvalidInput(c.origin, "the command '" + command.name +
                                       "' of a load has the name of an actuator: give one of them another name");
    c.model.actuators.push_back(std::move(command));
  }
}

}  // namespace softkin
