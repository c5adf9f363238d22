#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/parts.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/model/drives.hpp>
#include <softkin/model/magnetic_field.hpp>

namespace softkin::scene {

namespace {

struct Kind {
  DriveSpec drive;  // as one begins
  const DriveTraits& traits;
  Keys controls;  // the ratio, then the load where there is one, then what fills it
  Keys keys;      // besides the common ones
};

const Keys common_keys{"name", "kind", "control", "range", "weight", "distribution"};
const Keys kind_keys{"region", "surface",  "connected",  "void_at",      "source",        "liquid", "points",
                     "apexes", "spacing",  "prestretch", "curve",        "voltage_share", "factor", "backlash",
                     "offset", "friction", "sheath",     "keeps_volume", "temperature",   "also"};

Keys all_kind_keys() {
  Keys all = kind_keys;
  all.insert(all.end(), field_keys().begin(), field_keys().end());
  return all;
}

template <class Compiled>
Kind kind(DriveSpec drive, Keys keys, const Keys& fillings = {}) {
  constexpr const DriveTraits& traits = traits_of<Compiled>;
  Keys controls{traits.measure, traits.load};
  controls.insert(controls.end(), fillings.begin(), fillings.end());
  return {std::move(drive), traits, std::move(controls), std::move(keys)};
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      kind<ChamberDrive>(
          PneumaticSpec{},
          {"region", "surface", "connected", "void_at", "source", "liquid", "curve", "factor", "offset", "backlash"},
          {"gas", "liquid"}),
      kind<CableDrive>(CableSpec{},
                       {"points", "apexes", "spacing", "factor", "offset", "backlash", "friction", "sheath"}),
      kind<DeaDrive>(DeaSpec{}, {"region", "prestretch", "curve", "voltage_share"}),
      kind<MagneticDrive>(FieldSpec{}, field_keys()), kind<GrowthDrive>(GrowthSpec{}, growth_keys())};
  return all;
}

const Kind& read_kind(const Map& map) {
  Keys names;
  for (const Kind& kind : kinds()) names.push_back(kind.traits.kind);
  const Kind& kind = kinds()[choice(map.at("kind"), names)];
  for (const std::string& key : all_kind_keys()) {
    const Node::Entry* entry = map.entry(key);
    if (entry && std::find(kind.keys.begin(), kind.keys.end(), key) == kind.keys.end())
      throw InvalidInput(entry->origin, "key '" + key + "' does not belong to kind '" + kind.traits.kind + "'");
  }
  return kind;
}

Control read_control(const Map& map, const Kind& kind, Formulation formulation) {
  const Node* node = map.find("control");
  if (!node) return Control::ratio;
  const std::string& control = text(*node);
  const auto found = std::find(kind.controls.begin(), kind.controls.end(), control);
  if (found == kind.controls.end())
    fail(*node, "control of kind '" + std::string(kind.traits.kind) + "' must be " +
                    (kind.controls.size() > 1 ? "one of " : "") + joined(kind.controls) + ", not " + excerpt(control));
  if (found == kind.controls.begin()) return Control::ratio;
  if (formulation != Formulation::physical)
    fail(*node, "control '" + control + "' belongs to the physical formulation, and this scene is of 'target-shape': " +
                    "give elastic constants and 'formulation: physical', or use '" + kind.controls[0] + "'");
  return found == kind.controls.begin() + 1 ? Control::load : Control::filling;
}

/// Ratios and amounts are positive; a tension pulls; a voltage acts with its square; a pressure may be below that
/// around the robot, and a plunger drawn back.
double read_low(const Node& node, const ActuatorSpec& actuator) {
  if (actuator.control == Control::ratio) return positive(node);
  const double low = number(node);
  if (const auto* chamber = actuator.as<PneumaticSpec>(); chamber && chamber->filling && !chamber->filling->syringe_mL)
    return positive(node);
  if (actuator.is<CableSpec>() && low < 0)
    fail(node, node.name + " must not be negative, since a cable only pulls: " + node.text);
  if (actuator.is<DeaSpec>() && low < 0)
    fail(node, node.name + " must not be negative, since either sign of a voltage does the same: " + node.text);
  return low;
}

void read_range(const Node& node, ActuatorSpec& actuator) {
  const auto& items = list_of(2, node);
  actuator.low = read_low(*items[0], actuator);
  actuator.high = actuator.control == Control::ratio ? positive(*items[1]) : number(*items[1]);
  if (actuator.low > actuator.high)
    fail(node, node.name + " must be [low, high], but " + items[0]->text + " is above " + items[1]->text);
}

/// n of p V^n = const.
double read_process(const Node& node) {
  constexpr double isothermal = 1, adiabatic = 1.4;  // of air and what else has molecules of two atoms
  if (node.kind == Node::Kind::map) return positive(Map(node, {"exponent"}).at("exponent"));
  return choice(node, {"isothermal", "adiabatic"}) == 0 ? isothermal : adiabatic;
}

/// What a chamber is sealed with.
FillingSpec read_filling(const Map& map) {
  FillingSpec filling;
  const Node *source = map.find("source"), *liquid = map.find("liquid");
  filling.liquid = text(map.at("control")) == "liquid";
  if (liquid != nullptr && !filling.liquid) fail(*liquid, liquid->name + " belongs to 'control: liquid'");
  if (filling.liquid) {
    constexpr double per_GPa = 1e-3;
    const Map stiffness(map.at("liquid"), {"bulk_modulus", "compressibility"});
    const Node::Entry& by = stiffness.one_of({"bulk_modulus", "compressibility"});
    filling.compressibility = by.key == "bulk_modulus" ? 1 / positive(*by.value) : per_GPa * not_negative(*by.value);
  }
  if (source == nullptr) return filling;
  const Map keys(*source, {"syringe_mL", "dead_mL", "process"});
  if (const Node* node = keys.find("syringe_mL")) filling.syringe_mL = positive(*node);
  if (const Node* node = keys.find("dead_mL")) filling.dead_mL = not_negative(*node);
  if (const Node* node = keys.find("process")) {
    if (filling.liquid) fail(*node, node->name + " is of a gas, not of a liquid");
    filling.exponent = read_process(*node);
  }
  return filling;
}

/// Refuses what belongs to a sealed chamber where there is none.
void read_filling(const Map& map, ActuatorSpec& actuator) {
  if (actuator.control == Control::filling) {
    actuator.as<PneumaticSpec>()->filling = read_filling(map);
    return;
  }
  for (const char* key : {"source", "liquid"})
    if (const Node* node = map.find(key))
      fail(*node, node->name + " belongs to " + (key == std::string("liquid") ? "" : "'control: gas' and ") +
                      "'control: liquid'");
}

/// Reads a file, a map that names a file, or a map with the region of the wall's faces.
void read_wall(const Context& context, const Node& node, PneumaticSpec& chamber) {
  if (node.kind == Node::Kind::map) {
    Keys known = surface_keys();
    known.emplace_back("region");
    const Map map(node, known);
    const Node::Entry& entry = map.one_of({"file", "region"});
    if (entry.key == "region") {
      for (const std::string key : {"unit", "move", "rotate"})
        if (const Node* other = map.find(key)) fail(*other, "'" + key + "' is that of a file; a region has the mesh's");
      chamber.wall = text(*entry.value);
      return;
    }
  }
  chamber.surface = read_surface(context, node);
}

/// None of them: the only empty space in the body.
void read_chamber(const Context& context, const Map& map, PneumaticSpec& chamber) {
  const Node* region = map.find("region");
  const Node* surface = map.find("surface");
  const Node* connected = map.find("connected");
  const Node* place = map.find("void_at");
  if ((region != nullptr) + (surface != nullptr) + (connected != nullptr) + (place != nullptr) > 1)
    (void)map.one_of({"region", "surface", "connected", "void_at"});  // fails and names them
  if (connected) {
    for (const auto& item : list(*connected)) chamber.connected.push_back(text(*item));
    if (chamber.connected.size() < 2) fail(*connected, connected->name + " must hold at least 2 regions");
  }
  if (region) chamber.region = text(*region);
  if (surface) read_wall(context, *surface, chamber);
  if (place) chamber.void_at = read_position(context, *place);
}

void read_cable(const Context& context, const Map& map, CableSpec& cable) {
  const Node& points = map.at("points");
  for (const auto& item : list(points)) cable.points.push_back(read_point(context, *item));
  if (cable.points.size() < 2) fail(points, points.name + " must hold at least 2 points");
  if (const Node* spacing = map.find("spacing")) cable.spacing = read_positive_length(context, *spacing);
  const Node* apexes = map.find("apexes");
  if (!apexes) return;
  for (const auto& item : list(*apexes)) cable.apexes.push_back(read_point(context, *item));
  if (cable.apexes.empty() || cable.apexes.size() >= cable.points.size())
    fail(*apexes, apexes->name + " must hold 1 to " + std::to_string(cable.points.size() - 1) +
                      " points, at most one for each segment of the cable");
}

/// A file, or a map of file and branch.
void read_curve(const Context& context, const Node& node, ActuatorSpec& actuator) {
  const Node* file = &node;
  if (node.kind == Node::Kind::map) {
    const Map map(node, {"file", "branch"});
    file = &map.at("file");
    if (const Node* branch = map.find("branch"))
      actuator.branch = choice(*branch, {"loading", "unloading"}) == 0 ? Branch::loading : Branch::unloading;
  }
  if (actuator.control == Control::filling)
    fail(node, node.name + " turns a pressure into a volume, but what fills the chamber is controlled here: leave " +
                   node.name + " out, or use 'control: volume'");
  if (actuator.control == Control::load) {
    const bool dea = actuator.is<DeaSpec>();
    const std::string load = dea ? "voltage" : "pressure", ratio = dea ? "area" : "volume";
    fail(node, node.name + " turns a " + load + " into " + (dea ? "an " : "a ") + ratio + ", but the " + load +
                   " itself is controlled here: leave " + node.name + " out, or use 'control: " + ratio + "'");
  }
  actuator.curve = load_file(context, *file, context.files.curve);
}

/// Reads a CSV file of the fraction of the voltage at each prism of the layer.
PrismValues read_fractions(const Context& context, const Node& node, Control control) {
  if (control == Control::ratio) fail(node, node.name + " belongs to 'control: voltage'");
  return load_file(context, node, [&](const std::filesystem::path& path) {
    const std::string content = context.files.scene(path);
    const CsvTable table = parse_csv(path.string(), content);
    if (table.columns != std::vector<std::string>{"prism", "share"})
      table.fail_header("the columns must be prism,share: the number of a prism in the mesh, from 0, and its fraction");
    PrismValues fractions;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      const double prism = table.rows[row][0];
      if (!(prism >= 0 && prism < 2e9 && prism == std::floor(prism)))
        table.fail(row, "column 'prism' must hold a whole number from 0, not " + softkin::number(prism));
      fractions.prisms.push_back(static_cast<Index>(prism));
      fractions.values.push_back(table.rows[row][1]);
      fractions.origins.push_back({.file = table.file, .line = table.lines[row]});
    }
    return fractions;
  });
}

