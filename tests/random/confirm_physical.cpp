#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <softkin/model/families.hpp>
#include <softkin/model/growth.hpp>
#include <softkin/model/mesh/triangle_points.hpp>

#include "random/commanded_fields.hpp"
#include "random/confirm.hpp"
#include "random/confirm_floor.hpp"
#include "random/confirm_loads.hpp"
#include "random/reference_elements.hpp"

namespace softkin::random_robots {

namespace {

/// Of the largest force at a vertex; the solver's own criterion is a step.
constexpr Real balanced = 1e-5L;
/// Of what the solver's tolerance stands for: a robot that is only carried elsewhere has no force to compare with.
constexpr Real fraction_of_tolerance = 1e-3L;
/// Tolerance relative to the requested volume or length.
constexpr Real met = 1e-8L;

RealPoints nodes_at(const Points& positions, const Index* nodes, int count) {
  RealPoints at(count, 3);
  for (int i = 0; i < count; ++i) at.row(i) = positions.row(nodes[i]).cast<Real>();
  return at;
}

LayerDrive drive_of(const Model& model, const State& state, const ElementRole& role) {
  constexpr Real vacuum = 8.8541878128e-6L;  // MPa per (kV/mm)^2
  if (role.actuator < 0) return {};
  const Real command = state.actuation[role.actuator];
  const Actuator& dea = model.actuators[role.actuator];
  if (dea.control == Control::ratio) return {command, 0};
  return {1 + static_cast<Real>(state.load_factor) * (static_cast<Real>(dea.as<DeaDrive>()->prestretch) - 1),
          vacuum * static_cast<Real>(model.elements.materials[role.material].permittivity) * command * command};
}

/// How a tetrahedron or prism has grown in a state, and by which of the growths.
struct Grown {
  ElementGrowth drive;
  Index grower = -1;
};
Grown grown(const Model& model, const State& state, bool prism, Index element) {
  for (std::size_t g = 0; g < model.growths.size(); ++g) {
    const Growth& growth = *model.growths[g];
    const std::vector<Index>& all = prism ? growth.prisms : growth.tetrahedra;
    const auto found = std::find(all.begin(), all.end(), element);
    if (found == all.end()) continue;
    const Real stretch = growth.stretch(state.actuation[growth.actuator]);
    if (growth.directions.empty()) return {{stretch, stretch}, static_cast<Index>(g)};
    const auto place = (prism ? growth.tetrahedra.size() : 0) + static_cast<std::size_t>(found - all.begin());
    return {{stretch, growth.keeps_volume ? 1 / std::sqrt(stretch) : 1, growth.directions[place].cast<Real>()},
            static_cast<Index>(g)};
  }
  return {};
}

/// The pressures of mixed elements: a number for each material, grower and corner, in the order in which elements name
/// them.
struct Pressing {
  std::map<std::array<Index, 3>, Index> numbers;
  std::vector<Real> missed, volume, area;  // by number: sums of what PressurePulls has

