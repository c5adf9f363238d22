#pragma once

#include <softkin/model/contact_model.hpp>
#include <softkin/model/drives.hpp>
#include <softkin/model/robot_spec.hpp>
#include <string>

namespace softkin {

struct Magnetism;  // magnetic_field.hpp
struct Growth;     // growth.hpp
struct Families;   // families.hpp
struct Layer;      // layer.hpp
struct Sensor;     // sensor.hpp

/// A compiled material.
struct Material {
  std::string region;                          // as the description names it
  double shape_ratio = 1;                      // target-shape
  double weight = 1;                           // target-shape
  ElasticLaw elastic;                          // physical
  std::vector<ViscousBranch> viscosity;        // Maxwell branches beside the elastic law; none: elastic; physical
  double permittivity = 1;                     // over that of the vacuum [-]
  double density = 0;                          // [kg/m^3]
  std::optional<double> linear_range;          // largest |principal strain| of the linear range [-]; none: not stated
  bool mixed = false;                          // elements with pressures as unknowns; physical
  std::shared_ptr<const Families> families;    // physical; none: isotropic
  std::shared_ptr<const NamedMaterial> named;  // of the table, whose constants it has; none: the user's own
};

/// The nodes of a face: its corners, then those on its edges.
[[nodiscard]] std::vector<Index> nodes_of(const CavityFace& face);

/// Volume enclosed by a cavity's boundary whose normals point out of it, exact for curved faces too.
///
/// positions  #V by 3 [mm]
/// returns    sum over the faces of 1/3 of the integral of x . (dx/du x dx/dv) over the reference triangle [mm^3];
///            0 without faces; linear or quadratic faces by whether their edges are given
/// source     divergence theorem; the integrand is of degree 4 on a quadratic face, the rule is exact for degree 4
[[nodiscard]] double enclosed_volume(const Points& positions, const std::vector<CavityFace>& faces);

/// A compiled actuator, or an imposed load or motion with a command. Members that do not apply are empty.
struct Actuator {
  std::string name;                  // for commands, messages and columns of tables
  Drive drive;                       // its kind, with the data of that kind
  Control control = Control::ratio;  // which quantity is commanded
  double low = 0, high = 0, rest = 1,
         weight = 5;  // ends of the commands' range and command at rest, in its unit; w of Eq. (9)
  Distribution distribution = Distribution::minimum_norm;  // of the command over its elements; target-shape
  std::optional<ActuatorCurve> curve;                      // ratio by pressure or voltage
  Branch branch = Branch::loading;                         // of the curve, where a command names none
  double factor = 1, offset = 0;  // load control: the acting value is factor times the command plus offset [N, kPa]
  double backlash = 0;            // the same: by how much a command falls before the acting value does, see acting()
  double rest_measure = 0;        // length [mm], mean area of top and bottom [mm^2] or volume [mm^3] at rest; at
                                  // a dea's ratio 1; where a chamber is flat 1 mL

  /// Is it of a kind.
  template <class Kind>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<Kind>(drive);
  }
  /// What it is as one of a kind; null: it is of another.
  template <class Kind>
  [[nodiscard]] const Kind* as() const {
    return std::get_if<Kind>(&drive);
  }
};

/// A foot that stands on the floor and slides where friction is exceeded.
struct Foot {
  Index marker = -1;                 // of Model::markers
  double forward = 0, backward = 0;  // friction that slides it in the direction of travel and against it [N]
};

/// Vertices that move as one rigid body.
struct RigidRegion {
  std::string name;             // for messages; may be empty
  std::vector<Index> vertices;  // ascending
};

/// A rigid body without elements, which moves freely apart from holds and contacts.
struct FreeBody {
  std::string name;             // for messages, reports and commands
  std::vector<Index> vertices;  // of its surface, in Model::rest
  EmbeddedPoint center;         // of mass
  double mass_kg = 0;           // of its density and volume
};

/// A support, which holds vertices at prescribed places: an entry of the description's `fixed`.
struct Support {
  std::string name;             // of its region, or fixed_N
  std::vector<Index> vertices;  // that it holds along one axis at least
};

/// The commanded rotation of a support: a vertex at x at rest is held at about + R(angle) (x - about) + displacement,
/// with R counterclockwise seen against the axis.
struct SupportTurn {
  std::string support;          // its name
  Vec3 axis{0, 0, 1};           // of length 1
  Vec3 about{0, 0, 0};          // a point of the axis [mm]
  Vec3 displacement{0, 0, 0};   // [mm]
  std::vector<Index> vertices;  // ascending; all of a rigid region that it holds
  double degrees = 0;           // where no command says another angle
  Origin origin;                // of its entry, for messages
};

