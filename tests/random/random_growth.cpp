#include <softkin/model/families.hpp>
#include <softkin/model/growth.hpp>

#include "random/parts.hpp"

namespace softkin::random_robots {

namespace {

/// Draws of its own, so that robots of the same seed are otherwise what they were.
constexpr std::uint64_t draws_of_growth = 0x67726F777468, draws_of_families = 0x66616D696C69,
                        draws_of_liquid = 0x6C6971756964;

DirectionSpec random_direction(Making& m, Draw& draw) {
  DirectionSpec spec;
  spec.uniform = draw.offset();
  if (draw.chance(0.5)) return spec;
  spec.kind = draw.chance(0.5) ? DirectionSpec::Kind::radial : DirectionSpec::Kind::circumferential;
  spec.center = m.mesh().vertices.colwise().mean().transpose();
  spec.center += 0.37 * m.size.minCoeff() * draw.offset();
  spec.axis = draw.offset();
  spec.degrees = draw.between(-90, 90);
  return spec;
}

}  // namespace

void make_growth(Making& m) {
  Draw draw(m.made.seed ^ draws_of_growth);
  if (!draw.chance(m.physical ? 0.15 : 0.01) || m.mesh().vertices.rows() == 0) return;
  ActuatorSpec spec;
  spec.name = "growth" + std::to_string(m.made.spec.actuators.size());
  GrowthPart growth{draw.pick({std::string("all"), std::string("growing")})};
  if (m.has_layer) growth.region = "growing";  // what a layer's prisms are not in
  for (const Region& region : m.mesh().regions)
    if (region.name == "part0" && draw.chance(0.7)) growth.region = "part0";
  if (growth.region == "growing") {
    const Vec3 low = m.mesh().vertices.colwise().minCoeff().transpose(),
               high = m.mesh().vertices.colwise().maxCoeff().transpose();
    const Vec3 from(low.x() - 1, low.y() - 1, 0.5 * (low.z() + high.z()));
    m.made.spec.regions.push_back({"growing", Selector(Box{from, high + Vec3::Ones()}), {}});
  }
  if (draw.chance(0.6)) growth.direction = random_direction(m, draw);
  growth.keeps_volume = growth.direction && draw.chance(0.4);
  const double most = m.is(Oddity::actuators) ? 1.5 : 0.12;
  spec.low = 1 / (1 + most);
  spec.high = 1 + most;
  double command = draw.between(spec.low, spec.high);
  if (draw.chance(0.4)) {
    const double per_K = most / 80 * draw.pick({-1, 1});
    growth.temperature = TemperatureSpec{20, per_K, {}};
    if (draw.chance(0.5)) growth.temperature = TemperatureSpec{20, {}, {{-60, 3}, {20, 3 + 240 * per_K}, {100, 3.1}}};
    spec.control = Control::load;
    spec.rest = 20;
    spec.low = -60;
    spec.high = per_K < 0 && !growth.temperature->expansion_per_K ? 80 : 70;
    command = draw.between(spec.low, spec.high);
  }
  spec.drive = GrowthSpec{{growth}};
  m.made.spec.actuators.push_back(std::move(spec));
  for (Actuation& actuation : m.made.commands) {
    actuation.conservativeResize(actuation.size() + 1);
    actuation[actuation.size() - 1] = command;
  }
}

void make_families(Making& m) {
  Draw draw(m.made.seed ^ draws_of_families);
  if (!draw.chance(m.physical ? 0.12 : 0.01) || m.mesh().vertices.rows() == 0) return;
  for (const ActuatorSpec& actuator : m.made.spec.actuators)
    if (actuator.is<GrowthSpec>()) return;
  for (MaterialSpec& material : m.made.spec.materials) {
    if (!draw.chance(0.7)) continue;
    FamiliesSpec families;
    for (int i = draw.whole(1, 2); i > 0; --i)
      families.families.push_back({m.modulus * draw.log_between(0.01, 3),
                                   draw.chance(0.2) ? 0 : draw.log_between(0.1, 20),
                                   draw.chance(0.5) ? 0 : draw.between(0, 1.0 / 3), random_direction(m, draw)});
    material.families = std::make_shared<const FamiliesSpec>(std::move(families));
  }
}

void make_submerged(Making& m) {
  Draw draw(m.made.seed ^ draws_of_liquid);
  const double gravity = m.made.spec.loads.gravity.norm();
  if (!(gravity > 0 && std::isfinite(gravity)) || !draw.chance(0.5) || m.mesh().vertices.rows() == 0) return;
  const Vec3 low = m.mesh().vertices.colwise().minCoeff().transpose(),
             size = m.mesh().vertices.colwise().maxCoeff().transpose() - low;
  if (!size.allFinite()) return;
  const double slender = std::min(1.0, std::min(m.size[1], m.size[2]) / m.size[0]);
  const double pressure = draw.log_between(1e-6, 0.02) * slender * m.modulus;
  LiquidAroundSpec liquid;
  liquid.density = pressure / (1e-9 * gravity * size.maxCoeff());
  const double z = draw.between(-0.5, 1.5), y = draw.between(-0.5, 1.5), x = draw.between(-0.5, 1.5);
  liquid.surface = low + size.cwiseProduct(Vec3(x, y, z));
  m.made.spec.loads.liquid_around = liquid;
}

}  // namespace softkin::random_robots
