#include "random/parts.hpp"

namespace softkin::random_robots {

using namespace testing;

namespace {

/// Constants of a law that has Young's modulus e and Poisson's ratio nu at small strains.
ElasticSpec random_elastic(Making& m, double e, double nu) {
  ElasticSpec spec;
  spec.law = m.draw.pick(
      {Law::st_venant_kirchhoff, Law::corotational, Law::neo_hookean, Law::neo_hookean, Law::mooney_rivlin, Law::yeoh});
  if (m.later.chance(1.0 / 7)) spec.law = Law::gent;
  if (!forbids_inversion(spec.law)) {
    spec.youngs_modulus = e;
    spec.poisson_ratio = nu;
    return spec;
  }
  const double half_shear = e / (4 * (1 + nu));
  const double fraction = spec.law == Law::mooney_rivlin ? m.draw.between(0, 0.5) : 0;
  if (spec.law == Law::gent) {
    spec.shear_modulus = 2 * half_shear;
    spec.jm = m.later.log_between(m.is(Oddity::materials) ? 0.1 : 5, 200);
  } else {
    spec.c10 = (1 - fraction) * half_shear;
  }
  if (spec.law == Law::mooney_rivlin) spec.c01 = fraction * half_shear;
  if (spec.law == Law::yeoh && m.draw.chance(0.7)) {
    spec.c20 = m.draw.between(m.is(Oddity::materials) ? -1 : -0.02, 0.1) * half_shear;
    spec.c30 = m.draw.between(0, 0.02) * half_shear;
  }
  if (m.draw.chance(0.5))
    spec.poisson_ratio = nu;
  else
    spec.bulk_modulus = 4 * half_shear * (1 + nu) / (3 * (1 - 2 * nu));
  return spec;
}

double random_poisson(Making& m) {
  if (m.is(Oddity::materials))
    return m.draw.pick({-0.9, m.draw.between(-0.9, 0), 0.0, 0.49, 0.499, m.draw.chance(0.1) ? 0.5 : 0.4});
  return m.draw.between(0.1, 0.47);
}

MaterialSpec random_material(Making& m, const std::string& region, double e) {
  MaterialSpec material;
  material.region = region;
  material.shape_ratio = m.draw.chance(0.4) ? 1.0 : m.draw.between(m.is(Oddity::materials) ? 0 : 0.2, 1);
  if (m.draw.chance(0.4))
    material.weight = m.is(Oddity::materials) ? m.draw.log_between(1e-3, 1e3) : m.draw.between(0.5, 3);
  if (m.is(Oddity::materials) && m.draw.chance(0.05)) material.shape_ratio = m.draw.pick({-0.5, 1.5});
  if (m.physical || m.draw.chance(0.3)) material.elastic = random_elastic(m, e, random_poisson(m));
  material.density = m.draw.chance(0.8) ? m.draw.between(900, 3000) : 0;
  if (m.draw.chance(0.1)) material.linear_range = 0.05;
  if (!m.is(Oddity::materials) || m.later.chance(0.9)) material.permittivity = m.later.between(1, 5);
  if (m.physical && m.later.chance(0.2))
    for (int count = m.later.whole(1, 3); count > 0; --count)
      material.viscosity.push_back({e * m.later.log_between(0.01, 1), m.later.log_between(0.01, 100)});
  return material;
}

}  // namespace

void make_materials(Making& m) {
  const bool odd = m.is(Oddity::materials);
  m.modulus = m.draw.log_between(1e-3, 1e6);
  m.made.spec.materials.push_back(random_material(m, "all", m.modulus));
  for (const char* part : {"part0", "part1", "layer"}) {
    const bool is_there = std::any_of(m.mesh().regions.begin(), m.mesh().regions.end(),
                                      [&](const Region& region) { return region.name == part; });
    if (!is_there || !m.draw.chance(0.35)) continue;
    const double ratio = odd ? m.draw.log_between(1e-6, 1e6) : m.draw.log_between(0.05, 20);
    m.made.spec.materials.push_back(random_material(m, part, m.modulus * ratio));
  }
  if (odd && m.draw.chance(0.05)) m.made.spec.materials.erase(m.made.spec.materials.begin());
}

namespace {

RegionRef face(const char* name) {
  return {std::string(name), {}};
}

RegionRef low_box(const Making& m, double from, double to) {
  const Vec3 margin = 0.2 * m.size;
  return {Selector(Box{Vec3(from * m.size[0], -margin[1], -margin[2]),
                       Vec3(to * m.size[0], m.size[1] + margin[1], m.size[2] + margin[2])}),
          {}};
}

FixedSpec random_support(Making& m) {
  FixedSpec fixed{face(m.draw.pick({"x_low", "x_high", "y_low", "y_high", "z_low", "z_high"})), {}, {0, 0, 0}};
  if (m.draw.chance(0.3)) fixed.where = low_box(m, -0.1, m.draw.between(0.01, 0.5));
  if (m.draw.chance(0.2)) {
    VertexList list;
    for (int i = m.draw.whole(1, 4); i > 0; --i)
      list.vertices.push_back(m.draw.below(static_cast<int>(m.mesh().vertices.rows())));
    fixed.where = {Selector(list), {}};
  }
  if (m.draw.chance(0.5))
    for (bool& axis : fixed.axes) axis = m.draw.chance(0.5);
  for (int axis = 0; axis < 3; ++axis)
    if (fixed.axes[axis] && m.draw.chance(0.3))
      fixed.displacement[axis] = m.draw.pick({0.1, 1.0, 10.0, 1e4}) * m.draw.between(-1, 1);
  return fixed;
}

void add_odd_rigid(Making& m) {
  for (int i = m.draw.whole(1, 3); i > 0; --i) {
    const double to = m.draw.between(0.1, 1.1), from = m.draw.between(-0.1, 0.9);
    RigidSpec rigid{low_box(m, from, to), ""};
    if (m.draw.chance(0.4)) rigid.where = face(m.draw.pick({"x_low", "y_low", "z_high", "x_high"}));
    if (m.draw.chance(0.3)) rigid.name = "same";
    m.made.spec.rigid.push_back(rigid);
  }
}

}  // namespace

void make_supports(Making& m) {
  RobotSpec& spec = m.made.spec;
  if (!m.is(Oddity::supports)) {
    spec.fixed.push_back({face("x_low"), {true, true, true}, {0, 0, 0}});
    if (m.draw.chance(0.15)) spec.fixed[0].displacement = 0.05 * m.size.minCoeff() * m.draw.offset();
    if (m.draw.chance(0.1)) {  // the other end is pushed or pulled
      FixedSpec end{face("x_high"), {true, m.draw.chance(0.5), false}, {0, 0, 0}};
      end.displacement[0] = m.draw.between(-0.05, 0.1) * m.size[0];
      spec.fixed.push_back(end);
    }
  } else {
    for (int i = m.draw.whole(0, 3); i > 0; --i) spec.fixed.push_back(random_support(m));
  }
  if (m.is(Oddity::rigid)) {
    add_odd_rigid(m);
  } else if (m.draw.chance(0.15) && spec.fixed.size() == 1) {
    spec.rigid.push_back({face("x_high"), "end"});
  }
  if (!m.is(Oddity::voids)) return;
  if (m.draw.chance(0.5)) {
    spec.voids.push_back(RegionRef{std::string("part0"), {}});
    return;
  }
  const double to = m.draw.between(0.2, 1.1), from = m.draw.between(-0.1, 0.8);
  spec.voids.push_back(low_box(m, from, to));
}

namespace {

/// Voltage at which the field's pressure in a layer of unit permittivity is the modulus of "all" [kV].
double voltage_unit(Making& m) {
  constexpr double vacuum = 8.8541878128e-6;  // MPa per (kV/mm)^2
  double thickness = m.size[2];
  const Mesh& mesh = m.mesh();
  const auto exists = [&](Index v) { return v >= 0 && v < mesh.vertices.rows(); };
  for (const Prism& prism : mesh.prisms)
    if (exists(prism[0]) && exists(prism[3]))
      thickness = std::min(thickness, (mesh.vertices.row(prism[3]) - mesh.vertices.row(prism[0])).norm());
  return thickness * std::sqrt(m.modulus / vacuum);
}

/// Scales the ranges of tensions, pressures and voltages, which were in units of the modulus.
void scale_ranges(Making& m) {
  for (ActuatorSpec& actuator : m.made.spec.actuators) {
    if (actuator.control != Control::load) continue;
    const bool cable = actuator.is<CableSpec>();
    const double unit =
        actuator.is<DeaSpec>() ? voltage_unit(m) : m.modulus * (cable ? m.size[1] * m.size[2] : 1e3);  // N, kPa
    actuator.low *= unit;
    actuator.high *= unit;
  }
}

}  // namespace

void make_loads(Making& m) {
  scale_ranges(m);
  if (!m.physical && !m.draw.chance(0.1)) return;
  const bool odd = m.is(Oddity::loads);
  RobotSpec& spec = m.made.spec;
  const double density = 1e-9 * spec.materials[0].density;  // [kg/mm^3]
  if (m.draw.chance(odd ? 0.5 : 0.2) && (density > 0 || odd)) {
    // scaled to about this strain of a column
    const double strain = odd ? m.draw.log_between(1e-3, 1e9) : m.draw.log_between(1e-6, 1e-3);
    const double gravity = strain * m.modulus / (std::max(density, 1e-6) * m.longest());
    spec.loads.gravity = m.draw.chance(0.3) ? Vec3(0, 0, -9.81) : Vec3(gravity * m.draw.offset());
    if (m.draw.chance(0.3) && !odd) spec.loads.gravity = Vec3(0, 0, -gravity);
  }
  for (int i = m.draw.chance(odd ? 0.9 : 0.4) ? m.draw.whole(1, 2) : 0; i > 0; --i) {
    const double strain = odd ? m.draw.log_between(1e-4, 1e12) : m.draw.log_between(1e-6, 0.02);
    // a slender robot bends by far more than this strain
    const double area = m.size[1] * m.size[2], slender = std::min(1.0, std::min(m.size[1], m.size[2]) / m.size[0]);
    const Vec3 force = strain * (odd ? 1 : slender) * m.modulus * area * m.draw.offset();
    spec.loads.forces.push_back(
        {"force" + std::to_string(i), {std::string(m.draw.pick({"x_high", "z_high", "y_high"})), {}}, force});
  }
}

namespace {

double random_command(Making& m, const ActuatorSpec& actuator) {
  const double low = actuator.low, high = actuator.high;
  if (!m.is(Oddity::commands)) return low + m.draw.between(0, 1) * (high - low);
  switch (m.draw.below(8)) {
    case 0:
      return high + 0.01 * (1 + std::abs(high));
    case 1:
    case 2:
      return low;
    case 3:
    case 4:
      return high;
    default:
      return low + m.draw.between(0, 1) * (high - low);
  }
}

}  // namespace

void make_commands(Making& m) {
  const std::vector<ActuatorSpec>& actuators = m.made.spec.actuators;
  const int count = m.draw.chance(0.2) ? 2 : 1;
  for (int i = 0; i < count; ++i) {
    Actuation command(actuators.size());
    for (std::size_t a = 0; a < actuators.size(); ++a) command[a] = random_command(m, actuators[a]);
    if (m.is(Oddity::commands) && m.draw.chance(0.05)) command.conservativeResize(command.size() + 1);
    m.made.commands.push_back(std::move(command));
  }
}

void make_options(Making& m) {
  StaticsOptions& options = m.made.options;
  options.threads = 1;
  options.keep_history = m.draw.chance(0.1);
  if (!m.physical && m.draw.chance(0.15)) options.solver = Solver::local_global;
  if (!m.made.sensible && m.draw.chance(0.01)) options.solver = Solver::local_global;
  if (options.solver == Solver::local_global && m.draw.chance(0.3)) options.anderson = m.draw.whole(0, 20);
  if (m.draw.chance(0.1)) options.step_tolerance_mm = m.longest() * m.draw.log_between(1e-10, 1e-6);
  const auto is_viscous = [](const MaterialSpec& material) { return !material.viscosity.empty(); };
  if (std::any_of(m.made.spec.materials.begin(), m.made.spec.materials.end(), is_viscous) && m.later.chance(0.8))
    options.elapsed_s = m.later.chance(0.2) ? 0 : m.later.log_between(1e-4, 1e4);
  if (m.is(Oddity::impatient)) options.max_iterations = m.draw.whole(1, 20);
  if (m.is(Oddity::interrupted)) m.made.interrupt_after = m.draw.whole(1, 30);
  m.made.forgets = m.draw.chance(0.2);
}

}  // namespace softkin::random_robots
