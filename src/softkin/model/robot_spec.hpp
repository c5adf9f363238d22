#pragma once

#include <memory>
#include <optional>
#include <softkin/core/elastic_law.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/actuator_curve.hpp>
#include <softkin/model/contact_spec.hpp>
#include <softkin/model/mesh/curve_spec.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/model/shapes.hpp>
#include <variant>

namespace softkin {

struct FieldSpec;      // magnetic_field.hpp
struct RemanenceSpec;  // the same
struct GrowthSpec;     // growth.hpp
struct FamiliesSpec;   // families.hpp
struct LayerSpec;      // layer.hpp
struct SensorSpec;     // sensor.hpp

// Selectors choose vertices (inside or on the boundary) and elements (centroid inside); shapes are in mm.
struct VertexList {
  std::vector<Index> vertices;  // from 0
};
struct ElementList {              // of the mesh
  std::vector<Index> tetrahedra;  // from 0
};
/// What a selector chose of a robot before joined() placed it among others.
struct Chosen {
  std::string kind;  // for messages: "box of robot 'left'"
  Region region;     // what was chosen, in the numbers of the robot's own mesh
};
using Selector = std::variant<Box, Sphere, Cylinder, Halfspace, VertexList, ElementList, Chosen>;  // how to choose

/// A region by name, or a shape in its place.
struct RegionRef {
  std::variant<std::string, Selector> region;  // its name, or how to choose it
  Origin origin;                               // of the entry, for messages
};

/// A point by coordinates [mm], or the mean of a region (volume- or area-weighted) by its name.
struct PointRef {
  std::variant<Vec3, std::string> point;  // where it is, or the region's name
  Origin origin;                          // of the entry, for messages
  std::string robot{};                    // of several: whose elements carry the coordinates along; empty: the nearest
};

/// A region that the description adds to those of the mesh.
struct RegionSpec {
  std::string name;   // must not be one of the mesh's
  Selector selector;  // what belongs to it
  Origin origin;      // of its entry, for messages
};

/// By which equations: shapes of least change to given lengths, areas and volumes, Fang et al. 2020, without forces; or
/// balance of forces of elastic bodies.
enum class Formulation { target_shape, physical };

/// What an element's energy, Eq. (2), is multiplied by beside w. printed: its volume, so that it grows with the square
/// of the element's size, too; mesh_independent: its volume over that square. Target shapes.
enum class ElementWeights { printed, mesh_independent };

/// Elastic constants as the user gives them: E and nu for the first three laws; the law's own c10, ... for the others,
/// with the bulk modulus, or nu in its place (bulk from the small-strain shear modulus, such as 2 (c10 + c01)).
struct ElasticSpec {
  Law law = Law::neo_hookean;                // which of what follows is read depends on it
  std::optional<double> youngs_modulus;      // [MPa], > 0
  std::optional<double> poisson_ratio;       // [-], -1 < nu <= 0.5; 0.5: of laws with a bulk part
  std::optional<double> c10, c01, c20, c30;  // [MPa]
  std::optional<double> bulk_modulus;        // [MPa], > 0
  std::optional<double> shear_modulus;       // [MPa], > 0; gent
  std::optional<double> jm;                  // limit of bar I1 - 3 [-], > 0; gent
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
  Origin origin;                                 // of its entry, for messages
};

/// How what is held is turned: counterclockwise seen against the axis, before it is displaced.
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

/// By what an actuator moves the robot.
enum class ActuatorKind { cable, dea, pneumatic, magnetic, growth };

/// What the user commands: length, area or volume over that at rest [-]; or the load, tension [N] or gauge pressure
/// [kPa], voltage of a dea [kV], or what a magnetic field is commanded by; or what fills a sealed chamber [mL].
enum class Control { ratio, load, filling };

/// What is sealed in a chamber as the user describes it.
struct FillingSpec {
  bool liquid = false;               // else a gas
  double exponent = 1;               // gas: n of p V^n = const, > 0
  double compressibility = 0;        // liquid [1/MPa], >= 0
  double dead_mL = 0;                // tubes and fittings, >= 0
  std::optional<double> syringe_mL;  // before it pushes, > 0; then what it has pushed is commanded, else the amount
  double atmosphere_kPa = 101.325;   // absolute, > 0
};

/// How a target-shape actuator's elements share what its command asks for, a_i being the ratio of element i, u_i its
/// measure at rest, and sum a_i u_i = a U, Eqs. (6)-(8). least_norm: the change of the current ratios whose norm is
/// least; uniform: the same ratio for all; proportional: a_i in proportion to the current ratios.
enum class Distribution { least_norm, uniform, proportional };

/// A number for some prisms of the mesh.
struct PrismValues {
  std::vector<Index> prisms;    // from 0
  std::vector<double> values;   // of each of them
  std::vector<Origin> origins;  // of each
};

/// An actuator as the user describes it, or what is done to a robot by command. What does not apply is empty.
struct ActuatorSpec {
  std::string name;                             // for commands, messages and columns of tables
  ActuatorKind kind = ActuatorKind::pneumatic;  // what it is
  std::optional<std::string> region;            // dea, pneumatic: the volume region of its elements
  std::optional<TriangleSurface> surface;       // pneumatic: cavity surface instead of a region [mm]
  std::optional<std::string> wall;              // pneumatic: region of faces around the cavity, instead of either
  std::vector<std::string> connected;  // pneumatic, physical: instead of these, two regions or more, of elements or
                                       // of faces: chambers that share what fills them
  std::optional<FillingSpec> filling;  // of control filling
  std::string robot;                   // of several: whose elements, gaps and empty spaces count; empty: all
  std::vector<PointRef> points;        // cable: at least two, in order
  std::vector<PointRef> apexes;        // cable: third corner of each gap's triangle; none: found by compile()
  double spacing = 0;                  // cable: how often it is guided inside the body [mm]; 0: at its points
  double friction = 0;                 // cable: Coulomb's, where it turns, >= 0; pulled at its first point; physical
  double sheath_friction = 0, sheath_turns_degrees = 0;  // the same of a sheath before that
  Control control = Control::ratio;                      // others: physical formulation
  double low = 0, high = 0;       // range [-]: 0 < low <= high; tension [N], voltage [kV]: 0 <= low;
                                  // pressure [kPa]: any; filling [mL]: 0 < low, pushed: any
  double rest = 1;                // value where none is asked for: a dea's prestretch; load control: 0; filling: found
                                  // by compile(); else 1
  double factor = 1, offset = 0;  // tension and pressure: of a command, what acts is this times it plus that
                                  // [N, kPa]; factor > 0
  double backlash = 0;            // the same: by how much a command falls before what acts does [N, kPa], >= 0
  double prestretch = 1;          // dea under voltage: area that its layer has without force, over that in the
                                  // mesh [-], > 0
  double weight = 5;              // w of Eq. (9), > 0
  Distribution distribution = Distribution::least_norm;  // of what is commanded over its elements; target-shape
  std::optional<ActuatorCurve> curve;        // pneumatic and dea under ratio control: ratio by pressure or voltage
  Branch branch = Branch::loading;           // of the curve, where a command names none
  std::shared_ptr<const FieldSpec> field;    // magnetic
  std::shared_ptr<const GrowthSpec> growth;  // of kind growth
  std::optional<PrismValues> shares;  // dea under voltage: the share of it that each prism has [-]; none: all of it
  Origin origin;                      // of its entry, for messages
};

/// With neither of the last two it moves with the element around it, or is the mean of its region.
struct MarkerSpec {
  std::string name;                      // for messages and columns of tables
  PointRef at;                           // where it is
  std::optional<Vec3> offset{};          // from the mean of its region, on a stem that turns with it [mm]
  std::optional<std::string> carrier{};  // of a point: the region on which its stem stands
};

/// A foot that stands on the floor: a marker, and the friction that it takes to slide it towards the front foot's side
/// (forward) and the other way.
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
  bool left_handed = false;  // else it turns as a common screw does
};