/// A moment on a rigid region, which keeps its direction: couples of forces on some of its vertices.
struct RegionMoment {
  std::vector<Index> vertices;  // three or four, not on a line
  Vec3 moment_Nmm{0, 0, 0};     // in addition to the commanded one
};

/// A face of the body's surface under a load, or under a fraction of it.
struct LoadedFace {
  CavityFace face;      // vertices, normal outwards
  double fraction = 1;  // of the load, from 0 to 1 [-]
};

/// A load that turns with the surface and acts on its present area.
struct FollowingTraction {
  Vec3 traction_MPa{0, 0, 0};     // as the surface stands at rest
  double pressure_MPa = 0;        // onto it, along its normal, in addition to the commanded one
  std::vector<LoadedFace> faces;  // that it acts on
  Vec3 deeper_MPa_mm{0, 0, 0};    // gradient of the pressure of a liquid around the robot below its level; 0: none
  Vec3 level_mm{0, 0, 0};         // a point of that level, above which there is no pressure
};

/// A quadrature point of a thread, with the length that it represents.
struct FibrePlace {
  std::vector<Index> vertices;  // of the element that carries it along
  std::vector<double> weights;  // of them: where it is
  std::vector<double> slopes;   // by its length [1/mm]: stretch = |sum of slope x|
  double length_mm = 0;         // at rest
};

/// A thread in the body or on it: per length its energy is E A / 2 (stretch - 1)^2, and nothing below a stretch of 1
/// where it takes tension only.
struct Fibre {
  std::string name;                  // for messages and reports
  double stiffness_N = 0;            // E A
  bool tension_only = false;         // does it carry no compression
  std::vector<FibrePlace> places;    // along it
  std::vector<EmbeddedPoint> knots;  // along it, for pictures
};

/// The material of an element, or the actuator to which it belongs; physical: always a material, and for a prism of a
/// dea its actuator too.
struct ElementRole {
  Index material = -1;  // index into Elements::materials, or -1
  Index actuator = -1;  // index into Model::actuators, or -1
  Index region = -1;    // index into Elements::region_names, for output
};

/// The elements of a robot, with their materials and regions.
struct Elements {
  std::vector<Tetrahedron> tetrahedra;  // without void elements (physical: nor those of chambers); positive volume
  std::vector<EdgeNodes> edge_nodes;    // order 2: of every tetrahedron; order 1: empty
  std::vector<Prism> prisms;            // without void elements; positive volume
  std::vector<ElementRole> tetrahedron_roles, prism_roles;  // in the order of the elements
  std::vector<double> tetrahedron_volumes, prism_volumes;   // at rest [mm^3]
  std::vector<std::string> region_names;                    // of volume, that output distinguishes
  std::vector<Material> materials;                          // by ElementRole::material
  std::vector<bool> used;                                   // per vertex: is it a vertex of an element
};

/// The supports of a robot.
struct Held {
  std::vector<std::array<bool, 3>> fixed;        // per vertex and axis; vertices of no element are fixed
  Points at;                                     // #V by 3 [mm]: where fixed axes are held; else rest
  std::vector<Support> supports;                 // in the order of the description's `fixed`
  std::vector<SupportTurn> turns;                // of supports; their vertices are fixed, `at` is without the turn
  std::vector<std::array<Index, 3>> support_of;  // per vertex and axis: the support that holds it, the first of
                                                 // several, or -1; one support for all of a held rigid region
};

/// The loads on a robot besides those of its actuators; physical.
struct Loads {
  Points dead;                               // #V by 3 [N]: weight, forces, dead tractions; or empty
  std::vector<FollowingTraction> tractions;  // that turn with the surface, and liquids around
  std::vector<RegionMoment> moments;         // on rigid regions

  /// Does any load depend on the shape?
  [[nodiscard]] bool any_by_shape() const { return !tractions.empty() || !moments.empty(); }
  /// Is there any load?
  [[nodiscard]] bool any() const { return !dead.isZero(0) || any_by_shape(); }
};

/// The fibres and layers that stiffen a robot, in the order of the description; physical.
struct Reinforcement {
  std::vector<Fibre> fibres;                         // threads
  std::vector<std::shared_ptr<const Layer>> layers;  // sheets
};

