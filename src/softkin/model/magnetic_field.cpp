#include <softkin/model/magnetic_field.hpp>

namespace softkin {

int axis_of(FieldCommand command) {
  switch (command) {
    case FieldCommand::flux_density:
    case FieldCommand::current:
      return -1;
    case FieldCommand::flux_density_x:
    case FieldCommand::flux_density_y:
    case FieldCommand::flux_density_z:
      return static_cast<int>(command) - static_cast<int>(FieldCommand::flux_density_x);
    case FieldCommand::position_x:
    case FieldCommand::position_y:
    case FieldCommand::position_z:
      return static_cast<int>(command) - static_cast<int>(FieldCommand::position_x);
    case FieldCommand::moment_x:
    case FieldCommand::moment_y:
    case FieldCommand::moment_z:
      break;
  }
  return static_cast<int>(command) - static_cast<int>(FieldCommand::moment_x);
}

bool places_dipole(FieldCommand command) {
  return command >= FieldCommand::position_x && command <= FieldCommand::position_z;
}

Vec3 GridField::high() const {
  Vec3 end = low;
  for (int axis = 0; axis < 3; ++axis) end[axis] += step[axis] * (counts[axis] - 1);
  return end;
}

}  // namespace softkin
