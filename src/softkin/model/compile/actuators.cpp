#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

void check_field(const ActuatorSpec& spec, Formulation formulation) {
  if (formulation != Formulation::physical) refuse(spec, "is a magnetic field: that needs the physical formulation");
  if (!spec.field || !spec.field->source || spec.control != Control::load)
    refuse(spec, "is a magnetic field: it needs a source and is controlled by its load");
  if (!(std::isfinite(spec.low) && spec.low <= spec.high && std::isfinite(spec.high)))
    refuse(spec, "needs a range with low <= high, not " + interval_text(spec.low, spec.high));
  if (!places_dipole(spec.field->command) && spec.rest != 0)
    refuse(spec, "cannot have a field at rest other than 0, not " + number(spec.rest));
  if (!(std::isfinite(spec.rest))) refuse(spec, "needs a place at rest that is finite");
}

void check_load(const ActuatorSpec& spec, Formulation formulation) {
  if (formulation != Formulation::physical)
    refuse(spec, "is controlled by its load: that needs the physical formulation");
  const bool any_sign = spec.kind == ActuatorKind::pneumatic;
  const char* load = any_sign ? "pressure" : spec.kind == ActuatorKind::cable ? "tension" : "voltage";
  if (!(std::isfinite(spec.low) && spec.low <= spec.high && std::isfinite(spec.high)) || (!any_sign && spec.low < 0))
    refuse(spec, std::string("needs a range of its ") + load + " with " + (any_sign ? "" : "0 <= ") +
                     "low <= high, not " + interval_text(spec.low, spec.high));
  if (spec.rest != 0) refuse(spec, "cannot have a load at rest other than 0, not " + number(spec.rest));
}

void check_ratio(const ActuatorSpec& spec) {
  if (!(spec.low > 0 && spec.low <= spec.high && std::isfinite(spec.high)))
    refuse(spec, "needs a range with 0 < low <= high, not " + interval_text(spec.low, spec.high));
  if (spec.kind == ActuatorKind::dea) {
    if (!(spec.rest >= spec.low && spec.rest <= spec.high))
      refuse(spec, "has its rest ratio (prestretch) " + number(spec.rest) + " outside its range " +
                       interval_text(spec.low, spec.high));
  } else if (spec.rest != 1) {
    refuse(spec, "cannot have a rest ratio other than 1: only a dea has a prestretch");
  }
}

void check_curve(const ActuatorSpec& spec) {
  if (spec.kind == ActuatorKind::cable) refuse(spec, "is a cable: it takes no curve");
  if (spec.kind == ActuatorKind::magnetic) refuse(spec, "is a magnetic field: it takes no curve");
  if (spec.control == Control::filling)
    refuse(spec, "is controlled by what fills it, and takes no curve: control its volume, or leave the curve out");
  if (spec.control == Control::load)
    refuse(spec,
           spec.kind == ActuatorKind::dea
               ? "is controlled by its voltage, which needs no curve: control its area, or leave the curve out"
               : "is controlled by its pressure, which needs no curve: control its volume, or leave the curve out");
  const bool pressure = spec.curve->input == CurveInput::pressure;
  if (pressure != (spec.kind == ActuatorKind::pneumatic))
    refuse(spec, std::string("needs a curve of ") + (pressure ? "voltages" : "pressures") + ", but " +
                     spec.curve->file + " is one of " + (pressure ? "pressures" : "voltages"));
  if (spec.branch == Branch::unloading && !spec.curve->unloading)
    refuse(spec, "takes the unloading branch of its curve, but " + spec.curve->file + " has none");
}

void check_numbers(const ActuatorSpec& spec, Formulation formulation) {
  if (!(spec.weight > 0 && std::isfinite(spec.weight)))
    refuse(spec, "needs a weight above 0, not " + number(spec.weight));
  check_growth(spec, formulation);
  if (spec.kind == ActuatorKind::growth) {
    if (spec.filling || spec.curve || spec.shares || spec.prestretch != 1)
      refuse(spec, "is a growth: it takes no filling, no curve, no shares and no prestretch");
    return;
  }
  if (spec.kind == ActuatorKind::magnetic)
    check_field(spec, formulation);
  else if (spec.control == Control::load)
    check_load(spec, formulation);
  else if (spec.control == Control::filling)
    check_filling(spec, formulation);
  else
    check_ratio(spec);
  if (spec.control != Control::filling && spec.filling)
    refuse(spec, "takes nothing that fills it: only a chamber that is controlled by that does");
  if (spec.curve) check_curve(spec);
  const bool charged = spec.kind == ActuatorKind::dea && spec.control == Control::load;
  if (spec.shares && !charged)
    refuse(spec, "takes no shares of a voltage: only a dea that is controlled by its voltage does");
  if (spec.prestretch != 1 && !charged)
    refuse(spec, "takes no prestretch beside its ratio at rest: only a dea that is controlled by its voltage does");
  if (!(spec.prestretch > 0 && std::isfinite(spec.prestretch)))
    refuse(spec, "needs a prestretch above 0, not " + number(spec.prestretch));
}

