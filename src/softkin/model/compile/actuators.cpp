#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

void check_field(const ActuatorSpec& spec, const FieldSpec& field, Formulation formulation) {
  if (formulation != Formulation::physical) refuse(spec, "is a magnetic field: that needs the physical formulation");
  if (!field.source || spec.control != Control::load)
    refuse(spec, "is a magnetic field: it needs a source and is controlled by its load");
  if (!(std::isfinite(spec.low) && spec.low <= spec.high && std::isfinite(spec.high)))
    refuse(spec, "needs a range with low <= high, not " + interval_text(spec.low, spec.high));
  if (!places_dipole(field.command) && spec.rest != 0)
    refuse(spec, "cannot have a field at rest other than 0, not " + number(spec.rest));
  if (!(std::isfinite(spec.rest))) refuse(spec, "needs a place at rest that is finite");
}

/// any_sign: may it be below 0.
void check_load(const ActuatorSpec& spec, const char* load, bool any_sign, Formulation formulation) {
  if (formulation != Formulation::physical)
    refuse(spec, "is controlled by its load: that needs the physical formulation");
  if (!(std::isfinite(spec.low) && spec.low <= spec.high && std::isfinite(spec.high)) || (!any_sign && spec.low < 0))
    refuse(spec, std::string("needs a range of its ") + load + " with " + (any_sign ? "" : "0 <= ") +
                     "low <= high, not " + interval_text(spec.low, spec.high));
  if (spec.rest != 0) refuse(spec, "cannot have a load at rest other than 0, not " + number(spec.rest));
}

/// prestretched: may its ratio at rest be another than 1.
void check_ratio(const ActuatorSpec& spec, bool prestretched = false) {
  if (!(spec.low > 0 && spec.low <= spec.high && std::isfinite(spec.high)))
    refuse(spec, "needs a range with 0 < low <= high, not " + interval_text(spec.low, spec.high));
  if (!prestretched && spec.rest != 1)
    refuse(spec, "cannot have a rest ratio other than 1: only a dea has a prestretch");
  if (prestretched && !(spec.rest >= spec.low && spec.rest <= spec.high))
    refuse(spec, "has its rest ratio (prestretch) " + number(spec.rest) + " outside its range " +
                     interval_text(spec.low, spec.high));
}

/// Checks the curve of a ratio by pressures or voltages. others: the name of inputs that do not fit, for messages.
void check_curve(const ActuatorSpec& spec, CurveInput input, const char* load, const char* ratio, const char* others) {
  if (!spec.curve) return;
  if (spec.control == Control::load)
    refuse(spec, std::string("is controlled by its ") + load + ", which needs no curve: control its " + ratio +
                     ", or leave the curve out");
  if (spec.control == Control::filling)
    refuse(spec, "is controlled by what fills it, and takes no curve: control its volume, or leave the curve out");
  if (spec.curve->input != input)
    refuse(spec, std::string("needs a curve of ") + load + "s, but " + spec.curve->file + " is one of " + others);
  if (spec.branch == Branch::unloading && !spec.curve->unloading)
    refuse(spec, "takes the unloading branch of its curve, but " + spec.curve->file + " has none");
}

/// Refuses settings that do not fit the kind of an actuator.
struct CheckedDrive {
  const ActuatorSpec& spec;
  Formulation formulation;

  void operator()(const CableSpec& cable) const {
    refuse_filling();
    if (spec.control == Control::load)
      check_load(spec, "tension", false, formulation);
    else
      check_ratio(spec);
    if (spec.curve) refuse(spec, "is a cable: it takes no curve");
    if (!(cable.spacing >= 0 && std::isfinite(cable.spacing)))
      refuse(spec, "needs a spacing of 0 or more, not " + number(cable.spacing));
    const std::array<double, 3> coefficients{cable.friction, cable.sheath_friction, cable.sheath_turns_degrees};
    if (coefficients != std::array<double, 3>{} && formulation != Formulation::physical)
      refuse(spec, "takes no friction and no sheath: they belong to the physical formulation, which knows tensions");
    for (const double value : coefficients)
      if (!(value >= 0 && std::isfinite(value)))
        refuse(spec, "needs a friction and a sheath of 0 or more, not " + number(value));
  }

