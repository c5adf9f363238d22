#include "random/generator.hpp"

#include <limits>

#include "random/parts.hpp"

namespace softkin::random_robots {

namespace {

void choose_oddities(Making& m) {
  static const std::array<const char*, static_cast<std::size_t>(Oddity::count)> names{
      "inverted",  "sliver",   "repeated",   "cracked",     "overlapping", "loose", "isolated",
      "bad cells", "far away", "not finite", "materials",   "supports",    "loads", "actuators",
      "commands",  "rigid",    "voids",      "interrupted", "impatient",   "curved"};
  m.made.sensible = m.draw.chance(0.7);
  if (m.made.sensible) return;
  const int count = m.draw.whole(1, 3);
  for (int i = 0; i < count; ++i) {
    const auto oddity = static_cast<Oddity>(m.draw.below(static_cast<int>(Oddity::count)));
    if (m.is(oddity)) continue;
    m.odd.push_back(oddity);
    m.made.features.emplace_back(names[static_cast<std::size_t>(oddity)]);
  }
}

/// One number somewhere in the description becomes none.
void spoil_number(Making& m) {
  if (!m.is(Oddity::not_finite)) return;
  const double bad =
      m.draw.chance(0.5) ? std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::infinity();
  RobotSpec& spec = m.made.spec;
  switch (m.draw.below(6)) {
    case 0: {
      const int axis = m.draw.below(3), v = m.draw.below(static_cast<int>(spec.mesh.vertices.rows()));
      spec.mesh.vertices(v, axis) = bad;
      break;
    }
    case 1:
      spec.loads.gravity[m.draw.below(3)] = bad;
      break;
    case 2:
      spec.materials[0].density = bad;
      if (spec.materials[0].elastic) spec.materials[0].elastic->poisson_ratio = bad;
      break;
    case 3:
      if (!spec.fixed.empty()) spec.fixed[0].displacement[m.draw.below(3)] = bad;
      break;
    case 4:
      spec.loads.forces.push_back({"none", {std::string("x_high"), {}}, {0, bad, 0}});
      break;
    default:
      for (Actuation& command : m.made.commands)
        if (command.size() > 0) command[0] = bad;
      if (!spec.actuators.empty() && m.draw.chance(0.3)) spec.actuators[0].high = bad;
  }
}

}  // namespace

RandomCase make_case(std::uint64_t seed) {
  Making m(seed);
  m.made.spec.name = "random-" + std::to_string(seed);
  if (make_film(m)) return std::move(m.made);
  m.physical = m.draw.chance(0.65);
  m.made.spec.formulation = m.physical ? Formulation::physical : Formulation::target_shape;
  choose_oddities(m);
  make_mesh(m);
  make_actuators(m);
  make_supports(m);
  spoil_mesh(m);
  make_materials(m);
  scale_robot(m);
  make_loads(m);
  make_commands(m);
  make_options(m);
  make_magnetism(m);
  make_growth(m);
  make_stiff(m);
  make_floor(m);
  make_weights(m);
  make_turns(m);
  make_tractions(m);
  make_mixed(m);
  make_families(m);
  make_submerged(m);
  make_friction(m);
  make_sealed(m);
  make_fibres(m);
  make_layers(m);
  make_wrenches(m);
  spoil_number(m);
  return std::move(m.made);
}

}  // namespace softkin::random_robots
