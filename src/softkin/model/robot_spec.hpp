#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <softkin/core/elastic_law.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/actuator_spec.hpp>
#include <softkin/model/contact_spec.hpp>
#include <softkin/model/mesh/curve_spec.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/shapes.hpp>
#include <variant>

namespace softkin {

struct RemanenceSpec;  // magnetic_field.hpp
struct FamiliesSpec;   // families.hpp
struct LayerSpec;      // layer.hpp
struct SensorSpec;     // sensor.hpp
struct NamedMaterial;  // named_material.hpp

/// A region that the description adds to those of the mesh.
struct RegionSpec {
  std::string name;   // must not be one of the mesh's
  Selector selector;  // what belongs to it
  Origin origin;      // of its entry, for messages
};

/// The equations that determine a shape. target_shape: the least change of shape under given lengths, areas and
/// volumes, Fang et al. 2020, without forces; physical: equilibrium of forces in elastic bodies.
enum class Formulation { target_shape, physical };

/// The factor of an element's energy, Eq. (2), in addition to w. printed: its volume, so that the energy also grows
/// with the square of the element's size; mesh_independent: its volume over that square. Target shapes.
enum class ElementWeights { printed, mesh_independent };

/// Elastic constants as the user gives them: E and nu for the first three laws; the law's own c10, ... for the others,
/// with the bulk modulus, or nu in its place (bulk from the small-strain shear modulus, such as 2 (c10 + c01)).
struct ElasticSpec {
  Law law = Law::neo_hookean;                // determines which of the following constants are read
  std::optional<double> youngs_modulus;      // [MPa], > 0
  std::optional<double> poisson_ratio;       // [-], -1 < nu <= 0.5; 0.5: of laws with a bulk part
  std::optional<double> c10, c01, c20, c30;  // [MPa]
  std::optional<double> bulk_modulus;        // [MPa], > 0
  std::optional<double> shear_modulus;       // [MPa], > 0; gent
  std::optional<double> jm;                  // limit of bar I1 - 3 [-], > 0; gent
  std::vector<OgdenTerm> ogden;              // terms, at most max_ogden_terms; ogden
};

/// A Maxwell element beside the elastic law: a spring and a damper in series.
struct ViscousBranch {
  double modulus_MPa = 0;  // shear modulus of the spring, > 0
  double time_s = 0;       // relaxation time, > 0
};

/// Later entries override earlier ones where their regions overlap. The region "all" is every element.
struct MaterialSpec {
  std::string region;                     // of volume; "all": every element
  std::optional<double> shape_ratio = 1;  // target-shape: R_omega, 0 <= shape_ratio <= 1; none: the scene has none
  double weight = 1;                      // target-shape: w of Eq. (9), > 0
  std::optional<ElasticSpec> elastic;     // physical
  std::vector<ViscousBranch> viscosity;   // physical
  std::optional<double> permittivity;     // over that of the vacuum [-], >= 1; physical, of a dea under voltage
  std::shared_ptr<const RemanenceSpec> remanence;  // physical; none: not magnetic
  double density = 0;                              // [kg/m^3], >= 0; physical with gravity
  std::optional<double> linear_range;              // largest |principal strain| of the linear range [-], > 0
  std::optional<bool> mixed;  // elements with pressures as unknowns; physical; none: where the volume is kept
  std::shared_ptr<const FamiliesSpec> families;  // of fibres in the material; physical; none: isotropic
  std::shared_ptr<const NamedMaterial> named;    // whose constants `elastic` has; none: the user's own
  Origin origin;                                 // of its entry, for messages
};

/// The rotation of held vertices: counterclockwise seen against the axis, before the displacement.
struct RotationSpec {
  Vec3 axis{0, 0, 1};           // not 0
  double degrees = 0;           // where no command says another angle
  std::optional<Vec3> about{};  // a point of the axis at rest [mm]; none: the mean of the vertices that are held
};

/// Holds vertices where they are at rest, or where they are moved to.
struct FixedSpec {
  RegionRef where;                             // the vertices
  std::array<bool, 3> axes{true, true, true};  // along which it holds them: x, y, z
  Vec3 displacement{0, 0, 0};  // where it is held, from its place at rest [mm]; 0 along axes that are not held
  std::string name{};          // of the support; empty: its region's, or fixed_N
  std::optional<RotationSpec> rotation{};  // turned about an axis besides; none: not
};

/// With neither of the last two it moves with the element around it, or is the mean of its region.
struct MarkerSpec {
  std::string name;                      // for messages and columns of tables
  PointRef at;                           // where it is
  std::optional<Vec3> offset{};          // from the mean of its region, on a stem that turns with it [mm]
  std::optional<std::string> carrier{};  // of a point: the region on which its stem stands
};

/// A foot that stands on the floor: a marker, and the friction forces against sliding towards the front foot's side
/// (forward) and in the opposite direction (backward).
struct FootSpec {
  std::string marker;                // its name
  double forward = 0, backward = 0;  // [N], >= 0
  Origin origin;                     // of its entry, for messages
};

/// Vertices that move as one rigid body.
struct RigidSpec {
  RegionRef where;   // the vertices
  std::string name;  // for messages
};

/// A dead load, spread over a region or at a point; on a rigid region with a moment, which keeps its direction, too.
struct ForceSpec {
  std::string name;                                   // of the command too, where it has a range
  PointRef at;                                        // where it acts
  Vec3 force{0, 0, 0};                                // [N]; where it is commanded: where no command says another
  std::optional<std::array<Vec3, 2>> range{};         // commanded, within these along each axis [N]; none: it is not
  Vec3 moment{0, 0, 0};                               // [N mm]; the same
  std::optional<std::array<Vec3, 2>> moment_range{};  // as range, of the moment [N mm]
};

/// A load on each piece of the body's surface in a region, over its area.
struct TractionSpec {
  std::string name;           // of the command too, where it has a range
  RegionRef where;            // of dimension 2: its faces; else all faces of the surface between its vertices
  bool follows = false;       // turns with the surface and acts on its present area; else neither, on its area at rest
  Vec3 kilopascals{0, 0, 0};  // as the surface stands at rest [kPa]
  double pressure_kPa = 0;    // where it follows: onto the surface, along its normal [kPa]
  std::optional<std::array<double, 2>> range_kPa{};  // of a pressure that is commanded; pressure_kPa where none is
};

/// A liquid around the robot, at rest: it presses on the outer surface by its depth below a level.
struct LiquidAroundSpec {
  double density = 1000;  // [kg/m^3], > 0
  Vec3 surface{0, 0, 0};  // a point of its level, which stands across gravity [mm]
  Origin origin;          // of its entry, for messages
};

/// A thread wound about an axis at a constant pitch.
struct Helix {
  Vec3 start, axis;          // a point of the axis, level with where the thread begins [mm]; direction, not 0
  Vec3 first;                // from there to where it begins, a direction that is not along the axis
  double radius = 0;         // [mm], > 0
  double pitch = 0;          // along the axis, per turn [mm], >= 0; 0: a ring
  double turns = 0;          // > 0
  bool left_handed = false;  // else right-handed, as a common screw
};

/// A thread in the body or on it, which moves with the elements along it.
struct FibreSpec {
  std::string name;                             // for messages and reports
  std::variant<std::vector<Vec3>, Helix> path;  // corners [mm], at least two
  std::optional<double> stiffness_N;            // E A, > 0; none: it does not stretch
  bool tension_only = false;                    // slack where it would be compressed
  std::optional<std::string> region;            // whose elements alone carry it; none: all
  std::string robot{};                          // of several: whose elements; empty: all
  Origin origin{};                              // of its entry, for messages
};

/// One of several robots that are described as one.
struct RobotPart {
  std::string name;   // for messages; names of its regions, markers and so on begin with it
  std::string scene;  // file
  Index vertices = 0, tetrahedra = 0, prisms = 0;  // where its own begin in the mesh
  Origin mesh_origin;                              // of the entry that names its mesh
  bool accept_mesh_errors = false;                 // as of RobotSpec
};

/// How a mesh is read.
struct MeshOptions {
  Origin origin;                   // of the entry that names it
  bool accept_errors = false;      // take doubled or overlapping elements, with a note
  bool quadratic = false;          // physical: elevate a mesh of order 1 to order 2
  std::optional<CurveSpec> curve;  // physical, order 2: how the edges are curved; none: as the mesh has them
  bool curved = false;             // of several robots: one was, by a `curve` of its own
  bool linear_by_choice = false;   // the scene requests order 1: the resulting error is a note, not a warning
};

/// The loads on a robot besides those of its actuators; physical.
struct LoadsSpec {
  Vec3 gravity{0, 0, 0};                            // [m/s^2]
  Origin gravity_origin{};                          // no file: none is given
  std::vector<ForceSpec> forces{};                  // on points
  std::vector<TractionSpec> tractions{};            // on faces
  std::optional<LiquidAroundSpec> liquid_around{};  // none: the atmosphere alone