  void operator()(const PneumaticSpec& chamber) const {
    if (spec.control == Control::filling)
      check_filling(spec, chamber.filling, formulation);
    else if (chamber.filling)
      refuse(spec, "takes nothing that fills it: only a chamber that is controlled by that does");
    if (spec.control == Control::load) check_load(spec, "pressure", true, formulation);
    if (spec.control == Control::ratio) check_ratio(spec);
    check_curve(spec, CurveInput::pressure, "pressure", "volume", "voltages");
    check_connected(spec, chamber.connected, formulation);
    const int given = chamber.region.has_value() + chamber.surface.has_value() + chamber.wall.has_value() +
                      chamber.void_at.has_value() + !chamber.connected.empty();
    if (given > 1)
      refuse(spec, chamber.connected.empty() && !chamber.void_at
                       ? "needs a region or a surface, one of the two"
                       : "needs a region, a surface, a point of an empty space or connected chambers, one of them");
    if (chamber.void_at && formulation != Formulation::physical)
      refuse(spec, "names an empty space: the target-shape formulation needs the chamber meshed and named as `region`");
    if (chamber.void_at && !chamber.void_at->allFinite()) refuse(spec, "has a point `void_at` that is not finite");
    if (given == 0 && formulation != Formulation::physical)
      refuse(spec, "needs a region or a surface: the target-shape formulation needs the chamber meshed");
  }

  void operator()(const DeaSpec& dea) const {
    refuse_filling();
    const bool charged = spec.control == Control::load;
    if (charged)
      check_load(spec, "voltage", false, formulation);
    else
      check_ratio(spec, true);
    check_curve(spec, CurveInput::voltage, "voltage", "area", "pressures");
    if (dea.region.empty()) refuse(spec, "needs a region of prisms");
    if (dea.fractions && !charged)
      refuse(spec, "takes no fractions of a voltage: only a dea that is controlled by its voltage does");
    if (dea.prestretch != 1 && !charged)
      refuse(spec, "takes no prestretch beside its ratio at rest: only a dea that is controlled by its voltage does");
    if (!(dea.prestretch > 0 && std::isfinite(dea.prestretch)))
      refuse(spec, "needs a prestretch above 0, not " + number(dea.prestretch));
  }

  void operator()(const FieldSpec& field) const {
    check_field(spec, field, formulation);
    if (spec.curve) refuse(spec, "is a magnetic field: it takes no curve");
  }

  void operator()(const GrowthSpec& growth) const {
    check_growth(spec, growth, formulation);
    if (spec.curve) refuse(spec, "is a growth: it takes no curve");
  }

 private:
  void refuse_filling() const {
    if (spec.control == Control::filling)
      refuse(spec, "is controlled by what fills it: it needs to be a chamber with a filling");
  }
};

void check(const ActuatorSpec& spec, Formulation formulation) {
  if (!(spec.weight > 0 && std::isfinite(spec.weight)))
    refuse(spec, "needs a weight above 0, not " + number(spec.weight));
  std::visit(CheckedDrive{spec, formulation}, spec.drive);
  const bool acts = spec.control == Control::load && (spec.is<CableSpec>() || spec.is<PneumaticSpec>());
  if (!acts && (spec.factor != 1 || spec.offset != 0))
    refuse(spec, "takes no factor and no offset: only a cable by tension and a chamber by pressure do");
  if (!acts && spec.backlash != 0)
    refuse(spec, "takes no backlash: only a cable by tension and a chamber by pressure do");
  if (!(spec.backlash >= 0 && std::isfinite(spec.backlash)))
    refuse(spec, "needs a backlash of 0 or more, not " + number(spec.backlash));
  if (!(spec.factor > 0 && std::isfinite(spec.factor) && std::isfinite(spec.offset)))
    refuse(spec,
           "needs a factor above 0 and a finite offset, not " + number(spec.factor) + " and " + number(spec.offset));
}

// The model's elements among a region's; role says whose they are.
void take(Compilation& c, const ActuatorSpec& spec, const std::vector<Index>& found, std::vector<ElementRole>& roles,
          const std::vector<Index>& mesh_index, const char* kind, std::vector<Index>& elements) {
  const Index actuator = c.model.actuators.size();
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
  for (std::size_t i = 0; i < model.elements.tetrahedra.size(); ++i) {
    Vec3 centroid = Vec3::Zero();
    for (const Index v : model.elements.tetrahedra[i]) centroid += 0.25 * vertex_at(model.rest, v);
    if (tree.contains(centroid)) inside.push_back(i);
  }
  return inside;
}