  Index number(Index material, Index grower, Index corner) {
    const auto [at, is_new] = numbers.emplace(std::array{material, grower, corner}, static_cast<Index>(missed.size()));
    if (is_new)
      for (std::vector<Real>* list : {&missed, &volume, &area}) list->push_back(0);
    return at->second;
  }
};

/// The law of a mixed material without what its pressures stand for: it keeps two shear moduli, or half.
Real take_bulk(ElasticLaw& law) {
  const double shear = law.law == Law::neo_hookean || law.law == Law::gent ? law.mu : 2 * (law.c10 + law.c01);
  double& part = law.law == Law::neo_hookean ? law.lambda : law.bulk;
  const double whole = part;
  part = std::min(2 * shear, whole / 2);
  return static_cast<Real>(whole) - part;
}

void add_pressures(const Model& model, const Equilibrium& found, Forces& forces, Confirmation& out) {
  Pressing pressing;
  const Eigen::VectorXd& all = found.state.pressures;
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    const Index material = model.elements.tetrahedron_roles[e].material;
    if (!model.elements.materials[material].mixed) continue;
    ElasticLaw law = model.elements.materials[material].elastic;
    const Real bulk = take_bulk(law);
    const Real shear = law.law == Law::neo_hookean || law.law == Law::gent ? law.mu : 2 * (law.c10 + law.c01);
    std::array<Index, 10> nodes;
    std::copy(model.elements.tetrahedra[e].begin(), model.elements.tetrahedra[e].end(), nodes.begin());
    if (!model.elements.edge_nodes.empty())
      std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
    const int count = model.elements.edge_nodes.empty() ? 4 : 10;
    const Grown growth = grown(model, found.state, false, e);
    std::array<Index, 4> numbers;
    std::array<Real, 4> pressures;
    for (std::size_t i = 0; i < 4; ++i) {
      numbers[i] = pressing.number(material, growth.grower, nodes[i]);
      pressures[i] = numbers[i] < all.size() ? all[numbers[i]] : 0;
    }
    const PressurePulls pulls =
        pressure_pulls_of(nodes_at(model.rest, nodes.data(), count),
                          nodes_at(found.state.positions, nodes.data(), count), pressures, bulk, shear, growth.drive);
    for (int i = 0; i < count; ++i) {
      const std::size_t at = i;
      forces.add(nodes[at], pulls.pulls.force[at], pulls.pulls.rounding[at]);
      forces.stiffness[nodes[at]] += pulls.pulls.stiffness[at];
    }
    for (std::size_t i = 0; i < 4; ++i) {
      pressing.missed[numbers[i]] += pulls.missed[i];
      pressing.volume[numbers[i]] += pulls.volume[i];
      pressing.area[numbers[i]] += pulls.area[i];
    }
  }
  if (static_cast<std::size_t>(all.size()) != pressing.missed.size())
    out.faults.push_back("there are " + std::to_string(all.size()) + " pressures, not " +
                         std::to_string(pressing.missed.size()));
  Real worst = 0;
  for (std::size_t n = 0; n < pressing.missed.size(); ++n)
    worst = std::max(worst, std::abs(pressing.missed[n]) /
                                (2 * found.report.tolerance_mm * pressing.area[n] + balanced * pressing.volume[n]));
  if (!(worst <= 1))
    out.faults.push_back("a volume is missed by " + digits(static_cast<double>(worst)) + " times what may be");
}

void add_elements(const Model& model, const Equilibrium& found, const State& begun, Forces& forces) {
  const Points& positions = found.state.positions;
  const auto add = [&](const Index* nodes, int count, Index material, const LayerDrive& drive, Real begun_ratio,
                       bool prism, std::size_t element) {
    const Index e = element;
    const BranchDrive branches{&model.elements.materials[material].viscosity, found.state.elapsed_s,
                               nodes_at(begun.positions, nodes, count), begun_ratio,
                               grown(model, begun, prism, e).drive};
    ElasticLaw law = model.elements.materials[material].elastic;
    if (model.elements.materials[material].mixed) (void)take_bulk(law);
    const ElementPulls pulls = pulls_of(law, nodes_at(model.rest, nodes, count), nodes_at(positions, nodes, count),
                                        drive, branches, grown(model, found.state, prism, e).drive);
    for (int i = 0; i < count; ++i) {
      forces.add(nodes[i], pulls.force[i], pulls.rounding[i]);
      forces.stiffness[nodes[i]] += pulls.stiffness[i];
    }
  };
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    std::array<Index, 10> nodes;
    std::copy(model.elements.tetrahedra[e].begin(), model.elements.tetrahedra[e].end(), nodes.begin());
    if (!model.elements.edge_nodes.empty())
      std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
    add(nodes.data(), model.elements.edge_nodes.empty() ? 4 : 10, model.elements.tetrahedron_roles[e].material, {}, 1,
        false, e);
  }
  for (std::size_t e = 0; e < model.elements.prisms.size(); ++e) {
    const ElementRole& role = model.elements.prism_roles[e];
    add(model.elements.prisms[e].data(), 6, role.material, drive_of(model, found.state, role),
        drive_of(model, begun, role).ratio, true, e);
  }
}

