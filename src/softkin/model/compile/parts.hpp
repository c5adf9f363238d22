#pragma once

#include <map>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/embedding.hpp>
#include <softkin/model/compile/regions.hpp>
#include <softkin/model/mesh/shells.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

/// The elements with which points move: those with a material and those of dielectric elastomers, of all robots or of
/// one.
struct Body {
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Prism> prisms;
  Embedder embedder;
  double diagonal_mm = 0;            // of all of its elements
  std::vector<CavityFace> sheets{};  // of layers without elements
};

/// The data of compile() while it runs. The functions below fill in the model, in this order, and throw InvalidInput.
struct Compilation {
  /// straight  the mesh before its edges were curved: shapes choose among its vertices
  Compilation(const RobotSpec& robot, const Mesh& its_mesh, const Mesh& straight)
      : spec(robot), mesh(its_mesh), origin{.file = robot.name}, regions(robot, straight) {}

  const RobotSpec& spec;
  const Mesh& mesh;  // of the order that the model takes: spec.mesh, or made from it
  Origin origin;     // for messages about something without a line of its own
  RegionTable regions;
  Model model;
  // index in the model of each element of the mesh; -1: void
  std::vector<Index> tetrahedron_at, prism_at;
  // the inverse of these
  std::vector<Index> tetrahedron_of, prism_of;
  // physical: tetrahedra of pneumatic chambers, oriented as the model's, and their properties
  std::vector<Tetrahedron> chamber_tetrahedra;
  std::vector<EdgeNodes> chamber_edge_nodes;
  std::vector<double> chamber_volumes;
  std::vector<ElementRole> chamber_roles;
  std::vector<Index> chamber_at, chamber_of;  // as tetrahedron_at and tetrahedron_of
  // physical: the spaces that elements of the body and chambers enclose, found when first needed, and their actuators
  std::optional<std::vector<EmptySpace>> empty_spaces;
  std::vector<Index> space_actuators;        // -1: no actuator's
  std::vector<Actuator> force_commands;      // of forces, moments and pressures that are commanded
  std::vector<Triangle> sheets;              // physical: faces of layers some vertex of which is of no element
  std::map<std::string, Body> robot_bodies;  // by robot, made when first needed; "": of all
};

/// Returns the index of the robot to which a vertex or element belongs; 0 where there is one. first: RobotPart's first
/// index of that kind
[[nodiscard]] Index robot_of(const RobotSpec& spec, Index RobotPart::*first, Index number);

/// Returns ", of robot 'left'" where there are several robots, for messages that number a vertex or an element.
///
/// first  RobotPart's first index of that kind
[[nodiscard]] std::string robot_text(const RobotSpec& spec, Index RobotPart::*first, Index number);

/// Drops void elements, orients the others, measures them and names their regions. Physical: sets the elements of
/// chambers apart.
void compile_elements(Compilation& c);

/// The part of compile_elements() for layers without elements: it marks their vertices as used.
void use_sheets(Compilation& c);

/// Refuses elements that are doubled or overlap, as mesh check does, or notes them where the scene accepts them.
void refuse_mesh_errors(Compilation& c);

[[noreturn]] inline void refuse(const ActuatorSpec& spec, const std::string& what) {
  throw InvalidInput(spec.origin, "actuator '" + spec.name + "' " + what);
}

/// Checks names and numbers of the actuators and gives them their elements or the boundary of their chamber.
void compile_actuator_elements(Compilation& c);

/// Returns an actuator's surface, checked and with normals outwards.
///
/// throws  InvalidInput where it is not closed, or a shell of it lies inside another
[[nodiscard]] TriangleSurface checked_surface(const ActuatorSpec& spec, TriangleSurface surface);
/// Distance from a plane below which a vertex lies in it, over the body's diagonal.
inline constexpr double plane_tolerance = 1e-6;
/// A chamber's wall that is given as faces of the mesh.
struct ChamberWall {
  std::vector<Triangle> triangles;    // of the region, normals out of the chamber
  TriangleSurface closed;             // the same and triangles that close its openings in held planes; with vertices
                                      // of its own after those of the mesh
  std::vector<CavityFace> closing{};  // the same openings closed by faces between vertices of the model; from #V on:
  std::vector<Vec3> corners{};        // corners inside the chamber where three planes meet [mm]
};
/// Returns the wall that a region defines; throws as checked_surface.
[[nodiscard]] ChamberWall checked_wall(const Compilation& c, const ActuatorSpec& spec, const std::string& name);
/// Returns the wall of a chamber that ends at plates or planes of symmetry. triangles: of the region, neighbours agree
///
/// throws  InvalidInput where no plane that is held closes the rim
[[nodiscard]] ChamberWall closed_by_planes(const Compilation& c, const ActuatorSpec& spec, const std::string& name,
                                           std::vector<Triangle> triangles);