const std::vector<Index>& chamber_region(const Compilation& c, const ActuatorSpec& spec, const std::string& name) {
  const Region& region = c.regions.find(name, spec.origin);
  if (!region.prisms.empty())
    refuse(spec, "is pneumatic and needs tetrahedra, but region '" + name + "' has " +
                     counted(region.prisms.size(), "prism"));
  if (region.tetrahedra.empty())
    refuse(spec, "has no element: region '" + name + "' holds no tetrahedron" +
                     (region.dimension == 2 ? "; the wall of a cavity is `surface: {region: " + name + "}`" : ""));
  return region.tetrahedra;
}

/// The elements of Eq. (8).
void fill_chamber(Compilation& c, const ActuatorSpec& spec, const PneumaticSpec& given, Actuator& actuator) {
  Model& model = c.model;
  auto& chamber = std::get<ChamberDrive>(actuator.drive);
  std::vector<Index> found;
  if (given.region) {
    found = in_model(spec, chamber_region(c, spec, *given.region), c.tetrahedron_at, "tetrahedron");
  } else {
    TriangleSurface surface =
        given.surface ? checked_surface(spec, *given.surface) : checked_wall(c, spec, *given.wall).closed;
    found = tetrahedra_inside(model, surface);
    if (found.empty())
      refuse(spec,
             "has no element: the target-shape formulation needs the chamber meshed, and no element lies inside "
             "the surface");
    if (given.surface) chamber.surface = std::move(surface.triangles);
  }
  take(c, spec, found, model.elements.tetrahedron_roles, c.tetrahedron_of, "tetrahedron", chamber.tetrahedra);
  for (const Index i : chamber.tetrahedra) actuator.rest_measure += model.elements.tetrahedron_volumes[i];
}

/// Physical: the chamber of a region's elements.
std::vector<Index> take_region(Compilation& c, const ActuatorSpec& spec, const std::string& name) {
  std::vector<Index> elements;
  take(c, spec, in_model(spec, chamber_region(c, spec, name), c.chamber_at, "tetrahedron"), c.chamber_roles,
       c.chamber_of, "tetrahedron", elements);
  return elements;
}

/// Each as a chamber of its own would be; one cavity of all.
void fill_connected(Compilation& c, const ActuatorSpec& spec, const std::vector<std::string>& regions,
                    Actuator& actuator) {
  auto& all = std::get<ChamberDrive>(actuator.drive);
  double volume = 0;
  for (const std::string& name : regions) {
    const bool faces = c.regions.find(name, spec.origin).dimension == 2;
    PneumaticSpec one;
    (faces ? one.wall : one.region) = name;
    Actuator single;
    single.drive = ChamberDrive{};
    compile_cavity(c, spec, one, faces ? std::vector<Index>() : take_region(c, spec, name), single);
    const std::vector<CavityFace>& cavity = single.as<ChamberDrive>()->cavity;
    all.cavity.insert(all.cavity.end(), cavity.begin(), cavity.end());
    all.connected.push_back({name, static_cast<Index>(all.cavity.size())});
    volume += single.rest_measure;
  }
  actuator.rest_measure = volume;
}

void fill_pneumatic(Compilation& c, const ActuatorSpec& spec, const PneumaticSpec& given, Actuator& actuator) {
  if (c.spec.formulation != Formulation::physical) return fill_chamber(c, spec, given, actuator);
  if (!given.connected.empty()) return fill_connected(c, spec, given.connected, actuator);
  compile_cavity(c, spec, given, given.region ? take_region(c, spec, *given.region) : std::vector<Index>(), actuator);
}

double area(const Points& vertices, Index i, Index j, Index k) {
  const Vec3 a = vertex_at(vertices, i);
  return 0.5 * (vertex_at(vertices, j) - a).cross(vertex_at(vertices, k) - a).norm();
}

/// The elements of Eq. (7), and their areas at rest.
void fill_membrane(Compilation& c, const ActuatorSpec& spec, const DeaSpec& given, Actuator& actuator) {
  Model& model = c.model;
  std::vector<Index>& prisms = std::get<DeaDrive>(actuator.drive).prisms;
  const Region& region = c.regions.find(given.region, spec.origin);
  if (!region.tetrahedra.empty())
    refuse(spec, "is a dea and needs prisms, but region '" + given.region + "' has " +
                     counted(region.tetrahedra.size(), "tetrahedron", "tetrahedra"));
  if (region.prisms.empty()) refuse(spec, "is a dea and needs prisms, but region '" + given.region + "' has none");
  take(c, spec, in_model(spec, region.prisms, c.prism_at, "prism"), model.elements.prism_roles, c.prism_of, "prism",
       prisms);
  for (const Index i : prisms) {
    const Prism& p = model.elements.prisms[i];
    actuator.rest_measure += 0.5 * (area(model.rest, p[0], p[1], p[2]) + area(model.rest, p[3], p[4], p[5]));
  }
}