/// What of a commanded tension or pressure acts.
void read_fraction(const Map& map, ActuatorSpec& actuator) {
  const Node *factor = map.find("factor"), *offset = map.find("offset"), *backlash = map.find("backlash");
  for (const Node* node : {factor, offset, backlash})
    if (node != nullptr && actuator.control != Control::load)
      fail(*node, node->name + " belongs to 'control: tension' and 'control: pressure'");
  if (factor != nullptr) actuator.factor = positive(*factor);
  if (offset != nullptr) actuator.offset = number(*offset);
  if (backlash != nullptr) actuator.backlash = not_negative(*backlash);
}

/// Where a cable turns inside the robot, and in a sheath before that.
void read_rubbing(const Map& map, Formulation formulation, CableSpec& cable) {
  const Node *friction = map.find("friction"), *sheath = map.find("sheath");
  for (const Node* node : {friction, sheath})
    if (node != nullptr && formulation != Formulation::physical)
      fail(*node, node->name + " belongs to the physical formulation, which knows tensions");
  if (friction != nullptr) cable.friction = not_negative(*friction);
  if (sheath == nullptr) return;
  const Map keys(*sheath, {"turns_degrees", "friction"});
  cable.sheath_friction = not_negative(keys.at("friction"));
  cable.sheath_turns_degrees = not_negative(keys.at("turns_degrees"));
}