/// A compiled robot: everything that depends on topology and rest shape alone. It is not modified after compile().
struct Model {
  std::string name;                                     // the scene's file name, for messages
  Formulation formulation = Formulation::target_shape;  // by which equations it is solved
  ElementWeights weights = ElementWeights::printed;     // target-shape
  Points rest;                      // #V by 3 [mm], every vertex of the mesh, then those of bodies and obstacles
  Elements elements;                // with what they are made of
  std::vector<Actuator> actuators;  // in the order of commands and loads
  std::vector<Marker> markers;      // in the order of the description
  std::vector<std::shared_ptr<const Sensor>> sensors;  // the same
  std::vector<Foot> feet;                              // none, or the rear one and the front one
  std::vector<RigidRegion> rigid;                      // disjoint; bodies, too
  std::vector<FreeBody> bodies;                        // the same
  Held held;                                           // by supports
  Loads loads;                                         // beside those of actuators
  Reinforcement reinforcement;                         // threads and sheets
  std::vector<std::shared_ptr<const Growth>> growths;  // by GrowthDrive::growth
  ContactModel contact;                                // which surfaces can be in contact
  std::shared_ptr<const Magnetism> magnetism;          // physical; none: nothing is magnetic
  double diagonal_mm = 0;                              // of the bounding box of the used vertices
  std::vector<std::string> notes;                      // changes by compile() and hints for the user, a sentence each
  std::vector<std::string> warnings;                   // probable mistakes, a sentence each: units, elements that lock

  /// Returns the number of vertices of the mesh, which come first.
  [[nodiscard]] Index robot_vertices() const { return static_cast<Index>(rest.rows()) - contact.other_vertices; }

  /// Returns the range of the vertices of a bounded part of its surroundings.
  [[nodiscard]] std::array<Index, 2> vertices_of_part(Index part) const;

  /// Returns the values without a command, in the order of actuators.
  [[nodiscard]] Eigen::VectorXd rest_actuation() const;
};

/// Returns the present volume of each of several connected chambers [mm^3]; empty for a single one.
[[nodiscard]] std::vector<double> connected_volumes(const Actuator& actuator, const Points& positions);

/// Returns the filling of a chamber; null: it is not under filling control.
[[nodiscard]] const Filling* filling_of(const Actuator& actuator);
/// Is it a chamber that encloses no volume at rest?
[[nodiscard]] bool flat_at_rest(const Actuator& actuator);
/// Returns the chambers with a common filling; empty: it is a single one.
[[nodiscard]] const std::vector<ConnectedChamber>& connected_chambers(const Actuator& actuator);

/// Is it an actuator of the robot, which inverse kinematics chooses and a workspace varies?
[[nodiscard]] bool drives(const Actuator& actuator);
/// Is it an external load on the robot that is commanded: a force at a place, a moment or a pressure?
[[nodiscard]] bool loads_robot(const Actuator& actuator);
/// Is it a dea under voltage control, whose load is the field in its layer?
[[nodiscard]] bool under_voltage(const Actuator& actuator);
/// Is it a cable with friction, whose tension changes where it turns?
[[nodiscard]] bool has_friction(const Actuator& actuator);
/// Has the robot any friction, so that its shapes depend on the path to them?
[[nodiscard]] bool has_friction(const Model& model);
/// Is it an actuator of the robot whose range has more than one value?
[[nodiscard]] bool varies(const Actuator& actuator);

/// Checks the meaning of a description and compiles it.
///
/// throws  InvalidInput, naming the origin, on: unknown or empty regions, elements without material or with two
///         actuators, values outside their ranges, a robot with a part that can still move rigidly, DEA regions with
///         tetrahedra, pneumatic regions with prisms, cables of zero length, duplicate names, elements without volume;
///         physical: materials without elastic constants, chambers that do not touch the body, gravity without a
///         density; target-shape: load control, sealed chambers, contact; feet that are not two different markers;
///         contact with unknown or repeated names, obstacles without extent, a distance that is not below a twentieth
///         of the robot's diagonal
[[nodiscard]] Model compile(const RobotSpec& spec);

/// The ratio that an actuator's curve gives for an input: pressure [kPa gauge] or voltage [kV]. Without input it is the
/// actuator's ratio at rest: a dea's prestretch, else 1.
///
/// throws  InvalidInput where the actuator has no curve, or outside the branch
[[nodiscard]] double ratio_by_curve(const Actuator& actuator, double input, Branch branch);

/// Returns the input that gives a ratio, the inverse of ratio_by_curve(); none outside the branch or without a curve.
[[nodiscard]] std::optional<double> input_by_curve(const Actuator& actuator, double ratio, Branch branch);

/// Standard deviation of the ratio between repeated runs near an input [-]; none where it is not known.
[[nodiscard]] std::optional<double> spread_by_curve(const Actuator& actuator, double input, Branch branch);

/// 16 hexadecimal digits that change with anything that a compiled robot's shapes and report depend on, but not with
/// the names of its files. source: FNV-1a, 64 bit
[[nodiscard]] std::string fingerprint_of(const Model& model);

/// The same of a shape, bit by bit.
[[nodiscard]] std::string fingerprint_of(const Points& positions);

}  // namespace softkin