/// Shares of the voltage, by the place of each prism among the actuator's.
void fill_fractions(const Compilation& c, const ActuatorSpec& spec, const std::optional<PrismValues>& given,
                    DeaDrive& dea) {
  if (!given) {
    dea.fractions.assign(dea.prisms.size(), 1);
    return;
  }
  constexpr double none = -1;
  std::vector<double> fractions(c.prism_at.size(), none);
  for (std::size_t i = 0; i < given->prisms.size(); ++i) {
    const Index prism = given->prisms[i];
    const double fraction = given->values[i];
    const auto fail = [&](const std::string& what) {
      throw InvalidInput(given->origins[i], "prism " + std::to_string(prism) + " (from 0) " + what);
    };
    if (prism < 0 || prism >= std::ssize(fractions)) fail("is none of the mesh's");
    if (!(fraction >= 0 && std::isfinite(fraction)))
      fail("has a fraction of the voltage of " + number(fraction) + ": 0 or more");
    if (fractions[prism] != none) fail("is there twice");
    const Index at = c.prism_at[prism];
    if (at < 0 || c.model.elements.prism_roles[at].actuator != std::ssize(c.model.actuators))
      fail("does not belong to actuator '" + spec.name + "'");
    fractions[prism] = fraction;
  }
  for (const Index e : dea.prisms) {
    const Index prism = c.prism_of[e];
    if (fractions[prism] == none)
      refuse(spec, "has no fraction of the voltage for prism " + std::to_string(prism) + " (from 0)");
    dea.fractions.push_back(fractions[prism]);
  }
}

/// Compiles the kinds with elements; a cable, a field and a growth are compiled later.
struct FilledDrive {
  Compilation& c;
  const ActuatorSpec& spec;
  Actuator& actuator;

  void operator()(const CableSpec& cable) const {
    actuator.drive = CableDrive{.friction = cable.friction,
                                .sheath = cable.sheath_friction * cable.sheath_turns_degrees * std::numbers::pi / 180};
  }
  void operator()(const PneumaticSpec& chamber) const {
    actuator.drive = ChamberDrive{};
    fill_pneumatic(c, spec, chamber, actuator);
  }
  void operator()(const DeaSpec& dea) const {
    actuator.drive = DeaDrive{.prestretch = dea.prestretch};
    fill_membrane(c, spec, dea, actuator);
    if (under_voltage(actuator)) fill_fractions(c, spec, dea.fractions, std::get<DeaDrive>(actuator.drive));
  }
  void operator()(const FieldSpec&) const { actuator.drive = MagneticDrive{}; }
  void operator()(const GrowthSpec&) const { actuator.drive = GrowthDrive{}; }
};

}  // namespace

const FillingSpec* filling_of(const ActuatorSpec& spec) {
  const auto* chamber = spec.as<PneumaticSpec>();
  return chamber != nullptr && chamber->filling ? &*chamber->filling : nullptr;
}

void compile_actuator_elements(Compilation& c) {
  check_atmospheres(c.spec);
  std::set<std::string> names;
  for (const ActuatorSpec& spec : c.spec.actuators) {
    if (spec.name.empty()) throw InvalidInput(spec.origin, "an actuator needs a name");
    if (!names.insert(spec.name).second) throw InvalidInput(spec.origin, "there are two actuators '" + spec.name + "'");
    check(spec, c.spec.formulation);
    Actuator actuator;
    actuator.name = spec.name;
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
    std::visit(FilledDrive{c, spec, actuator}, spec.drive);
    if (!filling_of(spec)) note_rest(c, actuator);
    c.model.actuators.push_back(std::move(actuator));
  }
}

void compile_actuator_points(Compilation& c) {
  for (std::size_t i = 0; i < c.spec.actuators.size(); ++i) {
    const ActuatorSpec& spec = c.spec.actuators[i];
    Actuator& actuator = c.model.actuators[i];
    if (const auto* cable = spec.as<CableSpec>()) compile_cable(c, spec, *cable, actuator);
    const auto* chamber = spec.as<PneumaticSpec>();
    if (chamber && chamber->surface && actuator.as<ChamberDrive>()->cavity.empty()) {
      if (body_of(c, spec.robot).embedder.empty())
        refuse(spec, "has a surface but the robot has no body that could hold it");
      embed_surface(c, spec, *chamber->surface, actuator);
    }
    if (const FillingSpec* filling = filling_of(spec)) compile_filling(c, *filling, actuator);
  }
}

}  // namespace softkin