void check_friction(const ActuatorSpec& spec, Formulation formulation) {
  const bool any = spec.friction != 0 || spec.sheath_friction != 0 || spec.sheath_turns_degrees != 0;
  if (!any) return;
  if (spec.kind != ActuatorKind::cable) refuse(spec, "takes no friction and no sheath: only a cable does");
  if (formulation != Formulation::physical)
    refuse(spec, "takes no friction and no sheath: they belong to the physical formulation, which knows tensions");
  for (const double value : {spec.friction, spec.sheath_friction, spec.sheath_turns_degrees})
    if (!(value >= 0 && std::isfinite(value)))
      refuse(spec, "needs a friction and a sheath of 0 or more, not " + number(value));
}

void check_members(const ActuatorSpec& spec, Formulation formulation) {
  const bool acts =
      spec.control == Control::load && (spec.kind == ActuatorKind::cable || spec.kind == ActuatorKind::pneumatic);
  if (!acts && (spec.factor != 1 || spec.offset != 0))
    refuse(spec, "takes no factor and no offset: only a cable by tension and a chamber by pressure do");
  if (!acts && spec.backlash != 0)
    refuse(spec, "takes no backlash: only a cable by tension and a chamber by pressure do");
  if (!(spec.backlash >= 0 && std::isfinite(spec.backlash)))
    refuse(spec, "needs a backlash of 0 or more, not " + number(spec.backlash));
  if (!(spec.factor > 0 && std::isfinite(spec.factor) && std::isfinite(spec.offset)))
    refuse(spec,
           "needs a factor above 0 and a finite offset, not " + number(spec.factor) + " and " + number(spec.offset));
  const bool cable = spec.kind == ActuatorKind::cable;
  if (!cable && !(spec.points.empty() && spec.apexes.empty())) refuse(spec, "takes no points: only a cable does");
  if (!cable && spec.spacing != 0) refuse(spec, "takes no spacing: only a cable does");
  if (!(spec.spacing >= 0 && std::isfinite(spec.spacing)))
    refuse(spec, "needs a spacing of 0 or more, not " + number(spec.spacing));
  check_friction(spec, formulation);
  if (cable && (spec.region || spec.surface || spec.wall))
    refuse(spec, "is a cable: it takes points, no region and no surface");
  if (spec.kind == ActuatorKind::magnetic && (spec.region || spec.surface || spec.wall))
    refuse(spec, "is a magnetic field: it takes no region and no surface");
  if (spec.kind == ActuatorKind::dea && (!spec.region || spec.surface || spec.wall))
    refuse(spec, "needs a region of prisms");
  check_connected(spec, formulation);
  if (spec.kind != ActuatorKind::pneumatic) return;
  const int given =
      spec.region.has_value() + spec.surface.has_value() + spec.wall.has_value() + !spec.connected.empty();
  if (given > 1)
    refuse(spec, spec.connected.empty() ? "needs a region or a surface, one of the two"
                                        : "needs a region, a surface or connected chambers, one of them");
  if (given == 0 && formulation != Formulation::physical)
    refuse(spec, "needs a region or a surface: the target-shape formulation needs the chamber meshed");
}

// The model's elements among a region's; role says whose they are.
void take(Compilation& c, const ActuatorSpec& spec, const std::vector<Index>& found, std::vector<ElementRole>& roles,
          const std::vector<Index>& mesh_index, const char* kind, std::vector<Index>& elements) {
  const auto actuator = static_cast<Index>(c.model.actuators.size());
  for (const Index i : found) {
    if (roles[i].actuator >= 0)
      refuse(spec, std::string("and actuator '") + c.model.actuators[roles[i].actuator].name + "' both hold " + kind +
                       " " + std::to_string(mesh_index[i]) + " (from 0)");
    roles[i].actuator = actuator;
    elements.push_back(i);
  }
}

std::vector<Index> in_model(const ActuatorSpec& spec, const std::vector<Index>& elements, const std::vector<Index>& at,
                            const char* kind) {
  std::vector<Index> found;
  found.reserve(elements.size());
  for (const Index i : elements) {
    if (at[i] < 0)
      refuse(spec,
             "holds " + std::string(kind) + " " + std::to_string(i) + " (from 0), which is void: it cannot be both");
    found.push_back(at[i]);
  }
  return found;
}