void read_dea(const Context& context, const Map& map, ActuatorSpec& actuator, DeaSpec& dea) {
  if (const Node* node = map.find("prestretch"))
    (actuator.control == Control::ratio ? actuator.rest : dea.prestretch) = positive(*node);
  if (const Node* node = map.find("voltage_share")) dea.fractions = read_fractions(context, *node, actuator.control);
  dea.region = text(map.at("region"));
}

std::vector<ActuatorSpec> read_actuator(const Context& context, Formulation formulation, const Map& map, Names& names) {
  ActuatorSpec actuator;
  actuator.origin = map.node().origin;
  actuator.name = names.add_label(map.at("name"));
  const Kind& kind = read_kind(map);
  actuator.drive = kind.drive;
  if (actuator.is<FieldSpec>()) return read_field(context, map, actuator.name);
  if (actuator.is<GrowthSpec>()) return {read_growth(context, map, actuator.name)};
  actuator.control = read_control(map, kind, formulation);
  if (actuator.control == Control::load) actuator.rest = 0;
  read_filling(map, actuator);
  read_range(map.at("range"), actuator);
  if (const Node* node = map.find("weight")) actuator.weight = positive(*node);
  if (const Node* node = map.find("distribution"))
    actuator.distribution = static_cast<Distribution>(choice(*node, {"least-norm", "uniform", "proportional"}));
  if (auto* dea = actuator.as<DeaSpec>()) read_dea(context, map, actuator, *dea);
  read_fraction(map, actuator);
  if (auto* cable = actuator.as<CableSpec>()) read_rubbing(map, formulation, *cable);
  if (const Node* node = map.find("curve")) read_curve(context, *node, actuator);
  if (auto* chamber = actuator.as<PneumaticSpec>()) read_chamber(context, map, *chamber);
  if (auto* cable = actuator.as<CableSpec>()) read_cable(context, map, *cable);
  return {std::move(actuator)};
}

}  // namespace

