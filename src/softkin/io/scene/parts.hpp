#pragma once

#include <filesystem>
#include <map>
#include <softkin/io/missing_file.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/model/direction.hpp>

namespace softkin::scene {

/// What the parts of a scene need to know of the whole.
struct Context {
  std::filesystem::path folder;
  const SceneFiles& files;
  double to_mm = 1;
  std::optional<Formulation> formulation = std::nullopt;  // that of the robots, where the scene has several
  std::int64_t vertices = 0, tetrahedra = 0;              // of the mesh
};

/// Names that must differ; a second use fails and names the place of the first.
class Names {
 public:
  const std::string& add(const Node& node);
  /// As add, for names that stand in commands and in the headers of CSV files.
  const std::string& add_label(const Node& node);

 private:
  std::map<std::string, Origin> origins_;
};

/// What load(path) returns, path being named by a node; its InvalidInput gains the scene's line, and of a file that is
/// not there what makes it.
template <class Load>
auto load_file(const Context& context, const Node& node, const Load& load) {
  const std::filesystem::path path = context.folder / text(node);
  try {
    return load(path);
  } catch (const InvalidInput& error) {
    std::error_code failure;
    const std::string source =
        std::filesystem::exists(path, failure) ? std::string() : source_of_missing(context.folder, path);
    throw InvalidInput(node.origin, error.what() + (source.empty() ? source : ": " + source));
  }
}

[[nodiscard]] double read_length(const Context& context, const Node& node);           // [mm]
[[nodiscard]] double read_positive_length(const Context& context, const Node& node);  // [mm]
[[nodiscard]] Vec3 read_position(const Context& context, const Node& node);           // [mm]
[[nodiscard]] Box read_box(const Context& context, const Node& node);
[[nodiscard]] Sphere read_sphere(const Context& context, const Node& node);
[[nodiscard]] Cylinder read_cylinder(const Context& context, const Node& node);
[[nodiscard]] Halfspace read_halfspace(const Context& context, const Node& node);
/// Of a surface's file (read_surface) in a unit of its own or that of the scene.
///
/// unit  its key; nullptr: the scene's
[[nodiscard]] TriangleSurface read_surface_file(const Context& context, const Node& file, const Node* unit);
/// Keys of a map that names a surface's file.
[[nodiscard]] const Keys& surface_keys();
/// Reads a surface from a file that is named alone, or in a map of surface_keys() that moves and rotates it.
[[nodiscard]] TriangleSurface read_surface(const Context& context, const Node& node);
/// The same of a file whose `unit`, `move` and `rotate` stand in a map with other keys.
[[nodiscard]] TriangleSurface read_moved_surface(const Context& context, const Node& file, const Map& map);
/// Moves vertices by the key `move` of a map, then rotates them by its key `rotate`; each may be missing.
void move_and_rotate(const Context& context, const Map& map, Points& vertices);
[[nodiscard]] PointRef read_point(const Context& context, const Node& node);
/// Keys that say where something is: a region's name, or a shape in its place.
[[nodiscard]] const Keys& place_keys();
[[nodiscard]] RegionRef read_place(const Context& context, const Map& map);
[[nodiscard]] RegionRef read_region_name(const Node& node);

/// A turn by the keys `axis` and `degrees`; exact where it takes axes to axes.
[[nodiscard]] Mat3 read_turn(const Map& map);
/// A rotation by a unit quaternion [w, x, y, z]; one whose norm is off by up to 0.01 is normalised.
[[nodiscard]] Mat3 read_quaternion(const Node& node);
/// A motion of points: they are rotated about the origin, then translated.
struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();  // [mm]
};
/// The value of a key `rotate`: `{axis, degrees}` or `{quaternion: [w, x, y, z]}`, each with `about` if it is not about
/// the origin, or a list of these, which are applied in their order.
[[nodiscard]] RigidMotion read_rotations(const Context& context, const Node& node);
[[nodiscard]] Formulation read_formulation(const Node& node);
[[nodiscard]] ElementWeights read_weights(const Node& node);

/// The robots of a scene that has several, joined. Key `robots` must be there.
[[nodiscard]] RobotSpec read_robots(const Context& context, const Map& scene, const std::string& file_name);

/// Key `curve` of a mesh: true, false, one surface or a list of them; none where it is false.
[[nodiscard]] std::optional<CurveSpec> read_curve(const Context& context, const Node& node);
/// The mesh of a scene, or its meshes as one, in mm.
void read_mesh_of(const Context& context, const Map& scene, RobotSpec& spec);
[[nodiscard]] std::vector<RegionSpec> read_regions(const Context& context, const Node& node);
/// Keys `contact`, `obstacles` and `bodies`; none where none of them is there.
[[nodiscard]] std::optional<ContactSpec> read_contact(const Context& context, const Map& scene);
[[nodiscard]] FibreSpec read_fibre(const Context& context, const Node& node, Names& names);
[[nodiscard]] std::shared_ptr<const LayerSpec> read_layer(const Context& context, const Node& node, Names& names);
/// Of a node that may be left out: false.
[[nodiscard]] bool is_true(const Map& map, std::string_view key);
[[nodiscard]] std::shared_ptr<const SensorSpec> read_sensor(const Context& context, const Node& node, Names& names);
[[nodiscard]] double read_density(const Node& node);
/// Target-shape keys, elastic constants, or both.
[[nodiscard]] MaterialSpec read_material(const Context& context, const Node& node);
/// Keys `remanence`, three components [mT] or a map with samples, and `magnetisation` of a material; none where the
/// first is not there.
[[nodiscard]] std::shared_ptr<const RemanenceSpec> read_remanence(const Context& context, const Map& material);
/// Families of fibres of a material; none where the key `families` is not there.
[[nodiscard]] std::shared_ptr<const FamiliesSpec> read_families(const Context& context, const Map& material);
/// Keys `places` and `samples` of a map: samples that stand in the scene itself.
[[nodiscard]] FieldSamples read_samples(const Context& context, const Map& map);
/// Three components; or a map: `radial`, `circumferential`, `file`, or `places` and `samples`.
[[nodiscard]] DirectionSpec read_direction(const Context& context, const Node& node);
/// Keys that an actuator of kind growth has besides the common ones.
[[nodiscard]] const Keys& growth_keys();
[[nodiscard]] ActuatorSpec read_growth(const Context& context, const Map& map, const std::string& name);
/// Keys that an actuator of kind magnetic alone has.
[[nodiscard]] const Keys& field_keys();
/// The commands of such an actuator, each an actuator of its own: NAME where there is one of flux density or current,
/// else NAME_x, ... (flux density, position) and NAME_mx, ... (moment).
[[nodiscard]] std::vector<ActuatorSpec> read_field(const Context& context, const Map& map, const std::string& name);
/// Loads are commanded in the physical formulation alone.
[[nodiscard]] std::vector<ActuatorSpec> read_actuators(const Context& context, Formulation formulation,
                                                       const Node& node);

}  // namespace softkin::scene