std::vector<Index> tetrahedra_inside(const Model& model, const TriangleSurface& surface) {
  const SurfaceTree tree(surface.vertices, surface.triangles);
  std::vector<Index> inside;
  for (std::size_t i = 0; i < model.tetrahedra.size(); ++i) {
    Vec3 centroid = Vec3::Zero();
    for (const Index v : model.tetrahedra[i]) centroid += 0.25 * vertex_at(model.rest, v);
    if (tree.contains(centroid)) inside.push_back(static_cast<Index>(i));
  }
  return inside;
}

const std::vector<Index>& chamber_region(const Compilation& c, const ActuatorSpec& spec) {
  const Region& region = c.regions.find(*spec.region, spec.origin);
  if (!region.prisms.empty())
    refuse(spec, "is pneumatic and needs tetrahedra, but region '" + *spec.region + "' has " +
                     counted(region.prisms.size(), "prism"));
  if (region.tetrahedra.empty())
    refuse(spec,
           "has no element: region '" + *spec.region + "' holds no tetrahedron" +
               (region.dimension == 2 ? "; the wall of a cavity is `surface: {region: " + *spec.region + "}`" : ""));
  return region.tetrahedra;
}

/// The elements of Eq. (8).
void fill_chamber(Compilation& c, const ActuatorSpec& spec, Actuator& actuator) {
  Model& model = c.model;
  auto& chamber = std::get<ChamberDrive>(actuator.drive);
  std::vector<Index> found;
  if (spec.region) {
    found = in_model(spec, chamber_region(c, spec), c.tetrahedron_at, "tetrahedron");
  } else {
    TriangleSurface surface = spec.surface ? checked_surface(spec) : checked_wall(c, spec);
    found = tetrahedra_inside(model, surface);
    if (found.empty())
      refuse(spec,
             "has no element: the target-shape formulation needs the chamber meshed, and no element lies inside "
             "the surface");
    if (spec.surface) chamber.surface = std::move(surface.triangles);
  }
  take(c, spec, found, model.tetrahedron_roles, c.tetrahedron_of, "tetrahedron", chamber.tetrahedra);
  for (const Index i : chamber.tetrahedra) actuator.rest_measure += model.tetrahedron_volumes[i];
}

/// Each as a chamber of its own would be; one cavity of all.
void fill_connected(Compilation& c, const ActuatorSpec& spec, Actuator& actuator) {
  auto& all = std::get<ChamberDrive>(actuator.drive);
  double volume = 0;
  for (const std::string& name : spec.connected) {
    ActuatorSpec one = spec;
    one.connected.clear();
    std::vector<Index> elements;
    if (c.regions.find(name, spec.origin).dimension == 2) {
      one.wall = name;
    } else {
      one.region = name;
      take(c, one, in_model(one, chamber_region(c, one), c.chamber_at, "tetrahedron"), c.chamber_roles, c.chamber_of,
           "tetrahedron", elements);
    }
    Actuator single;
    single.drive = ChamberDrive{};
    compile_cavity(c, one, elements, single);
    const std::vector<CavityFace>& cavity = single.as<ChamberDrive>()->cavity;
    all.cavity.insert(all.cavity.end(), cavity.begin(), cavity.end());
    all.connected.push_back({name, static_cast<Index>(all.cavity.size())});
    volume += single.rest_measure;
  }
  actuator.rest_measure = volume;
}

void fill_pneumatic(Compilation& c, const ActuatorSpec& spec, Actuator& actuator) {
  if (c.spec.formulation != Formulation::physical) return fill_chamber(c, spec, actuator);
  if (!spec.connected.empty()) return fill_connected(c, spec, actuator);
  std::vector<Index> elements;
  if (spec.region)
    take(c, spec, in_model(spec, chamber_region(c, spec), c.chamber_at, "tetrahedron"), c.chamber_roles, c.chamber_of,
         "tetrahedron", elements);
  compile_cavity(c, spec, elements, actuator);
}

double area(const Points& vertices, Index i, Index j, Index k) {
  const Vec3 a = vertex_at(vertices, i);
  return 0.5 * (vertex_at(vertices, j) - a).cross(vertex_at(vertices, k) - a).norm();
}

/// The elements of Eq. (7), and their areas at rest.
void fill_membrane(Compilation& c, const ActuatorSpec& spec, Actuator& actuator) {
  Model& model = c.model;
  std::vector<Index>& prisms = std::get<DeaDrive>(actuator.drive).prisms;
  const Region& region = c.regions.find(*spec.region, spec.origin);
  if (!region.tetrahedra.empty())
    refuse(spec, "is a dea and needs prisms, but region '" + *spec.region + "' has " +
                     counted(region.tetrahedra.size(), "tetrahedron", "tetrahedra"));
  if (region.prisms.empty()) refuse(spec, "is a dea and needs prisms, but region '" + *spec.region + "' has none");
  take(c, spec, in_model(spec, region.prisms, c.prism_at, "prism"), model.prism_roles, c.prism_of, "prism", prisms);
  for (const Index i : prisms) {
    const Prism& p = model.prisms[i];
    actuator.rest_measure += 0.5 * (area(model.rest, p[0], p[1], p[2]) + area(model.rest, p[3], p[4], p[5]));
  }
}