  /// Does any act before it is commanded?
  [[nodiscard]] bool any() const {
    const auto acts = [](const ForceSpec& f) { return f.force != Vec3(0, 0, 0) || f.moment != Vec3(0, 0, 0); };
    return gravity != Vec3(0, 0, 0) || !tractions.empty() || liquid_around ||
           std::any_of(forces.begin(), forces.end(), acts);
  }
};

/// A robot as the user describes it: plain data, lengths in mm. compile() turns it into a Model.
struct RobotSpec {
  std::string name;                                        // the scene's file name, for messages
  Formulation formulation = Formulation::target_shape;     // by which equations it is solved
  ElementWeights weights = ElementWeights::printed;        // target-shape
  Mesh mesh;                                               // in mm
  MeshOptions mesh_options;                                // how it is read
  std::vector<std::string> notes;                          // of what was done before compile()
  LoadsSpec loads;                                         // beside those of actuators
  std::vector<FibreSpec> fibres;                           // physical
  std::vector<std::shared_ptr<const LayerSpec>> layers;    // physical
  std::vector<RegionSpec> regions;                         // beside those of the mesh
  std::vector<MaterialSpec> materials;                     // later ones count where they overlap
  std::vector<RegionRef> voids;                            // volumes without material
  std::vector<FixedSpec> fixed;                            // held vertices, in the order of Held::supports
  std::vector<RigidSpec> rigid;                            // regions that move as one body
  std::vector<ActuatorSpec> actuators;                     // in the order of commands
  std::vector<MarkerSpec> markers;                         // points whose positions are reported
  std::vector<std::shared_ptr<const SensorSpec>> sensors;  // of lengths, angles and directions
  std::vector<FootSpec> feet;                              // none, or the rear one and the front one
  std::optional<ContactSpec> contact;                      // physical; none: surfaces pass through each other
  std::vector<RobotPart> robots;  // none, or those that joined() made this of, in the mesh's order
};

}  // namespace softkin
