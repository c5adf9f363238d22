#pragma once

#include <map>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/embedding.hpp>
#include <softkin/model/compile/regions.hpp>
#include <softkin/model/mesh/shells.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

/// What carries points along: elements with a material and those of dielectric elastomers, of all robots or of one.
struct Body {
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Prism> prisms;
  Embedder embedder;
  double diagonal_mm = 0;            // of all of its elements
  std::vector<CavityFace> sheets{};  // of layers without elements
};

/// What compile() knows while it works. Its parts below fill in the model, in this order, and throw InvalidInput.
struct Compilation {
  /// straight  the mesh before its edges were curved: shapes choose among its vertices
  Compilation(const RobotSpec& robot, const Mesh& its_mesh, const Mesh& straight)
      : spec(robot), mesh(its_mesh), origin{.file = robot.name}, regions(robot, straight) {}

  const RobotSpec& spec;
  const Mesh& mesh;  // of the order that the model takes: spec.mesh, or made from it
  Origin origin;     // of what has no line of its own
  RegionTable regions;
  Model model;
  // index in the model of each element of the mesh; -1: void
  std::vector<Index> tetrahedron_at, prism_at;
  // the other way round
  std::vector<Index> tetrahedron_of, prism_of;
  // physical: tetrahedra of pneumatic chambers, oriented as the model's, and what is known of them
  std::vector<Tetrahedron> chamber_tetrahedra;
  std::vector<EdgeNodes> chamber_edge_nodes;
  std::vector<double> chamber_volumes;
  std::vector<ElementRole> chamber_roles;
  std::vector<Index> chamber_at, chamber_of;  // as tetrahedron_at and tetrahedron_of
  // physical: what elements of the body and chambers enclose, found when an actuator first asks, and whose it is
  std::optional<std::vector<EmptySpace>> empty_spaces;
  std::vector<Index> space_actuators;        // -1: no actuator's
  std::vector<Actuator> force_commands;      // of forces, moments and pressures that are commanded
  std::vector<Triangle> sheets;              // physical: faces of layers some vertex of which is of no element
  std::map<std::string, Body> robot_bodies;  // by robot, made when they are first asked for; "": of all
};

/// Which of several robots it is of; 0 where there is one. first: RobotPart's first of what is numbered
[[nodiscard]] Index robot_of(const RobotSpec& spec, Index RobotPart::*first, Index number);

/// ", of robot 'left'" where the description is of several robots, for messages that number a vertex or an element.
///
/// first  RobotPart's first of what is numbered
[[nodiscard]] std::string robot_text(const RobotSpec& spec, Index RobotPart::*first, Index number);

/// Drops void elements, orients the others, measures them and names their regions. Physical: sets the elements of
/// chambers apart.
void compile_elements(Compilation& c);

/// The part of compile_elements() that is about layers without elements: their vertices are used.
void use_sheets(Compilation& c);

/// Refuses elements that are doubled or overlap, as mesh check does, or notes them where the scene accepts them.
void refuse_mesh_errors(Compilation& c);

[[noreturn]] inline void refuse(const ActuatorSpec& spec, const std::string& what) {
  throw InvalidInput(spec.origin, "actuator '" + spec.name + "' " + what);
}

/// Checks names and numbers of the actuators and gives them their elements or the boundary of their chamber.
void compile_actuator_elements(Compilation& c);