/// Shares of the voltage, by the place of each prism among the actuator's.
void fill_shares(const Compilation& c, const ActuatorSpec& spec, DeaDrive& dea) {
  if (!spec.shares) {
    dea.shares.assign(dea.prisms.size(), 1);
    return;
  }
  constexpr double none = -1;
  std::vector<double> shares(c.prism_at.size(), none);
  for (std::size_t i = 0; i < spec.shares->prisms.size(); ++i) {
    const Index prism = spec.shares->prisms[i];
    const double share = spec.shares->values[i];
    const auto fail = [&](const std::string& what) {
      throw InvalidInput(spec.shares->origins[i], "prism " + std::to_string(prism) + " (from 0) " + what);
    };
    if (prism < 0 || prism >= static_cast<Index>(shares.size())) fail("is none of the mesh's");
    if (!(share >= 0 && std::isfinite(share))) fail("has a share of the voltage of " + number(share) + ": 0 or more");
    if (shares[prism] != none) fail("is there twice");
    const Index at = c.prism_at[prism];
    if (at < 0 || c.model.prism_roles[at].actuator != static_cast<Index>(c.model.actuators.size()))
      fail("does not belong to actuator '" + spec.name + "'");
    shares[prism] = share;
  }
  for (const Index e : dea.prisms) {
    const Index prism = c.prism_of[e];
    if (shares[prism] == none)
      refuse(spec, "has no share of the voltage for prism " + std::to_string(prism) + " (from 0)");
    dea.shares.push_back(shares[prism]);
  }
}

/// Of the spec's kind, without what is compiled.
Drive drive_of(const ActuatorSpec& spec) {
  switch (spec.kind) {
    case ActuatorKind::cable:
      return CableDrive{.friction = spec.friction,
                        .sheath = spec.sheath_friction * spec.sheath_turns_degrees * std::numbers::pi / 180};
    case ActuatorKind::dea:
      return DeaDrive{.prestretch = spec.prestretch};
    case ActuatorKind::pneumatic:
      return ChamberDrive{};
    case ActuatorKind::magnetic:
      return MagneticDrive{};
    case ActuatorKind::growth:
      return GrowthDrive{};
  }
  refuse(spec, "is of no kind");
}

}  // namespace

void compile_actuator_elements(Compilation& c) {
  check_atmospheres(c.spec);
  std::set<std::string> names;
  for (const ActuatorSpec& spec : c.spec.actuators) {
    if (spec.name.empty()) throw InvalidInput(spec.origin, "an actuator needs a name");
    if (!names.insert(spec.name).second) throw InvalidInput(spec.origin, "there are two actuators '" + spec.name + "'");
    check_numbers(spec, c.spec.formulation);
    check_members(spec, c.spec.formulation);
    Actuator actuator;
    actuator.name = spec.name;
    actuator.drive = drive_of(spec);
    actuator.control = spec.control;
    actuator.low = spec.low;
    actuator.high = spec.high;
    actuator.rest = spec.rest;
    actuator.weight = spec.weight;
    actuator.distribution = spec.distribution;
    actuator.factor = spec.factor;
    actuator.offset = spec.offset;
    actuator.backlash = spec.backlash;
    actuator.curve = spec.curve;
    actuator.branch = spec.branch;
    if (spec.kind == ActuatorKind::pneumatic) fill_pneumatic(c, spec, actuator);
    if (spec.kind == ActuatorKind::dea) fill_membrane(c, spec, actuator);
    if (under_voltage(actuator)) fill_shares(c, spec, std::get<DeaDrive>(actuator.drive));
    if (!spec.filling) note_rest(c, actuator);
    c.model.actuators.push_back(std::move(actuator));
  }
}

void compile_actuator_points(Compilation& c) {
  for (std::size_t i = 0; i < c.spec.actuators.size(); ++i) {
    const ActuatorSpec& spec = c.spec.actuators[i];
    Actuator& actuator = c.model.actuators[i];
    if (spec.kind == ActuatorKind::cable) compile_cable(c, spec, actuator);
    if (spec.surface && actuator.as<ChamberDrive>()->cavity.empty()) {
      if (body_of(c, spec.robot).embedder.empty())
        refuse(spec, "has a surface but the robot has no body that could hold it");
      embed_surface(c, spec, actuator);
    }
    if (spec.filling) compile_filling(c, *spec.filling, actuator);
  }
}

}  // namespace softkin