TriangleSurface read_surface_file(const Context& context, const Node& file, const Node* unit) {
  const double to_mm = unit ? mm_per(length_units()[choice(*unit, length_units())]) : context.to_mm;
  TriangleSurface surface = load_file(context, file, context.files.surface);
  surface.vertices *= to_mm;
  if (!surface.vertices.allFinite()) fail(file, "the surface's coordinates are too large");
  return surface;
}

const Keys& surface_keys() {
  static const Keys keys{"file", "unit", "move", "rotate"};
  return keys;
}

TriangleSurface read_surface(const Context& context, const Node& node) {
  if (node.kind != Node::Kind::map) return read_surface_file(context, node, nullptr);
  const Map map(node, surface_keys());
  return read_moved_surface(context, map.at("file"), map);
}

TriangleSurface read_moved_surface(const Context& context, const Node& file, const Map& map) {
  TriangleSurface surface = read_surface_file(context, file, map.find("unit"));
  move_and_rotate(context, map, surface.vertices);
  if (!surface.vertices.allFinite()) fail(file, "the surface's coordinates are too large");
  return surface;
}

std::vector<ActuatorSpec> read_actuators(const Context& context, Formulation formulation, const Node& node) {
  Keys known = common_keys;
  const Keys of_kinds = all_kind_keys();
  known.insert(known.end(), of_kinds.begin(), of_kinds.end());
  std::vector<ActuatorSpec> actuators;
  Names names;
  for (const auto& item : list(node))
    for (ActuatorSpec& actuator : read_actuator(context, formulation, Map(*item, known), names))
      actuators.push_back(std::move(actuator));
  return actuators;
}

}  // namespace softkin::scene