/// An actuator's surface as it can be used, normals outwards.
///
/// throws  InvalidInput where it is not closed, or a shell of it lies inside another
[[nodiscard]] TriangleSurface checked_surface(const ActuatorSpec& spec, TriangleSurface surface);
/// Distance from a plane below which a vertex lies in it, over the body's diagonal.
inline constexpr double plane_tolerance = 1e-6;
/// A chamber's wall that is given as faces of the mesh.
struct ChamberWall {
  std::vector<Triangle> triangles;    // of the region, normals out of the chamber
  TriangleSurface closed;             // the same and, where they leave openings in planes that are held, what closes
                                      // them; with vertices of its own after those of the mesh
  std::vector<CavityFace> closing{};  // the same openings closed by faces between vertices of the model; from #V on:
  std::vector<Vec3> corners{};        // corners inside the chamber where three planes meet [mm]
};
/// The wall that is a region; throws as checked_surface.
[[nodiscard]] ChamberWall checked_wall(const Compilation& c, const ActuatorSpec& spec, const std::string& name);
/// The wall of a chamber that ends at plates or planes of symmetry. triangles: of the region, neighbours agree
///
/// throws  InvalidInput where no plane that is held closes the rim
[[nodiscard]] ChamberWall closed_by_planes(const Compilation& c, const ActuatorSpec& spec, const std::string& name,
                                           std::vector<Triangle> triangles);

/// Physical: the boundary of a chamber of an actuator, which is not of several.
///
/// elements  of the chamber, in Compilation::chamber_tetrahedra, where it has a region
void compile_cavity(Compilation& c, const ActuatorSpec& spec, const PneumaticSpec& given,
                    const std::vector<Index>& elements, Actuator& actuator);
/// The same by its surface: the empty space that the surface bounds, else the surface itself, which then is embedded.
void select_cavity(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& given, Actuator& actuator);
/// Embeds the surface of an actuator that has no cavity; physical: cut so finely that it follows the elements.
void embed_surface(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& given, Actuator& actuator);

/// What the elements of the body and of chambers enclose.
[[nodiscard]] const std::vector<EmptySpace>& empty_spaces(Compilation& c);
/// Adds an empty space's boundary to the actuator's cavity. Throws where it is another actuator's.
void take_empty_space(Compilation& c, const ActuatorSpec& spec, std::size_t space, Actuator& actuator);
/// Refuses a chamber that the body's elements fill; notes it where they fill a little of it.
void check_filling(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& surface);

/// After the materials. Physical: what is magnetic, and the sources of the fields that act on it.
void compile_magnetism(Compilation& c);

/// Refuses a growth whose numbers, commands or members make no sense, and one of target shapes.
void check_growth(const ActuatorSpec& spec, const GrowthSpec& growth, Formulation formulation);
/// After the materials. Physical: the elements that actuators let grow, and along which directions.
void compile_growth(Compilation& c);

/// After the growth. Physical: the families of fibres of materials, and their directions.
void compile_families(Compilation& c);

/// Physical, after the supports: refuses chambers that are open.
void check_openings(const Compilation& c);
/// The faces of a cavity that are neither faces of the body's elements nor of layers, as indices into the cavity.
[[nodiscard]] std::vector<Index> open_faces(const Compilation& c, const std::vector<CavityFace>& cavity);
/// Do supports hold the face whose place follows from these vertices, so that a plate or a plane of symmetry may close
/// a chamber there: are all of them held along x, y and z, or all along the axis to which their plane is normal?
///
/// at_rest  must they be held at their places at rest, too? Where some belong to no element, which stay there
[[nodiscard]] bool is_plate(const Model& model, const std::vector<Index>& vertices, bool at_rest);
/// Physical, after the supports: finds where supports close chambers, see ChamberCap.
void compile_caps(Compilation& c);

/// Gives the elements their materials (target-shape: those of no actuator).
void compile_materials(Compilation& c);

/// After the materials. robot  of several; empty: all
[[nodiscard]] const Body& body_of(Compilation& c, const std::string& robot);

/// Which vertices are a robot's: from the first to before the second.
[[nodiscard]] std::pair<Index, Index> vertices_of(const Compilation& c, const std::string& robot);

/// Of the bounding box of a robot's used vertices [mm].
[[nodiscard]] double diagonal_of(const Compilation& c, const std::string& robot);

