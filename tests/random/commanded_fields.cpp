#include "random/commanded_fields.hpp"

namespace softkin::random_robots {

CommandedFields::CommandedFields(const Model& model, const State& state) {
  std::vector<DipoleField> of_source;
  for (const FieldSource& source : model.magnetism->sources) {
    const auto* dipole = std::get_if<DipoleField>(&source.field);
    of_source.push_back(dipole ? *dipole : DipoleField{});
  }
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const auto* drive = model.actuators[a].as<MagneticDrive>();
    if (!drive) continue;
    const std::size_t source = drive->source;
    const double value = state.actuation[a];
    const auto* along = std::get_if<UniformField>(&model.magnetism->sources[source].field);
    switch (drive->command) {
      case FieldCommand::flux_density:
        uniform += static_cast<Real>(value) * along->direction.cast<Real>();
        break;
      case FieldCommand::flux_density_z:
        uniform[2] += value;
        break;
      case FieldCommand::position_x:
        of_source[source].position[0] = value;
        break;
      default:
        of_source[source].moment[1] = value;
    }
  }
  for (DipoleField& dipole : of_source) {
    dipole.moment *= state.load_factor;
    if (!dipole.moment.isZero(0)) dipoles.push_back(dipole);
  }
}

RealFlux CommandedFields::at(const RealVec3& place) const {
  RealFlux flux{uniform, RealMat3::Zero()};
  for (const DipoleField& dipole : dipoles) {
    const RealVec3 r = place - dipole.position.cast<Real>(), m = dipole.moment.cast<Real>();
    const Real length = r.norm(), c = 1e5L / std::pow(length, 3);  // 1e-7 T m / A
    const RealVec3 n = r / length;
    flux.value += c * (3 * m.dot(n) * n - m);
    flux.slope +=
        3 * c / length *
        (n * m.transpose() + m * n.transpose() + m.dot(n) * RealMat3::Identity() - 5 * m.dot(n) * n * n.transpose());
  }
  return flux;
}

}  // namespace softkin::random_robots