/// Physical: compiles the boundary of the single chamber of an actuator.
///
/// elements  of the chamber, in Compilation::chamber_tetrahedra, where it has a region
void compile_cavity(Compilation& c, const ActuatorSpec& spec, const PneumaticSpec& given,
                    const std::vector<Index>& elements, Actuator& actuator);
/// Compiles it from a surface: the empty space that the surface bounds, else the surface itself, which is then
/// embedded.
void select_cavity(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& given, Actuator& actuator);
/// Embeds the surface of an actuator that has no cavity; physical: cut so finely that it follows the elements.
void embed_surface(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& given, Actuator& actuator);

/// Returns the empty spaces that the elements of the body and of chambers enclose.
[[nodiscard]] const std::vector<EmptySpace>& empty_spaces(Compilation& c);
/// Adds an empty space's boundary to the actuator's cavity. Throws where it is another actuator's.
void take_empty_space(Compilation& c, const ActuatorSpec& spec, std::size_t space, Actuator& actuator);
/// Refuses a chamber that the body's elements fill; notes it where they fill a little of it.
void check_filling(Compilation& c, const ActuatorSpec& spec, const TriangleSurface& surface);

/// After the materials. Physical: compiles the magnetisation, and the sources of the fields that act on it.
void compile_magnetism(Compilation& c);

/// Refuses a growth whose numbers, commands or members make no sense, and one of target shapes.
void check_growth(const ActuatorSpec& spec, const GrowthSpec& growth, Formulation formulation);
/// After the materials. Physical: compiles the elements that actuators let grow, and their directions.
void compile_growth(Compilation& c);

/// After the growth. Physical: compiles the families of fibres of materials, and their directions.
void compile_families(Compilation& c);

/// Physical, after the supports: refuses chambers that are open.
void check_openings(const Compilation& c);
/// Returns the faces of a cavity that are neither faces of the body's elements nor of layers, as indices into the
/// cavity.
[[nodiscard]] std::vector<Index> open_faces(const Compilation& c, const std::vector<CavityFace>& cavity);
/// Do supports hold the face of these vertices, so that a plate or a plane of symmetry may close a chamber there: are
/// all of them held along x, y and z, or all along the normal of their plane, which is an axis?
///
/// at_rest  must they also be held at their places at rest? For faces with vertices of no element, which stay there
[[nodiscard]] bool is_plate(const Model& model, const std::vector<Index>& vertices, bool at_rest);
/// Physical, after the supports: finds where supports close chambers, see ChamberCap.
void compile_caps(Compilation& c);

/// Gives the elements their materials (target-shape: those of no actuator).
void compile_materials(Compilation& c);

/// After the materials. robot  of several; empty: all
[[nodiscard]] const Body& body_of(Compilation& c, const std::string& robot);

/// Returns the range of a robot's vertices: from the first to before the second.
[[nodiscard]] std::pair<Index, Index> vertices_of(const Compilation& c, const std::string& robot);

/// Returns the diagonal of the bounding box of a robot's used vertices [mm].
[[nodiscard]] double diagonal_of(const Compilation& c, const std::string& robot);

/// Returns the constants of a law from those that the user gives.
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
/// Returns the filling of its sealed chamber; null: it is not sealed.
[[nodiscard]] const FillingSpec* filling_of(const ActuatorSpec& spec);
/// Refuses fillings under different atmospheres.
void check_atmospheres(const RobotSpec& spec);
/// Compiles the filling, once the chamber's volume at rest is known.
void compile_filling(Compilation& c, const FillingSpec& spec, Actuator& actuator);
/// Notes a range that leaves out the value at rest.
void note_rest(Compilation& c, const Actuator& actuator);

/// Returns the name of a support: its own, that of a region that no other entry holds, or "fixed_N", N counted from 1.
[[nodiscard]] std::string support_name(const std::vector<FixedSpec>& fixed, std::size_t entry);

/// Compiles fixed vertices and rigid regions.
void compile_supports(Compilation& c);

/// Makes the turn of a support from the rotation of its entry, which holds these vertices along all axes.
///
/// throws  InvalidInput on a number that is not finite, an axis without direction, or where all vertices lie on the
///         axis
void add_turn(Compilation& c, const FixedSpec& spec, const Support& support);
/// Returns the turn that holds a vertex; nullptr: none.
[[nodiscard]] const SupportTurn* turn_of(const Model& model, Index vertex);
/// After the rigid regions: a turn that holds some vertices of a rigid region turns all of it.
///
/// throws  InvalidInput where another support holds it, too
void turn_rigid(Model& model, const RigidRegion& rigid, const std::string& label, const Origin& origin);
/// Adds a command for the angle of each turn.
///
/// throws  InvalidInput where its name is taken or no name for a command
void add_turn_commands(Compilation& c);

/// Refuses a robot whose fixed vertices do not prevent rigid motions: every part (connected through elements, rigid
/// regions and the triangles of cables) must be unable to move rigidly, to first order.
///
/// throws  InvalidInput at origin that names the first five such parts and how each can move
void check_anchoring(const Model& model, const Origin& origin);

