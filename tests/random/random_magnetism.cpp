#include <softkin/model/magnetic_field.hpp>

#include "random/parts.hpp"

namespace softkin::random_robots {

namespace {

/// Draws of its own, so that robots of the same seed are otherwise what they were without magnets.
constexpr std::uint64_t own_draws = 0x6D61676E6574, draws_of_form = 0x7475726E73;

void magnetise_all(Making& m, Draw& draw, double remanence) {
  RemanenceSpec spec;
  spec.uniform = remanence * draw.offset();
  if (Draw(m.made.seed ^ draws_of_form).chance(0.4)) spec.magnetisation = Magnetisation::stretches;
  for (MaterialSpec& material : m.made.spec.materials) material.remanence = std::make_shared<const RemanenceSpec>(spec);
}

void add_command(Making& m, Draw& draw, const std::shared_ptr<const FieldSource>& source, FieldCommand command,
                 double low, double high) {
  ActuatorSpec spec;
  spec.name = "field" + std::to_string(m.made.spec.actuators.size());
  spec.control = Control::load;
  spec.low = low;
  spec.high = high;
  spec.rest = places_dipole(command) ? 0.5 * (low + high) : 0;
  spec.drive = FieldSpec{source, command};
  m.made.spec.actuators.push_back(spec);
  for (Actuation& actuation : m.made.commands) {
    actuation.conservativeResize(actuation.size() + 1);
    actuation[actuation.size() - 1] = draw.between(low, high);
  }
}

/// flux  about what the field at the robot is to be [mT]
void add_dipole(Making& m, Draw& draw, double flux) {
  Vec3 middle = m.mesh().vertices.colwise().mean().transpose();
  if (!middle.allFinite()) middle.setZero();
  const double distance = draw.between(1.5, 4) * m.longest();
  DipoleField dipole{middle + distance * (Vec3(0, 0, 1.5) + draw.offset()), Vec3::Zero()};
  const double moment = flux * std::pow((dipole.position - middle).norm(), 3) / 2e5;
  dipole.moment = moment * draw.offset();
  const auto source = std::make_shared<const FieldSource>(FieldSource{"magnet", dipole});
  add_command(m, draw, source, FieldCommand::moment_y, -moment, moment);
  if (draw.chance(0.5))
    add_command(m, draw, source, FieldCommand::position_x, dipole.position.x() - 0.2 * distance,
                dipole.position.x() + 0.2 * distance);
}

}  // namespace

void make_magnetism(Making& m) {
  Draw draw(m.made.seed ^ own_draws);
  if (!draw.chance(m.physical ? 0.25 : 0.01)) return;
  const double remanence = draw.log_between(10, 1000);
  // scaled to about this strain where the field is across the robot, which bends it by far more
  const double slender = std::min(1.0, std::min(m.size[1], m.size[2]) / m.size[0]);
  const double strain = m.is(Oddity::loads) ? draw.log_between(1e-4, 1e6) : draw.log_between(1e-6, 0.01);
  const double flux = strain * slender * slender * m.modulus / (inverse_permeability * remanence);
  magnetise_all(m, draw, remanence);
  if (m.is(Oddity::materials) && draw.chance(0.3)) m.made.spec.materials.back().remanence.reset();
  if (draw.chance(0.3)) {
    add_dipole(m, draw, flux);
    return;
  }
  const auto source = std::make_shared<const FieldSource>(FieldSource{"uniform", UniformField{draw.offset()}});
  add_command(m, draw, source, FieldCommand::flux_density, -flux, flux);
  if (draw.chance(0.4)) add_command(m, draw, source, FieldCommand::flux_density_z, 0, flux);
}

}  // namespace softkin::random_robots
