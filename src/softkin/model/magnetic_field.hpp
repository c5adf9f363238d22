#pragma once

#include <softkin/model/robot_spec.hpp>
#include <variant>

namespace softkin {

/// 1 / mu_0, of two flux densities an energy per volume [MPa / mT^2].
constexpr double inverse_permeability = 7.957747155e-7;

/// How a remanent flux density b_r transforms where the material is deformed by F = R U.
enum class Magnetisation {
  turns,     // R b_r: stiff particles rotate with the material
  stretches  // F b_r
};

/// The remanent flux density of a material, in the frame of the robot at rest [mT]: uniform, or samples in space, of
/// which every element takes the one nearest to its centroid.
struct RemanenceSpec {
  Vec3 uniform{0, 0, 0};                               // where there are no samples [mT]
  Points places{}, samples{};                          // #samples by 3 [mm], [mT]; no rows: uniform
  std::string file{};                                  // of the samples, for messages
  Magnetisation magnetisation = Magnetisation::turns;  // how it follows the deformation
};

/// The quantity that a command of a source sets: flux density along a direction or an axis [mT], current [A], or of a
/// dipole coordinates [mm] and components of the moment [A m^2].
enum class FieldCommand {
  flux_density,
  flux_density_x,
  flux_density_y,
  flux_density_z,
  current,
  position_x,
  position_y,
  position_z,
  moment_x,
  moment_y,
  moment_z
};
/// Returns 0 to 2 for a command along an axis; -1 for the others.
[[nodiscard]] int axis_of(FieldCommand command);
[[nodiscard]] bool places_dipole(FieldCommand command);

/// A uniform field.
struct UniformField {
  Vec3 direction{0, 0, 1};  // that flux_density is along; of unit length once compiled
};

/// A circular loop of wire; its current flows about the axis by the right-hand rule.
struct CoilLoop {
  Vec3 center{0, 0, 0};  // [mm]
  Vec3 axis{0, 0, 1};    // of unit length once compiled
  double radius_mm = 1;  // > 0
  double turns = 1;      // not 0; < 0: wound in the opposite sense
};
struct CoilField {              // loops of wire through which one current goes
  std::vector<CoilLoop> loops;  // whose fields add up
};

/// Flux density per ampere at the points of a regular grid, x fastest, then y.
struct GridField {
  std::string file;                  // for messages
  Vec3 low{0, 0, 0}, step{1, 1, 1};  // first point and spacing [mm]
  std::array<Index, 3> counts{};     // of points along each axis, >= 4
  std::vector<Vec3> per_ampere;      // [mT / A]
  [[nodiscard]] Vec3 high() const;   // last point [mm]
};

/// A point dipole, with its position and moment without a command.
struct DipoleField {
  Vec3 position{0, 0, 0};  // [mm]
  Vec3 moment{0, 0, 0};    // [A m^2]
};

/// An applied magnetic field. The robot does not act back on it.
struct FieldSource {
  std::string name;                                                     // for messages and names of commands
  std::variant<UniformField, CoilField, GridField, DipoleField> field;  // what it is in space
};

/// The magnetisation of a compiled robot, and the fields that act on it.
struct Magnetism {
  std::vector<Vec3> remanence;               // of every tetrahedron, then prism, of the model [mT]
  std::vector<Magnetisation> magnetisation;  // the same
  std::vector<FieldSource> sources;          // by MagneticDrive::source
};

}  // namespace softkin