/// A length or a volume and its derivative in a set of nodes.
struct Measure {
  Real value = 0, rounding = 0;
  std::vector<EmbeddedPoint> nodes;
  std::vector<RealVec3> slopes;
  std::vector<Real> blurs;  // of the slopes

  std::size_t add_node(const EmbeddedPoint& node) {
    nodes.push_back(node);
    slopes.emplace_back(RealVec3::Zero());
    blurs.push_back(0);
    return nodes.size() - 1;
  }
};

RealVec3 place(const EmbeddedPoint& point, const Points& positions) {
  RealVec3 sum = RealVec3::Zero();
  for (std::size_t k = 0; k < point.vertices.size(); ++k)
    sum += static_cast<Real>(point.weights[k]) * positions.row(point.vertices[k]).transpose().cast<Real>();
  return sum;
}

EmbeddedPoint vertex(Index v) {
  return {{v}, {1.0}, 0};
}

Measure length_of(const CableDrive& cable, const Points& positions) {
  Measure measure;
  for (const EmbeddedPoint& point : cable.points) (void)measure.add_node(point);
  for (std::size_t i = 0; i + 1 < cable.points.size(); ++i) {
    const RealVec3 from = place(cable.points[i], positions), to = place(cable.points[i + 1], positions);
    const Real length = (to - from).norm(), blur = rounding_unit * (from.norm() + to.norm());
    measure.value += length;
    measure.rounding += blur;
    if (!(length > 0)) continue;
    measure.slopes[i] -= (to - from) / length;
    measure.slopes[i + 1] += (to - from) / length;
    measure.blurs[i] += blur / length;
    measure.blurs[i + 1] += blur / length;
  }
  return measure;
}

/// Replaces the gradient of a cable with friction: each segment's gradient is scaled by its tension over that at the
/// motor, by the memory of its eyelets. memory: index of the first of them
void rub(const CableDrive& cable, const Points& positions, const std::vector<double>& eyelets, std::size_t memory,
         double rest_length, Measure& measure) {
  const Real creep = 1e-4L * rest_length;
  const std::size_t count = cable.points.size() - 1;
  std::vector<RealVec3> along;
  std::vector<Real> beyond(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i)
    along.push_back(place(cable.points[i + 1], positions) - place(cable.points[i], positions));
  for (std::size_t i = count; i-- > 0;) beyond[i] = beyond[i + 1] + along[i].norm();
  std::fill(measure.slopes.begin(), measure.slopes.end(), RealVec3::Zero());
  Real logarithm = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Real limit = cable.sheath;
    if (i > 0) {
      const Real theta = std::atan2(along[i - 1].cross(along[i]).norm(), along[i - 1].dot(along[i]));
      limit = cable.friction * theta * theta / std::sqrt(theta * theta + 4e-6L);
    }
    const Real slip = eyelets.empty() ? 0 : (eyelets[memory + i] - beyond[i]) / creep;
    logarithm -= limit * std::clamp<Real>(slip, -1, 1);
    const Real fraction = std::exp(logarithm);
    measure.slopes[i] -= fraction * along[i].normalized();
    measure.slopes[i + 1] += fraction * along[i].normalized();
    const Real blur = sums * rounding_unit * fraction * limit * (beyond[0] + positions.cwiseAbs().maxCoeff()) / creep;
    measure.blurs[i] += blur;
    measure.blurs[i + 1] += blur;
  }
}

