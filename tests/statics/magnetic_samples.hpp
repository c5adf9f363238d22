#pragma once

#include <Eigen/Geometry>
#include <softkin/model/magnetic_field.hpp>

#include "statics/physical_samples.hpp"

namespace softkin::testing {

constexpr std::array<Magnetisation, 2> both_magnetisations{Magnetisation::turns, Magnetisation::stretches};

inline void magnetise(RobotSpec& spec, const Vec3& remanence, Magnetisation magnetisation = Magnetisation::turns) {
  RemanenceSpec of;
  of.uniform = remanence;
  of.magnetisation = magnetisation;
  spec.materials[0].remanence = std::make_shared<const RemanenceSpec>(of);
}

/// An actuator for each of a source's commands, named by their numbers.
inline void add_field(RobotSpec& spec, FieldSource source, const std::vector<FieldCommand>& commands,
                      double range = 1e3) {
  const auto shared = std::make_shared<const FieldSource>(std::move(source));
  for (const FieldCommand command : commands) {
    ActuatorSpec field = actuator(shared->name + std::to_string(static_cast<int>(command)), FieldSpec{shared, command},
                                  -range, range, true);
    field.control = Control::load;
    field.rest = 0;
    if (places_dipole(command)) field.rest = std::get<DipoleField>(shared->field).position[axis_of(command)];
    spec.actuators.push_back(field);
  }
}

inline void add_uniform(RobotSpec& spec) {
  add_field(spec, {"uniform", UniformField{}},
            {FieldCommand::flux_density_x, FieldCommand::flux_density_y, FieldCommand::flux_density_z});
}

/// Two loops, one of them askew.
inline CoilField two_loops(const Vec3& center) {
  return {{{center, Vec3(0, 0, 1), 40, 100}, {center + Vec3(20, 5, 10), Vec3(1, 2, -1), 25, -60}}};
}

/// A field with all that a grid may hold: a point of it is (x, y, z) mm.
inline GridField sampled(const std::function<Vec3(const Vec3&)>& field, const Vec3& low, const Vec3& high,
                         const std::array<Index, 3>& counts) {
  GridField grid;
  grid.file = "grid.csv";
  grid.low = low;
  grid.counts = counts;
  for (int axis = 0; axis < 3; ++axis) grid.step[axis] = (high - low)[axis] / (counts[axis] - 1);
  for (Index k = 0; k < counts[2]; ++k)
    for (Index j = 0; j < counts[1]; ++j)
      for (Index i = 0; i < counts[0]; ++i)
        grid.per_ampere.push_back(field(low + Vec3(i, j, k).cwiseProduct(grid.step)));
  return grid;
}

}  // namespace softkin::testing