/// The constants of a law from those that the user gives.
///
/// spec    E [MPa] and nu; or c10, c01, c20, c30 [MPa] with the bulk modulus [MPa] or nu
/// owner   names the material in messages
/// source  mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu) (1 - 2 nu)); bulk = 2 G (1 + nu) / (3 (1 - 2 nu)) with
///         G = 2 (c10 + c01), the shear modulus at small strain
/// throws  InvalidInput on constants that are missing, belong to another law or lie outside their range
[[nodiscard]] ElasticLaw elastic_law(const ElasticSpec& spec, const std::string& owner, const Origin& origin);

/// Embeds cables and, for target shapes, finds their gaps and apexes; embeds the surfaces of pneumatic actuators.
void compile_actuator_points(Compilation& c);
/// The elements of Eq. (6): a triangle over each gap; none in the physical formulation.
void compile_cable(Compilation& c, const ActuatorSpec& spec, const CableSpec& given, Actuator& actuator);

/// "[0, 1.5]"
[[nodiscard]] inline std::string interval_text(double low, double high) {
  return "[" + number(low) + ", " + number(high) + "]";
}
/// Refuses a filling whose numbers or range make no sense, and one of target shapes.
void check_filling(const ActuatorSpec& spec, const std::optional<FillingSpec>& given, Formulation formulation);
/// Refuses fewer than two connected chambers, one twice, and such of target shapes.
void check_connected(const ActuatorSpec& spec, const std::vector<std::string>& connected, Formulation formulation);
/// What seals its chamber; null: nothing does.
[[nodiscard]] const FillingSpec* filling_of(const ActuatorSpec& spec);
/// Refuses fillings under different atmospheres.
void check_atmospheres(const RobotSpec& spec);
/// When the chamber's volume at rest is known.
void compile_filling(Compilation& c, const FillingSpec& spec, Actuator& actuator);
/// Notes a range that leaves out the value at rest.
void note_rest(Compilation& c, const Actuator& actuator);

/// What a support is called: its name, that of a region that no other entry holds, or "fixed_N", N counted from 1.
[[nodiscard]] std::string support_name(const std::vector<FixedSpec>& fixed, std::size_t entry);

/// Fixed vertices and rigid regions.
void compile_supports(Compilation& c);

/// Makes the turn of a support from the rotation of its entry, which holds these vertices along all axes.
///
/// throws  InvalidInput on a number that is not finite, an axis without direction, or where nothing lies off the axis
void add_turn(Compilation& c, const FixedSpec& spec, const Support& support);
/// The turn that holds a vertex; nullptr: none.
[[nodiscard]] const SupportTurn* turn_of(const Model& model, Index vertex);
/// After the rigid regions: what a turn holds of one turns all of it.
///
/// throws  InvalidInput where another support holds it, too
void turn_rigid(Model& model, const RigidRegion& rigid, const std::string& label, const Origin& origin);
/// A command for the angle of each turn.
///
/// throws  InvalidInput where its name is taken or no name for a command
void add_turn_commands(Compilation& c);

/// Refuses a robot that its fixed vertices do not hold: every part (connected through elements, rigid regions and the
/// triangles of cables) must be unable to move rigidly, to first order.
///
/// throws  InvalidInput at origin that names the first five such parts and how each can move
void check_anchoring(const Model& model, const Origin& origin);

/// Physical: refuses a part that hangs on a vertex or an edge and can turn there. What shares faces, or is in a rigid
/// region, counts as one.
///
/// throws  InvalidInput at origin that names the part and where it hangs
void check_hinges(const Model& model, const Origin& origin);

void compile_markers(Compilation& c);
/// After the markers.
void compile_feet(Compilation& c);

