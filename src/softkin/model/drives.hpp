#pragma once

#include <optional>
#include <softkin/model/filling.hpp>
#include <softkin/model/marker.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <variant>

namespace softkin {

enum class FieldCommand;  // magnetic_field.hpp

/// A triangle of a cavity's boundary. Order 2: the nodes on its edges 01, 12, 20 too.
struct CavityFace {
  Triangle corners;                        // vertices: counterclockwise seen from where the normal points
  std::array<Index, 3> edges{-1, -1, -1};  // nodes on the edges 01, 12, 20; -1: order 1
};

/// A free segment of a cable between two points of the body, and the body's point across it: the triangle
/// (points[segment], points[segment + 1], apex) is the actuation element of Eq. (6).
struct CableGap {
  Index segment = 0;   // of the cable, from 0
  EmbeddedPoint apex;  // the body's point across it
};

/// A cable, pulled at its first point.
struct CableDrive {
  std::vector<EmbeddedPoint> points{};  // along it
  std::vector<CableGap> gaps{};         // target-shape
  bool pushes = false;                  // keeps its length under tension and compression, as a rod
  double friction = 0, sheath = 0;      // physical: where it turns; of its sheath, times the sheath's turns [-]
};

/// One of several chambers with a common filling: the faces of ChamberDrive::cavity from the end of the chamber before
/// it to before `end`.
struct ConnectedChamber {
  std::string region;  // as the description names it
  Index end = 0;       // in ChamberDrive::cavity
};

/// A face of a chamber's boundary where a support closes the chamber: no material of the robot lies behind it, and the
/// vertices that carry it are held against its normal. The pressure in the chamber acts on the support there, not on
/// the robot.
struct ChamberCap {
  Index face = -1;     // index into ChamberDrive::cavity, or into its surface where it has one
  Index support = -1;  // index into Held::supports: the support that closes the chamber there; -1: none
};

/// A chamber, or several that are connected: by its elements, by its boundary, or by a surface that the body carries.
struct ChamberDrive {
  std::vector<Index> tetrahedra{};            // target-shape: elements of Model
  std::vector<CavityFace> cavity{};           // physical: its boundary, normals out of the chamber
  std::vector<EmbeddedPoint> points{};        // of its surface
  std::vector<Triangle> surface{};            // triangles over `points`
  std::optional<Filling> filling{};           // physical: of control filling
  std::vector<ConnectedChamber> connected{};  // physical: of several
  bool flat = false;                          // encloses no volume at rest, as an empty bag
  std::vector<ChamberCap> caps{};             // physical: where supports close it
};

/// A layer of a dielectric elastomer.
struct DeaDrive {
  std::vector<Index> prisms{};      // elements of Model
  std::vector<double> fractions{};  // under voltage: fraction of it at each of them [-]
  double prestretch = 1;            // the same: area of the layer without force, over that in the mesh [-]
};

/// One of the commands of a magnetic field.
struct MagneticDrive {
  Index source = -1;       // index into Magnetism::sources
  FieldCommand command{};  // which of the source's
};

/// Elements that grow.
struct GrowthDrive {
  Index growth = -1;  // index into Model::growths
};

/// The motion of an obstacle along an axis.
struct MotionCommand {
  Index part = -1;  // of ContactModel
  int axis = 0;     // along which it moves
};

/// A force along an axis: on a body, or at a place of the robot.
struct ForceCommand {
  Index body = -1;                       // index into Model::bodies; -1: at a place of the robot
  int axis = 0;                          // along which it acts
  std::optional<EmbeddedPoint> place{};  // of the robot
  std::vector<CavityFace> faces{};       // of the region over which it is spread; empty: at a point
};

/// The degree to which a body is held.
struct HoldCommand {
  Index body = -1;  // index into Model::bodies
};

/// The angle by which a support turns what it holds.
struct TurnCommand {
  Index turn = -1;  // index into Held::turns
};

/// A moment on a rigid region, about an axis.
struct MomentCommand {
  Index moment = -1;  // index into Loads::moments
  int axis = 0;       // about which it turns
};

/// The pressure of a traction.
struct PressureCommand {
  Index traction = -1;  // index into Loads::tractions
};

/// The kind of an actuator. The last six are not drives of the robot but loads and motions that are imposed on it and
/// its surroundings.
using Drive = std::variant<CableDrive, DeaDrive, ChamberDrive, MagneticDrive, GrowthDrive, MotionCommand, ForceCommand,
                           HoldCommand, TurnCommand, MomentCommand, PressureCommand>;

/// Names and units of a kind of actuator, for messages and tables; every kind has its own.
struct DriveTraits {
  const char* kind;          // its name
  bool drives = false;       // is it of the robot
  const char* measure = "";  // of which its command is a ratio: "length", "area" or "volume"
  const char* load = "";     // that is commanded under load control
  const char* unit = "";     // of that
};
/// The traits of a kind.
template <class Kind>
inline constexpr DriveTraits traits_of = Kind::has_no_traits;  // no kind is without
template <>
inline constexpr DriveTraits traits_of<CableDrive>{"cable", true, "length", "tension", "N"};
template <>
inline constexpr DriveTraits traits_of<DeaDrive>{"dea", true, "area", "voltage", "kV"};
template <>
inline constexpr DriveTraits traits_of<ChamberDrive>{"pneumatic", true, "volume", "pressure", "kPa"};
template <>
inline constexpr DriveTraits traits_of<MagneticDrive>{"magnetic", true};  // the rest depends on its source
template <>
inline constexpr DriveTraits traits_of<GrowthDrive>{"growth", true, "", "temperature", "degC"};
template <>
inline constexpr DriveTraits traits_of<MotionCommand>{"motion", false, "", "motion", "mm"};
template <>
inline constexpr DriveTraits traits_of<ForceCommand>{"force", false, "", "force", "N"};
template <>
inline constexpr DriveTraits traits_of<HoldCommand>{"hold", false, "", "hold", ""};
template <>
inline constexpr DriveTraits traits_of<TurnCommand>{"turn", false, "", "turn", "deg"};
template <>
inline constexpr DriveTraits traits_of<MomentCommand>{"moment", false, "", "moment", "N mm"};
template <>
inline constexpr DriveTraits traits_of<PressureCommand>{"pressure", false, "", "pressure", "kPa"};

/// Returns the traits of the kind of a drive.
[[nodiscard]] inline const DriveTraits& traits(const Drive& drive) {
  return std::visit([]<class Kind>(const Kind&) -> const DriveTraits& { return traits_of<Kind>; }, drive);
}

}  // namespace softkin
