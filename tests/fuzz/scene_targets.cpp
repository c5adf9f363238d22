#include <softkin/drive/plan.hpp>
#include <softkin/drive/use.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/scene/hardware.hpp>
#include <softkin/io/scene/scene.hpp>

#include "fuzz/targets.hpp"
#include "model/block_mesh.hpp"

namespace softkin::fuzz {

namespace {

void check(const EmbeddedPoint& point, Index vertices) {
  require(point.vertices.size() == point.weights.size(), "a point without its weights");
  for (const double weight : point.weights) require_finite(weight, "a weight is not finite");
  for (const Index v : point.vertices) require(v >= 0 && v < vertices, "a point of no vertex");
}

void check(const Model& model) {
  const Index vertices = model.rest.rows();
  require(model.rest.allFinite() && model.held.at.allFinite() && model.loads.dead.allFinite(),
          "a place or load is not finite");
  require_finite(model.diagonal_mm, "the size is not finite");
  for (const auto* volumes : {&model.elements.tetrahedron_volumes, &model.elements.prism_volumes})
    for (const double volume : *volumes) require(std::isfinite(volume) && volume > 0, "an element without volume");
  for (const Actuator& actuator : model.actuators) {
    require(actuator.low <= actuator.high, "a range without values");
    require_finite(actuator.low + actuator.high + actuator.rest + actuator.weight, "a range is not finite");
    require_finite(actuator.rest_measure, "a measure at rest is not finite");
    if (const auto* cable = actuator.as<CableDrive>()) {
      for (const EmbeddedPoint& point : cable->points) check(point, vertices);
      for (const CableGap& gap : cable->gaps) check(gap.apex, vertices);
    }
    if (const auto* chamber = actuator.as<ChamberDrive>())
      for (const EmbeddedPoint& point : chamber->points) check(point, vertices);
    if (const auto* force = actuator.as<ForceCommand>(); force && force->place) check(*force->place, vertices);
  }
  for (const Marker& marker : model.markers) check(marker.point, vertices);
  for (const Material& material : model.elements.materials) {
    const ElasticLaw& law = material.elastic;
    require_finite(law.mu + law.lambda + law.c10 + law.c01 + law.c20 + law.c30 + law.bulk + law.jm,
                   "a modulus is not finite");
    require_finite(material.shape_ratio + material.weight + material.density, "a material is not finite");
  }
  const ContactModel& contact = model.contact;
  require(contact.any() || contact.triangles.empty(), "surfaces of contact without a distance");
  require(contact.triangles.size() == contact.part_of.size(), "a triangle of no part");
  for (const Triangle& triangle : contact.triangles)
    for (const Index v : triangle) require(v >= 0 && v < vertices, "a triangle of no vertex");
  for (const double area : contact.area) require_finite(area, "an area is not finite");
  require(model.rest_actuation().allFinite(), "an actuation is not finite");
  (void)fingerprint_of(model);
}

/// Ten tetrahedra, one of which is the region chamber: large enough for every key, small enough to be quick.
Mesh small_mesh() {
  Mesh mesh = testing::block_mesh({2, 1, 1}, {30, 15, 15}, testing::Split::five);
  testing::add_volume_region(mesh, "chamber", [](const Vec3& p) { return (p - Vec3(7.5, 7.5, 7.5)).norm() < 1; });
  return mesh;
}

/// A robot of several.
constexpr const char* small_finger =
    "{softkin: 1, mesh: {file: block.msh}, materials: [{youngs_modulus: 1, poisson_ratio: 0.3, shape_ratio: 1}], "
    "fixed: [{region: x_low}], actuators: [{name: air, kind: pneumatic, region: chamber, range: [1, 2]}], "
    "markers: [{name: tip, region: x_high}]}\n";

/// Files that a scene may name: meshes and a surface that are there, and the second part as a mesh, the third as a
/// curve, the fourth as a sidecar, the fifth as a robot's scene, the sixth as flux densities.
SceneFiles files_of(const Input& input) {
  static const Mesh block = small_mesh();
  static const Mesh sheet = testing::block_mesh({2, 1, 1}, {20, 10, 1}, testing::Split::prisms);
  static const TriangleSurface box = testing::box_surface({18, 5, 5}, {5, 5, 5});
  const auto absent = [](const std::filesystem::path& path) { return InvalidInput({path.string()}, "no such file"); };
  SceneFiles files;
  files.mesh = [&input, absent](const std::filesystem::path& path) {
    if (path == "block.msh") return block;
    if (path == "sheet.msh") return sheet;
    if (path == "mesh.msh" && input.parts() > 1) return read_gmsh("mesh.msh", input.part(1));
    throw absent(path);
  };
  files.surface = [absent](const std::filesystem::path& path) {
    if (path == "box.stl") return box;
    throw absent(path);
  };
  files.curve = [&input](const std::filesystem::path&) { return read_actuator_curve(input.file("curve.yaml", 2)); };
  files.sidecar = [&input](const std::filesystem::path&) { return read_sidecar(input.file("sidecar.txt", 3)); };
  files.samples = [&input](const std::filesystem::path&) { return read_field_samples(input.file("field.csv", 5)); };
  files.directions = [&input](const std::filesystem::path&) { return read_directions(input.file("field.csv", 5)); };
  files.scene = [&input, absent](const std::filesystem::path& path) {
    if (path == "finger.yaml") return std::string(small_finger);
    if (path == "robot.yaml") return input.part(4);
    throw absent(path);
  };
  return files;
}

void run_scene(const Input& input) {
  check(compile(parse_scene(input.part(0), "scene.yaml", files_of(input))));
}

/// A mesh as the robot: its region `body` of rubber, `chamber` inflated, `base` held.
void run_robot(const Input& input) {
  SceneFiles files = files_of(input);
  files.mesh = [&input](const std::filesystem::path& path) { return read_gmsh(path.string(), input.part(0)); };
  for (const char* formulation : {"physical", "target-shape"}) {
    const std::string scene =
        "softkin: 1\nmesh: {file: mesh.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3, shape_ratio: 1}]\n"
        "fixed: [{region: base}]\nactuators: [{name: air, kind: pneumatic, region: chamber, range: [1, 2]}]\n"
        "markers: [{name: tip, region: base}]\nformulation: ";
    try {
      check(compile(parse_scene(scene + formulation + "\n", "scene.yaml", files)));
    } catch (const InvalidInput&) {  // what one formulation refuses the other may take
    }
  }
}

bool same(const CurveBranch& a, const CurveBranch& b) {
  return a.ratio.x() == b.ratio.x() && a.ratio.y() == b.ratio.y() && a.spread == b.spread;
}

/// What was read comes back out of the text that is written of it, and is finite in between.
void run_curve(const Input& input) {
  const ActuatorCurve curve = read_actuator_curve(input.file("curve.yaml"));
  const CurveBranch& branch = curve.loading;
  const double low = branch.ratio.x().front(), high = branch.ratio.x().back();
  for (const double fraction : {0.0, 0.3, 1.0}) {
    const double at = low + fraction * (high - low);
    if (at >= low && at <= high) require_finite(curve.ratio(at, Branch::loading), "a ratio is not finite");
  }
  const std::string text = actuator_curve_text(curve, "again");
  const Input written(text, input.path(""));
  if (written.parts() > 1) return;  // its name of the end parts it
  const ActuatorCurve again = read_actuator_curve(written.file("again.yaml"));
  require(same(again.loading, curve.loading), "a written curve reads otherwise");
  require(again.unloading.has_value() == curve.unloading.has_value(), "a written curve lost a branch");
  if (again.unloading) require(same(*again.unloading, *curve.unloading), "a written curve reads otherwise");
  require(again.atmosphere_kPa == curve.atmosphere_kPa && again.end == curve.end, "a written curve reads otherwise");
}

/// Two cables of 40 and 60 mm and a chamber under pressure, or of a volume for a syringe, and what they are to do.
Model driven_model(bool by_volume) {
  Model model;
  for (const auto& [name, length] : {std::pair("a", 40.0), std::pair("b", 60.0), std::pair("air", 1000.0)}) {
    Actuator actuator;
    actuator.name = name;
    if (length > 100) actuator.drive = ChamberDrive{};
    if (length > 100 && !by_volume) actuator.control = Control::load;
    actuator.low = 0.5;
    actuator.high = length < 100 ? 1 : 50;
    actuator.rest_measure = length;
    model.actuators.push_back(actuator);
  }
  return model;
}

Commands commands_of(bool timed, bool by_volume) {
  Commands commands{"commands.csv", {true, true, true}, {false, false, by_volume}, {}};
  for (int i = 0; i < 4; ++i) {
    CommandRow row;
    row.actuation = Eigen::Vector3d(1 - 0.02 * i, 0.9 + 0.01 * (i % 2), 1.0 + (by_volume ? 0.1 : 1) * i);
    row.pressures_kpa = Eigen::Vector3d(0, 0, 10.0 * i);
    if (timed) row.time_s = 2.0 * i;
    row.line = static_cast<std::size_t>(i) + 2;
    commands.rows.push_back(row);
  }
  return commands;
}

void run_hardware(const Input& input) {
  const HardwareSpec hardware = read_hardware(input.file("hardware.yaml"));
  const bool by_volume = !hardware.syringes.empty();
  const Model model = driven_model(by_volume);
  for (const bool timed : {true, false}) {
    try {
      const drive::Plan plan = drive::make_plan(model, hardware, commands_of(timed, by_volume), timed);
      require_finite(plan.motion.seconds, "a motion without end");
      for (const drive::GcodeLine& line : plan.program.lines)
        for (const double position : line.position) require_finite(position, "a motor goes nowhere");
      for (const auto& row : plan.schedule.rows)
        for (const double kpa : row.kpa) require_finite(kpa, "a pressure is not finite");
      for (std::size_t i = 0; i < plan.machine.syringes.size(); ++i)
        for (const drive::PlungerRow& row : drive::plunger_rows(plan, i))
          require_finite(row.reached, "a plunger leads nowhere");
      const std::string text = drive::gcode_text(plan.machine, plan.program);
      require(text.find("nan") == std::string::npos && text.find("inf") == std::string::npos, "a number is not finite");
    } catch (const InvalidInput&) {  // with times too fast, perhaps, without them not
    }
  }
}

}  // namespace

std::vector<Target> scene_targets() {
  return {{"scene", "scene.dict", run_scene},
          {"robot", "gmsh.dict", run_robot},
          {"curve", "scene.dict", run_curve},
          {"hardware", "scene.dict", run_hardware}};
}

}  // namespace softkin::fuzz