/// Physical: the weight of the elements, the forces and tractions, lumped on the vertices [N].
void compile_loads(Compilation& c);
/// A face of the body's surface, of the mesh's order.
[[nodiscard]] LoadedFace loaded_face(const Compilation& c, const Triangle& corners, double share);
/// The part of compile_loads() that is about a liquid around the robot.
void compile_liquid_around(Compilation& c);
/// A command for each axis along which a force has a range.
///
/// throws  InvalidInput where its name is taken
void add_force_commands(Compilation& c);
/// The part of compile_loads() that is about tractions.
void compile_tractions(Compilation& c);
/// The faces of the body's surface that a region has, or that lie between its vertices, with normals outwards.
[[nodiscard]] std::vector<LoadedFace> surface_faces(const Compilation& c, const RegionRef& where);

/// Physical, after the materials: cuts threads into the pieces that single elements carry along.
void compile_fibres(Compilation& c);

/// The places along a sensor's curve, as those of a fibre. robot: of several, whose elements carry it; empty: all
[[nodiscard]] std::vector<FibrePlace> places_along(Compilation& c, const std::string& name,
                                                   const std::vector<Vec3>& points, const std::string& robot,
                                                   const Origin& origin);
/// After the materials.
void compile_sensors(Compilation& c);

/// Refuses what can be told of contact before anything is compiled: of target shapes, numbers outside their ranges,
/// names that are taken or that nothing has, shapes without extent.
void check_contact(const Compilation& c);
/// Last: the surfaces that may touch; appends the obstacles' vertices to the model's.
void compile_contact(Compilation& c);

/// Refuses a friction coefficient that is none; owner: whose it is.
void check_coefficient(double friction, const std::string& owner, const Origin& origin);
/// The part of check_contact() that is about obstacles and bodies.
void check_surroundings(const Compilation& c, const ContactSpec& contact);
/// Adds bodies, then obstacles, and their commands.
/// least_area  that a vertex carries pressure for [mm^2]
void add_surroundings(Compilation& c, const ContactSpec& contact, double least_area);
[[nodiscard]] double triangle_area(const Points& vertices, const Triangle& t);

/// Of a law at small strain, where all are the same.
struct StiffnessAtRest {
  double youngs_modulus_MPa = 0;
  double poisson_ratio = 0;
};
[[nodiscard]] StiffnessAtRest stiffness_at_rest(const ElasticLaw& law);

/// Physical, tetrahedra of order 1: warns of walls of so few of them that they bend by a tenth too little or less.
void doubt_linear_tetrahedra(Compilation& c);

/// Physical, order 2: warns where straight edges cost more than 2 % of a section against the surface through the
/// vertices.
void doubt_straight_edges(Compilation& c);

/// Warns of a size, moduli, gravity and densities that no soft robot has: of numbers in another unit than was meant.
void doubt_units(Compilation& c);

/// Physical: refuses, before anything takes long, a mesh whose factor takes far more memory than there is.
void refuse_too_large(const Compilation& c);

/// Warns of cables, fibres, sensors, obstacles and bodies that are far smaller than the robot, of obstacles that are
/// out of its reach, of points and shapes next to the origin that would lie in the robot if they were meant in metres,
/// and of a robot that is held everywhere.
void doubt_places(Compilation& c);

/// A point as what carries it along moves: the nearest element, or a face of a sheet where it is nearer.
///
/// throws  InvalidInput as Embedder::embed
[[nodiscard]] EmbeddedPoint carried(const Body& body, const Points& rest, const Vec3& point);
/// Is there nothing to carry a point?
[[nodiscard]] inline bool carries_nothing(const Body& body) {
  return body.embedder.empty() && body.sheets.empty();
}

/// How far outside the body a point may be to be carried along by its nearest element [mm]: half that element's longest
/// edge, and a tenth of the body's diagonal.
[[nodiscard]] double most_outside(const Body& body, const Points& rest, const Vec3& point);
/// "farther than 5.2 mm, to which its nearest element can carry it", of a point that is farther.
[[nodiscard]] std::string too_far_text(double most_mm);

/// A point of the body; what names it in messages. Notes one that is outside, refuses one that is far outside.
[[nodiscard]] EmbeddedPoint embed_point(Compilation& c, const PointRef& reference, const std::string& what);

}  // namespace softkin
