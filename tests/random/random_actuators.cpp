#include "random/parts.hpp"

namespace softkin::random_robots {

using namespace testing;

namespace {

ActuatorSpec named(Making& m, DriveSpec drive, double low, double high) {
  ActuatorSpec spec;
  spec.name = "actuator" + std::to_string(m.made.spec.actuators.size());
  spec.drive = std::move(drive);
  spec.low = low;
  spec.high = high;
  spec.distribution = m.draw.chance(0.6) ? Distribution::minimum_norm : Distribution::uniform;
  return spec;
}

/// A line through the body along x, at a random height.
ActuatorSpec random_cable(Making& m) {
  ActuatorSpec spec = named(m, CableSpec{}, 0.8, 1.05);
  std::vector<PointRef>& points = spec.as<CableSpec>()->points;
  const double y = m.size[1] * m.draw.between(0.1, 0.9), z = m.size[2] * m.draw.between(0.1, 0.9);
  const int count = m.draw.whole(2, 5);
  for (int i = 0; i < count; ++i) points.push_back({Vec3(m.size[0] * i / (count - 1), y, z), {}});
  if (!m.is(Oddity::actuators)) return spec;
  spec.low = m.draw.pick({0.8, 0.3, 0.01});
  const double reach = m.draw.pick({0.0, 0.3, 3.0});  // outside the body
  for (PointRef& point : points)
    if (m.draw.chance(0.4))
      point.point = Vec3(m.size.cwiseProduct(0.5 * (Vec3::Ones() + (1 + reach) * m.draw.offset())));
  if (m.draw.chance(0.15)) points.back() = points.front();
  if (m.draw.chance(0.15)) points[1] = points[0];
  return spec;
}

ActuatorSpec random_chamber(Making& m) {
  ActuatorSpec spec = named(m, PneumaticSpec{.region = "chamber"}, 0.8, 1.4);
  PneumaticSpec& chamber = *spec.as<PneumaticSpec>();
  if (m.physical && m.draw.chance(0.15)) {  // a bag inside the body
    const Vec3 low = m.size.cwiseProduct(Vec3::Constant(0.2)),
               bag = m.size.cwiseProduct(Vec3::Constant(m.draw.between(0.2, 0.7)));
    chamber.region.reset();
    chamber.surface = box_surface(low, bag);
  }
  if (!m.is(Oddity::actuators)) return spec;
  spec.high = m.draw.pick({1.4, 3.0, 20.0});
  spec.low = m.draw.pick({0.8, 0.1, 1e-3});
  if (m.draw.chance(0.1)) chamber.region = "body";
  if (m.draw.chance(0.1)) chamber.region = "part0";
  if (m.draw.chance(0.05)) chamber.region = "x_low";
  if (chamber.surface && m.draw.chance(0.3)) chamber.surface->triangles.pop_back();
  return spec;
}

ActuatorSpec random_layer(Making& m) {
  ActuatorSpec spec = named(m, DeaSpec{.region = "layer"}, 0.9, 1.2);
  spec.rest = m.draw.chance(0.2) ? 1.1 : 1;
  if (!m.is(Oddity::actuators)) return spec;
  spec.low = m.draw.pick({0.9, 0.2, 0.01});
  spec.high = m.draw.pick({1.2, 3.0, 20.0});
  spec.rest = m.draw.pick({1.0, 1.1, 2.0});
  return spec;
}

/// The same, commanded by tension, pressure or voltage. Ranges are in units of the modulus, until make_loads().
void command_load(const Making& m, Draw& draw, ActuatorSpec& spec) {
  spec.control = Control::load;
  spec.rest = 0;
  spec.low = spec.is<PneumaticSpec>() ? draw.pick({0.0, -0.02}) : 0;
  spec.high = m.is(Oddity::actuators) ? draw.pick({0.1, 1.0, 1e6}) : 0.02;
  auto* dea = spec.as<DeaSpec>();
  if (dea == nullptr) return;
  dea->prestretch = draw.chance(0.4) ? draw.between(0.8, 1.1) : 1;
  if (!m.is(Oddity::actuators)) spec.high = 0.04;
}

/// Of another kind than its region or its points are, as somebody writes who errs.
void misname(Making& m, ActuatorSpec& spec) {
  std::string region = "cable";
  if (const auto* chamber = spec.as<PneumaticSpec>()) region = chamber->region.value_or("surface");
  if (const auto* dea = spec.as<DeaSpec>()) region = dea->region;
  const int kind = m.draw.below(3);
  if (kind == 0 && !spec.is<CableSpec>()) spec.drive = CableSpec{};
  if (kind == 1 && !spec.is<PneumaticSpec>()) spec.drive = PneumaticSpec{.region = region};
  if (kind == 2 && !spec.is<DeaSpec>()) spec.drive = DeaSpec{.region = region};
}

}  // namespace

void make_actuators(Making& m) {
  std::vector<ActuatorSpec>& actuators = m.made.spec.actuators;
  if (m.has_chamber && m.draw.chance(0.9)) actuators.push_back(random_chamber(m));
  if (m.has_layer && m.draw.chance(0.9)) actuators.push_back(random_layer(m));
  for (int i = m.draw.chance(0.5) ? m.draw.whole(1, 2) : 0; i > 0; --i) actuators.push_back(random_cable(m));
  for (ActuatorSpec& spec : actuators) {
    if (m.draw.chance(0.3)) spec.weight = m.draw.log_between(0.5, 20);
    Draw& draw = spec.is<DeaSpec>() ? m.later : m.draw;
    if (draw.chance(m.physical ? 0.3 : 0.01)) command_load(m, draw, spec);
    if (!m.is(Oddity::actuators)) continue;
    if (m.draw.chance(0.05)) std::swap(spec.low, spec.high);
    if (m.draw.chance(0.05)) spec.name = "actuator0";
    if (m.draw.chance(0.05)) spec.weight = m.draw.pick({0.0, -1.0, 1e6, 1e-6});
    if (m.draw.chance(0.05)) misname(m, spec);
  }
}

void make_friction(Making& m) {
  if (!m.physical || !m.later.chance(0.4)) return;
  for (ActuatorSpec& spec : m.made.spec.actuators) {
    auto* cable = spec.as<CableSpec>();
    if (cable == nullptr) continue;
    cable->friction = m.later.between(0.05, 0.5);
    if (!m.later.chance(0.3)) continue;
    cable->sheath_friction = m.later.between(0.02, 0.2);
    cable->sheath_turns_degrees = m.later.between(30, 400);
  }
}

}  // namespace softkin::random_robots