/// A thread in the body or on it, which elements carry along wherever it runs.
struct FibreSpec {
  std::string name;                            // for messages and reports
  std::variant<std::vector<Vec3>, Helix> way;  // corners [mm], at least two
  std::optional<double> stiffness_N;           // E A, > 0; none: it does not stretch
  bool tension_only = false;                   // slack where it would be pressed
  std::optional<std::string> region;           // whose elements alone carry it; none: all
  std::string robot{};                         // of several: whose elements; empty: all
  Origin origin{};                             // of its entry, for messages
};

/// One of several robots that are described as one.
struct RobotPart {
  std::string name;   // for messages; names of its regions, markers and so on begin with it
  std::string scene;  // file
  Index vertices = 0, tetrahedra = 0, prisms = 0;  // where its own begin in the mesh
  Origin mesh_origin;                              // of the entry that names its mesh
  bool accept_mesh_errors = false;                 // as of RobotSpec
};

/// A robot as the user describes it: plain data, lengths in mm. compile() turns it into a Model.
struct RobotSpec {
  std::string name;                                     // the scene's file name, for messages
  Formulation formulation = Formulation::target_shape;  // by which equations it is solved
  ElementWeights weights = ElementWeights::printed;     // target-shape
  Mesh mesh;                                            // in mm
  Origin mesh_origin;                                   // of the entry that names it
  bool accept_mesh_errors = false;                      // take doubled or overlapping elements, with a note
  bool quadratic = false;                               // physical: elevate a mesh of order 1 to order 2
  std::optional<CurveSpec> curve;       // physical, order 2: how the edges are curved; none: as the mesh has them
  bool curved = false;                  // of several robots: one was, by a `curve` of its own
  std::vector<std::string> notes;       // of what was done before compile()
  bool linear_by_choice = false;        // it was said that the mesh stays of order 1: what that costs is told as a note
  Vec3 gravity{0, 0, 0};                // [m/s^2]; physical
  Origin gravity_origin;                // no file: none is given
  std::vector<ForceSpec> forces;        // physical
  std::vector<TractionSpec> tractions;  // physical
  std::vector<FibreSpec> fibres;        // physical
  std::vector<std::shared_ptr<const LayerSpec>> layers;    // physical
  std::optional<LiquidAroundSpec> liquid_around;           // physical; none: nothing but the atmosphere
  std::vector<RegionSpec> regions;                         // beside those of the mesh
  std::vector<MaterialSpec> materials;                     // later ones count where they overlap
  std::vector<RegionRef> voids;                            // volumes without material
  std::vector<FixedSpec> fixed;                            // what is held, in the order of Model::supports
  std::vector<RigidSpec> rigid;                            // what moves as one body
  std::vector<ActuatorSpec> actuators;                     // in the order of commands
  std::vector<MarkerSpec> markers;                         // points that are watched
  std::vector<std::shared_ptr<const SensorSpec>> sensors;  // what measures lengths, angles and directions
  std::vector<FootSpec> feet;                              // none, or the rear one and the front one
  std::optional<ContactSpec> contact;                      // physical; none: everything passes through everything
  std::vector<RobotPart> robots;  // none, or those that joined() made this of, in the mesh's order
};

}  // namespace softkin