/// Shape functions of a triangle of order 1 or 2 (corners, edges 01, 12, 20) and their derivatives by u and v.
struct FaceShape {
  std::vector<Real> shape, by_u, by_v;
};

FaceShape face_shape(std::size_t nodes, Real u, Real v) {
  const Real t = 1 - u - v;
  if (nodes == 3) return {{t, u, v}, {-1, 1, 0}, {-1, 0, 1}};
  return {{t * (2 * t - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * t * u, 4 * u * v, 4 * v * t},
          {1 - 4 * t, 4 * u - 1, 0, 4 * (t - u), 4 * v, -4 * v},
          {1 - 4 * t, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (t - v)}};
}

/// Three points of Gauss's rule squared, collapsed onto the triangle: exact for degree 4.
template <class Visit>
void each_face_point(const Visit& visit) {
  const Real gauss[3] = {-std::sqrt(0.6L), 0, std::sqrt(0.6L)}, weights[3] = {5.0L / 18, 8.0L / 18, 5.0L / 18};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Real u = (1 + gauss[i]) / 2, v = (1 + gauss[j]) / 2 * (1 - u);
      visit(u, v, weights[i] * weights[j] * (1 - u));
    }
}

/// Adds a third of the integral of x . (dx/du x dx/dv) over a face, positions taken from an origin.
void add_face(const std::vector<std::size_t>& nodes, const std::vector<RealVec3>& at, Real far, Measure& measure) {
  each_face_point([&](Real u, Real v, Real weight) {
    const FaceShape f = face_shape(nodes.size(), u, v);
    RealVec3 x = RealVec3::Zero(), along = RealVec3::Zero(), across = RealVec3::Zero();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      x += f.shape[i] * at[i];
      along += f.by_u[i] * at[i];
      across += f.by_v[i] * at[i];
    }
    const Real third = weight / 3;
    measure.value += third * x.dot(along.cross(across));
    const Real edges = along.norm() + across.norm();
    measure.rounding += rounding_unit * third * (far + x.norm()) * edges * edges;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      measure.slopes[nodes[i]] +=
          third * (f.shape[i] * along.cross(across) + f.by_u[i] * across.cross(x) + f.by_v[i] * x.cross(along));
      measure.blurs[nodes[i]] += rounding_unit * 4 * third * (far + x.norm() + edges) * edges;
    }
  });
}