/// Physical: refuses a part that is connected at a vertex or an edge alone and can turn there. Elements with common
/// faces, or in a rigid region, count as one part.
///
/// throws  InvalidInput at origin that names the part and the vertex or edge
void check_hinges(const Model& model, const Origin& origin);

void compile_markers(Compilation& c);
/// After the markers.
void compile_feet(Compilation& c);

/// Physical: the weight of the elements, the forces and tractions, lumped on the vertices [N].
void compile_loads(Compilation& c);
/// A face of the body's surface, of the mesh's order.
[[nodiscard]] LoadedFace loaded_face(const Compilation& c, const Triangle& corners, double fraction);
/// The part of compile_loads() for a liquid around the robot.
void compile_liquid_around(Compilation& c);
/// Adds a command for each axis along which a force has a range.
///
/// throws  InvalidInput where its name is taken
void add_force_commands(Compilation& c);
/// The part of compile_loads() for tractions.
void compile_tractions(Compilation& c);
/// Returns the faces of the body's surface in a region, or between its vertices, with normals outwards.
[[nodiscard]] std::vector<LoadedFace> surface_faces(const Compilation& c, const RegionRef& where);

/// Physical, after the materials: cuts threads into pieces that move with a single element each.
void compile_fibres(Compilation& c);

/// Returns the places along a sensor's curve, as those of a fibre. robot: of several, with whose elements it moves;
/// empty: all
[[nodiscard]] std::vector<FibrePlace> places_along(Compilation& c, const std::string& name,
                                                   const std::vector<Vec3>& points, const std::string& robot,
                                                   const Origin& origin);
/// After the materials.
void compile_sensors(Compilation& c);

/// Refuses mistakes of the contact description that can be detected before anything is compiled: contact of target
/// shapes, numbers outside their ranges, names that are taken or unknown, shapes without extent.
void check_contact(const Compilation& c);
/// Last: compiles the surfaces that can be in contact; appends the vertices of obstacles to those of the model.
void compile_contact(Compilation& c);

/// Refuses an invalid friction coefficient; owner: whose it is.
void check_coefficient(double friction, const std::string& owner, const Origin& origin);
/// The part of check_contact() for obstacles and bodies.
void check_surroundings(const Compilation& c, const ContactSpec& contact);
/// Adds bodies, then obstacles, and their commands.
/// min_area    smallest area for which a vertex carries pressure [mm^2]
void add_surroundings(Compilation& c, const ContactSpec& contact, double min_area);
[[nodiscard]] double triangle_area(const Points& vertices, const Triangle& t);

/// The elastic constants of a law at small strain, where all laws agree.
struct StiffnessAtRest {
  double youngs_modulus_MPa = 0;
  double poisson_ratio = 0;
};
[[nodiscard]] StiffnessAtRest stiffness_at_rest(const ElasticLaw& law);

/// Physical, tetrahedra of order 1: warns of walls with so few of them that they bend by at least a tenth too little.
void doubt_linear_tetrahedra(Compilation& c);

/// Physical, order 2: warns where straight edges cost more than 2 % of a section against the surface through the
/// vertices.
void doubt_straight_edges(Compilation& c);

/// Warns of a size, moduli, gravity and densities that are implausible for a soft robot: of numbers in a wrong unit.
void doubt_units(Compilation& c);

/// Physical: refuses, before any long computation, a mesh whose factor needs far more memory than there is.
void refuse_too_large(const Compilation& c);

/// Warns of cables, fibres, sensors, obstacles and bodies that are far smaller than the robot, of obstacles that are
/// out of its reach, of points and shapes next to the origin that would lie in the robot if they were in metres, and of
/// a robot that is held everywhere.
void doubt_places(Compilation& c);

/// Returns a point that moves with the nearest element, or with a face of a sheet where that is nearer.
///
/// throws  InvalidInput as Embedder::embed
[[nodiscard]] EmbeddedPoint carried(const Body& body, const Points& rest, const Vec3& point);
/// Has the body neither elements nor sheets with which a point could move?
[[nodiscard]] inline bool carries_nothing(const Body& body) {
  return body.embedder.empty() && body.sheets.empty();
}

/// Returns the maximum distance of a point outside the body that still moves with its nearest element [mm]: half that
/// element's longest edge, and a tenth of the body's diagonal.
[[nodiscard]] double max_outside(const Body& body, const Points& rest, const Vec3& point);
/// Returns "farther than 5.2 mm, to which its nearest element can carry it", for a point that is farther.
[[nodiscard]] std::string too_far_text(double max_mm);

/// Returns a point of the body; `what` names it in messages. A point outside the body is noted, one far outside
/// refused.
[[nodiscard]] EmbeddedPoint embed_point(Compilation& c, const PointRef& reference, const std::string& what);

}  // namespace softkin