Measure volume_of(const ChamberDrive& chamber, const Points& positions) {
  Measure measure;
  std::vector<std::vector<std::size_t>> faces;
  if (!chamber.surface.empty()) {
    for (const EmbeddedPoint& point : chamber.points) (void)measure.add_node(point);
    for (const Triangle& t : chamber.surface)
      faces.push_back({static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
  } else {
    for (const CavityFace& face : chamber.cavity) {
      faces.emplace_back();
      for (const Index v : face.corners) faces.back().push_back(measure.add_node(vertex(v)));
      if (face.edges[0] >= 0)
        for (const Index v : face.edges) faces.back().push_back(measure.add_node(vertex(v)));
    }
  }
  const RealVec3 origin = place(measure.nodes.front(), positions);
  for (const auto& face : faces) {
    std::vector<RealVec3> at;
    for (const std::size_t node : face) at.push_back(place(measure.nodes[node], positions) - origin);
    add_face(face, at, origin.norm(), measure);
  }
  return measure;
}

Measure measure_of(const Actuator& actuator, const Points& positions) {
  if (const auto* cable = actuator.as<CableDrive>()) return length_of(*cable, positions);
  return volume_of(std::get<ChamberDrive>(actuator.drive), positions);
}

/// What a gauge pressure [kPa] leaves a chamber of what is sealed in it, by its law [mm^3]; not finite below a vacuum.
Real filled_volume(const Filling& filling, Real rest, Real command, Real kPa) {
  const Real atmosphere = 1e3L * filling.atmosphere_MPa, dead = filling.dead_mm3, syringe = filling.syringe_mm3;
  const Real amount = filling.pushed ? rest + dead + syringe : 1000 * command;
  const Real outside = filling.pushed ? dead + syringe - 1000 * command : dead;
  if (filling.liquid) return amount * std::exp(-filling.compressibility * kPa / 1000) - outside;
  const Real logarithm = std::log1p(kPa / atmosphere);  // p_abs V^n = p_atm N^n
  return amount * std::exp(-logarithm / filling.exponent) - outside;
}

void check_measure(const Actuator& actuator, const Measure& now, const Measure& rest, double command, double multiplier,
                   Confirmation& out) {
  const std::string name = "actuator '" + actuator.name + "'";
  if (actuator.control == Control::load) {
    if (!(std::abs(multiplier - command) <= 4 * rounding_unit * std::abs(command)))
      out.faults.push_back(name + ": load " + digits(multiplier) + " instead of " + digits(command));
    return;
  }
  const Filling* filling = filling_of(actuator);
  const Real requested = filling ? filled_volume(*filling, rest.value, command, multiplier) : command * rest.value;
  const Real allowed = met * std::abs(requested) + sums * (now.rounding + rest.rounding);
  const bool cable = actuator.is<CableDrive>();
  if (cable && multiplier < 0) out.faults.push_back(name + ": a tension of " + digits(multiplier) + " N");
  const bool slack = cable && multiplier == 0;
  const Real miss = slack ? std::max<Real>(0, now.value - requested) : std::abs(now.value - requested);
  if (!slack) out.constraint_error = std::max(out.constraint_error, static_cast<double>(miss / std::abs(requested)));
  if (!(miss <= allowed))
    out.faults.push_back(name + (slack ? ", slack," : "") + ": " + digits(static_cast<double>(now.value / rest.value)) +
                         " of its measure at rest instead of " + digits(command) + ", off by " +
                         digits(static_cast<double>(miss / std::abs(requested))));
}

/// Edges that the faces of a cavity do not pass once in each direction: 0 where it is a closed surface with one side.
int open_edges(const ChamberDrive& chamber) {
  std::map<std::pair<Index, Index>, int> passes;
  for (const CavityFace& face : chamber.cavity)
    for (int i = 0; i < 3; ++i) {
      const Index a = face.corners[i], b = face.corners[(i + 1) % 3];
      passes[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return static_cast<int>(
      std::count_if(passes.begin(), passes.end(), [](const auto& edge) { return edge.second != 0; }));
}

void add_actuators(const Model& model, const Equilibrium& found, Forces& forces, Confirmation& out) {
  const State& state = found.state;
  std::size_t memory = 0;  // index of the next eyelet with friction
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const Index index = a;
    const double multiplier = state.multipliers[index];
    if (actuator.is<DeaDrive>() || actuator.is<MagneticDrive>() || actuator.is<TurnCommand>() ||
        actuator.is<GrowthDrive>() || actuator.is<MomentCommand>() || actuator.is<PressureCommand>()) {
      const bool charged = actuator.is<DeaDrive>() && actuator.control == Control::load;
      const double expected = charged ? state.actuation[index] : 0;
      if (!(std::abs(multiplier - expected) <= 4 * rounding_unit * std::abs(expected)))
        out.faults.push_back("'" + actuator.name + "' has the multiplier " + digits(multiplier) + " instead of " +
                             digits(expected));
      continue;
    }
    const auto* chamber = actuator.as<ChamberDrive>();
    if (const int open = chamber ? open_edges(*chamber) : 0; open > 0)
      out.faults.push_back(
          "actuator '" + actuator.name + "': " + std::to_string(open) +
          " edges of its chamber's boundary are open or turned over: its volume depends on the origin");
    Measure now = measure_of(actuator, state.positions);
    const Measure rest = measure_of(actuator, model.rest);
    check_measure(actuator, now, rest, state.actuation[index], multiplier, out);
    if (has_friction(actuator)) {
      const auto& cable = *actuator.as<CableDrive>();
      rub(cable, state.positions, state.eyelets, memory, static_cast<double>(rest.value), now);
      memory += cable.points.size() - 1;
    }
    // kPa: 1e-3 N/mm^2, outwards
    const Real load = actuator.is<CableDrive>() ? static_cast<Real>(multiplier) : -1e-3L * multiplier;
    for (std::size_t i = 0; i < now.nodes.size(); ++i)
      for (std::size_t k = 0; k < now.nodes[i].vertices.size(); ++k) {
        const Real weight = now.nodes[i].weights[k];
        forces.add(now.nodes[i].vertices[k], load * weight * now.slopes[i], std::abs(load * weight) * now.blurs[i]);
      }
  }
}

void add_magnets(const Model& model, const Equilibrium& found, Forces& forces) {
  if (!model.magnetism) return;
  const CommandedFields fields(model, found.state);
  const auto flux = [&](const RealVec3& place) { return fields.at(place); };
  const auto add = [&](std::size_t element, const Index* nodes, int count) {
    const Vec3& remanence = model.magnetism->remanence[element];
    if (remanence.isZero(0)) return;
    const bool turns = model.magnetism->magnetisation[element] == Magnetisation::turns;
    const ElementPulls pulls =
        magnetic_pulls_of(nodes_at(model.rest, nodes, count), nodes_at(found.state.positions, nodes, count),
                          remanence.cast<Real>(), turns, flux);
    for (int i = 0; i < count; ++i) {
      forces.add(nodes[i], pulls.force[i], pulls.rounding[i]);
      forces.stiffness[nodes[i]] += pulls.stiffness[i];
    }
  };
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    std::array<Index, 10> nodes;
    std::copy(model.elements.tetrahedra[e].begin(), model.elements.tetrahedra[e].end(), nodes.begin());
    if (!model.elements.edge_nodes.empty())
      std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
    add(e, nodes.data(), model.elements.edge_nodes.empty() ? 4 : 10);
  }
  for (std::size_t e = 0; e < model.elements.prisms.size(); ++e)
    add(model.elements.tetrahedra.size() + e, model.elements.prisms[e].data(), 6);
}

void add_families(const Model& model, const Equilibrium& found, Forces& forces) {
  for (const Material& material : model.elements.materials) {
    if (!material.families) continue;
    const Families& all = *material.families;
    const auto add = [&](std::size_t place, const Index* nodes, int count) {
      std::vector<FibreDrive> fibres;
      for (const Families::Family& family : all.families)
        fibres.push_back({family.k1_MPa, family.k2, family.dispersion, family.directions[place].cast<Real>()});
      const ElementPulls pulls =
          family_pulls_of(nodes_at(model.rest, nodes, count), nodes_at(found.state.positions, nodes, count), fibres);
      for (int i = 0; i < count; ++i) {
        forces.add(nodes[i], pulls.force[i], pulls.rounding[i]);
        forces.stiffness[nodes[i]] += pulls.stiffness[i];
      }
    };
    for (std::size_t i = 0; i < all.tetrahedra.size(); ++i) {
      const std::size_t e = all.tetrahedra[i];
      std::array<Index, 10> nodes;
      std::copy(model.elements.tetrahedra[e].begin(), model.elements.tetrahedra[e].end(), nodes.begin());
      if (!model.elements.edge_nodes.empty())
        std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
      add(i, nodes.data(), model.elements.edge_nodes.empty() ? 4 : 10);
    }
    for (std::size_t i = 0; i < all.prisms.size(); ++i)
      add(all.tetrahedra.size() + i, model.elements.prisms[all.prisms[i]].data(), 6);
  }
}

void check_places(const Model& model, const State& state, Confirmation& out) {
  const double far = std::max(model.rest.cwiseAbs().maxCoeff(), state.positions.cwiseAbs().maxCoeff());
  std::vector<bool> of_rigid(model.elements.used.size());
  for (const RigidRegion& region : model.rigid)
    for (const Index v : region.vertices) of_rigid[v] = true;
  double worst = 0;
  const Points places = held_places(model, state);
  const bool turned = !model.held.turns.empty();  // sines of its own
  for (Index v = 0; v < model.rest.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      if (!model.held.fixed[v][axis]) continue;
      const double place = places(v, axis);
      const double allowed =
          of_rigid[v] || turned ? 1e-9 * model.diagonal_mm + 64 * rounding_unit * far : 4 * rounding_unit * far;
      worst = std::max(worst, std::abs(state.positions(v, axis) - place) / allowed);
    }
  if (!(worst <= 1))
    out.faults.push_back("a held vertex is " + digits(worst) + " times as far from its place as rounding");
}

void check_shape(const Model& model, const RigidRegion& region, const Points& positions, Confirmation& out) {
  const double far = std::max(model.rest.cwiseAbs().maxCoeff(), positions.cwiseAbs().maxCoeff());
  double worst = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(4, region.vertices.size()); ++i)
    for (const Index v : region.vertices) {
      const Index u = region.vertices[i];
      const double before = (model.rest.row(v) - model.rest.row(u)).norm();
      worst = std::max(worst, std::abs((positions.row(v) - positions.row(u)).norm() - before));
    }
  if (!(worst <= 1e-9 * model.diagonal_mm + 64 * rounding_unit * far))
    out.faults.push_back("a rigid region has changed its shape by " + digits(worst) + " mm");
}

/// Residuals of what may move, each with what it is allowed.
struct Balance {
  Real largest = 0;  // force at a vertex [N]
  Real tolerance_mm = 0;
  Real worst_over = 0, worst_ratio = 0;
  bool blurred = false;
  std::string where;

  void enter(Real residual, Real own_size, Real stiffness, Real rounding, const std::string& what) {
    const Real blur = sums * rounding;
    const Real of_tolerance = tolerance_mm * stiffness;
    const Real by_step = balanced * own_size + 2 * of_tolerance + blur;
    const Real of_all = balanced * largest + fraction_of_tolerance * of_tolerance + blur;
    const Real over = residual / std::max<Real>(std::min(by_step, of_all), 1e-300L);
    if (blur < 1e-6L * largest && of_tolerance < largest) worst_ratio = std::max(worst_ratio, residual / largest);
    blurred = blurred || blur > 1e-3L * (largest + of_tolerance);
    if (!(over <= worst_over)) {
      worst_over = over;
      where = what + ": " + digits(static_cast<double>(residual)) + " N, of " + digits(static_cast<double>(own_size)) +
              " N there, " + digits(static_cast<double>(largest)) + " N at most, " +
              digits(static_cast<double>(stiffness * tolerance_mm)) + " N by the tolerance, " +
              digits(static_cast<double>(blur)) + " N by rounding";
    }
  }
};

/// Returns the sum of the moments on a rigid region.
RealVec3 moment_on(const Model& model, const RigidRegion& region, const State& state) {
  RealVec3 sum = RealVec3::Zero();
  for (std::size_t m = 0; m < model.loads.moments.size(); ++m) {
    if (!std::binary_search(region.vertices.begin(), region.vertices.end(), model.loads.moments[m].vertices[0]))
      continue;
    sum += static_cast<Real>(state.load_factor) * model.loads.moments[m].moment_Nmm.cast<Real>();
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      if (const auto* command = model.actuators[a].as<MomentCommand>();
          command && command->moment == static_cast<Index>(m))
        sum[command->axis] += static_cast<Real>(state.actuation[a]);
  }
  return sum;
}

// Forces and moments along z and about x and y are left out near the floor, whose contact force is not known.
void enter_rigid(const Model& model, const RigidRegion& region, const State& state, const Forces& forces,
                 const ConfirmedFloor* floor, Balance& balance) {
  const Points& positions = state.positions;
  RigidMoves moves = moves_of(model, region);
  const auto near = [&](Index v) { return floor && floor->near(v); };
  if (std::any_of(region.vertices.begin(), region.vertices.end(), near))
    moves.slides[2] = moves.turns[0] = moves.turns[1] = false;
  RealVec3 middle = RealVec3::Zero(), force = RealVec3::Zero(), moment = RealVec3::Zero();
  for (const Index v : region.vertices) middle += positions.row(v).transpose().cast<Real>();
  middle /= static_cast<Real>(region.vertices.size());
  Real reach = 0, size = 0, stiffness = 0, rounding = 0;
  for (const Index v : region.vertices) {
    const RealVec3 arm = positions.row(v).transpose().cast<Real>() - middle, pull = forces.sum.row(v).transpose();
    force += pull;
    moment += arm.cross(pull);
    reach = std::max(reach, arm.norm());
    size += forces.size[v];
    stiffness += forces.stiffness[v];
    rounding += forces.rounding[v];
  }
  moment -= moment_on(model, region, state);
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = "rigid region '" + region.name + "'";
    if (moves.slides[axis]) balance.enter(std::abs(force[axis]), size, stiffness, rounding, name + " pulled");
    if (moves.turns[axis] && reach > 0)
      balance.enter(std::abs(moment[axis]) / reach, size, stiffness, rounding, name + " turned");
  }
}

}  // namespace

void confirm_physical(const Model& model, const Equilibrium& found, const State& begun, Confirmation& out) {
  const State& state = found.state;
  check_places(model, state, out);
  Forces forces(model.rest.rows());
  add_elements(model, found, begun, forces);
  add_pressures(model, found, forces, out);
  add_actuators(model, found, forces, out);
  add_magnets(model, found, forces);
  add_tractions(model, state, forces);
  add_liquid(model, state, forces);
  add_families(model, found, forces);
  add_fibres(model, state, forces);
  add_layers(model, state, forces);
  for (Index v = 0; v < model.loads.dead.rows(); ++v)
    forces.add(v, -static_cast<Real>(state.load_factor) * model.loads.dead.row(v).transpose().cast<Real>(), 0);
  if (!forces.sum.allFinite()) {
    out.faults.emplace_back("the law has no energy for this shape");
    return;
  }
  Balance balance;
  balance.tolerance_mm = found.report.tolerance_mm;
  balance.largest = *std::max_element(forces.size.begin(), forces.size.end());
  std::vector<bool> of_rigid(model.elements.used.size());
  for (const RigidRegion& region : model.rigid)
    for (const Index v : region.vertices) of_rigid[v] = true;
  std::optional<ConfirmedFloor> floor;
  if (model.contact.any()) {
    floor.emplace(model, state.positions);
    if (floor->depth() > 0) out.faults.push_back("a point is " + digits(floor->depth()) + " mm below the floor");
    floor->push(of_rigid, forces.sum);
  }
  for (const RigidRegion& region : model.rigid) {
    check_shape(model, region, state.positions, out);
    enter_rigid(model, region, state, forces, floor ? &*floor : nullptr, balance);
  }
  for (Index v = 0; v < model.rest.rows(); ++v) {
    Real square = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (!model.held.fixed[v][axis] && !of_rigid[v]) square += forces.sum(v, axis) * forces.sum(v, axis);
    if (square > 0)
      balance.enter(std::sqrt(square), forces.size[v], forces.stiffness[v], forces.rounding[v],
                    "vertex " + std::to_string(v));
  }
  out.residual_ratio = static_cast<double>(balance.worst_ratio);
  out.blurred = balance.blurred;
  if (!(balance.worst_over <= 1)) out.faults.push_back("not in balance: " + balance.where);
}

}  // namespace softkin::random_robots
