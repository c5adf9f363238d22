#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <softkin/core/text.hpp>
#include <softkin/model/compile/curving.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/families.hpp>
#include <softkin/model/joined.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/mesh/mesh_joining.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/names.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin {

namespace {

constexpr double same_direction = 1e-9;  // rounding of turns

std::string robot_label(const PlacedRobot& placed) {
  return "robot '" + placed.name + "' (" + placed.robot.name + ")";
}

/// "(0, 0, -9.81) m/s^2 (finger.yaml:3)"
std::string gravity_text(const Vec3& gravity, const Origin& origin) {
  return point_text(gravity) + " m/s^2" + (origin.file.empty() ? "" : " (" + origin.text() + ")");
}

bool differ(const Vec3& a, const Vec3& b) {
  return !((a - b).norm() <= same_direction * std::max(a.norm(), b.norm()));
}

/// A robot that gives no gravity has that of the whole, where the whole gives one.
Vec3 common_gravity(const std::vector<PlacedRobot>& robots, const CommonSpec& common) {
  const auto turned = [](const PlacedRobot& placed) {
    return Vec3(placed.place.rotation * placed.robot.loads.gravity);
  };
  const Vec3 gravity = common.gravity ? *common.gravity : turned(robots[0]);
  for (const PlacedRobot& placed : robots) {
    const RobotSpec& robot = placed.robot;
    if (common.gravity && robot.loads.gravity_origin.file.empty() && robot.loads.gravity.isZero(0)) continue;
    if (!differ(turned(placed), gravity)) continue;
    const std::string whose = common.gravity ? "the whole" : "robot '" + robots[0].name + "'";
    const Origin& origin = common.gravity ? common.gravity_origin : robots[0].robot.loads.gravity_origin;
    throw InvalidInput(placed.origin, "robot '" + placed.name + "': as it stands, its gravity is " +
                                          gravity_text(turned(placed), robot.loads.gravity_origin) + ", but that of " +
                                          whose + " is " + gravity_text(gravity, origin) +
                                          ": leave 'gravity' out of the robots' scenes and give it in this one");
  }
  return gravity;
}

Formulation common_formulation(const std::vector<PlacedRobot>& robots, const CommonSpec& common) {
  if (common.formulation) return *common.formulation;
  const PlacedRobot& first = robots[0];
  for (const PlacedRobot& placed : robots)
    if (placed.robot.formulation != first.robot.formulation)
      throw InvalidInput(placed.origin, robot_label(placed) + " is of the formulation '" +
                                            formulation_name(placed.robot.formulation) + "', " + robot_label(first) +
                                            " of '" + formulation_name(first.robot.formulation) +
                                            "': give 'formulation' in this scene");
  return first.robot.formulation;
}

ElementWeights common_weights(const std::vector<PlacedRobot>& robots, const CommonSpec& common) {
  if (common.weights) return *common.weights;
  const PlacedRobot& first = robots[0];
  for (const PlacedRobot& placed : robots)
    if (placed.robot.weights != first.robot.weights)
      throw InvalidInput(placed.origin, robot_label(placed) + " has weights '" + weights_name(placed.robot.weights) +
                                            "', " + robot_label(first) + " '" + weights_name(first.robot.weights) +
                                            "': give 'weights' in this scene");
  return first.robot.weights;
}

void check_orders(const std::vector<PlacedRobot>& robots) {
  const PlacedRobot& first = robots[0];
  for (const PlacedRobot& placed : robots) {
    const int order = order_of(placed.robot.mesh), other = order_of(first.robot.mesh);
    if (order != other)
      throw InvalidInput(placed.origin, robot_label(placed) + " is of order " + std::to_string(order) + ", " +
                                            robot_label(first) + " of order " + std::to_string(other) +
                                            ": give both one order, such as 'order: 2' of 'mesh'");
  }
}

/// Shapes choose among the nodes of the edges too.
void elevate(RobotSpec& robot) {
  if (!robot.mesh_options.quadratic || order_of(robot.mesh) == 2 || !robot.mesh.prisms.empty()) return;
  check_cells(robot.mesh, {.file = robot.name});
  robot.mesh = elevated(robot.mesh);
}

/// Adds a robot to those before it.
class Joiner {
 public:
  Joiner(PlacedRobot& placed, RobotSpec& all)
      : placed_(placed), robot_(placed.robot), all_(all), regions_(robot_, robot_.mesh) {}

  void add() {
    if (robot_.contact)
      throw InvalidInput(robot_.contact->origin,
                         "a robot among several has no 'contact', 'obstacles' or 'bodies' of its own: give them in " +
                             all_.name + ", which joins the robots");
    if (robot_.loads.liquid_around)
      throw InvalidInput(robot_.loads.liquid_around->origin,
                         "a robot among several has no liquid around it of its own: give "
                         "'submerged' in " +
                             all_.name + ", which joins the robots");
    const Mesh& mesh = all_.mesh;
    all_.robots.push_back({placed_.name, robot_.name, static_cast<Index>(mesh.vertices.rows()),
                           static_cast<Index>(mesh.tetrahedra.size()), static_cast<Index>(mesh.prisms.size()),
                           robot_.mesh_options.origin, robot_.mesh_options.accept_errors});
    all_.mesh_options.quadratic = all_.mesh_options.quadratic || robot_.mesh_options.quadratic;
    all_.mesh_options.curved = all_.mesh_options.curved || robot_.mesh_options.curve || robot_.mesh_options.curved;
    all_.mesh_options.linear_by_choice =
        (all_.robots.size() == 1 || all_.mesh_options.linear_by_choice) && robot_.mesh_options.linear_by_choice;
    add_regions();
    add_supports();
    add_actuators();
    add_points();
    add_mesh();
  }

 private:
  [[nodiscard]] std::string full(const std::string& name) const {
    return name == "all" ? placed_.name : placed_.name + "." + name;
  }
  [[nodiscard]] Chosen chosen(const std::string& kind, const Region& region) const {
    return {kind + " of robot '" + placed_.name + "'", renumbered(region, all_.mesh)};
  }
  [[nodiscard]] RegionRef full(const RegionRef& where) const {
    if (const auto* name = std::get_if<std::string>(&where.region)) return {full(*name), where.origin};
    return {Selector(chosen(label(where).substr(4), regions_.resolve(where))), where.origin};  // without "the "
  }
  [[nodiscard]] MarkerSpec full(const MarkerSpec& marker) const {
    MarkerSpec all{placed_.name + "." + marker.name, full(marker.at)};
    if (marker.offset) all.offset = placed_.place.rotation * *marker.offset;
    if (marker.carrier) all.carrier = full(*marker.carrier);
    return all;
  }
  [[nodiscard]] FibreSpec full(FibreSpec fibre) const {
    fibre.name = placed_.name + "." + fibre.name;
    fibre.robot = placed_.name;
    if (fibre.region) fibre.region = full(*fibre.region);
    if (auto* helix = std::get_if<Helix>(&fibre.path)) {
      helix->start = placed_.place(helix->start);
      for (Vec3* direction : {&helix->axis, &helix->first}) *direction = placed_.place.rotation * *direction;
    } else {
      for (Vec3& point : std::get<std::vector<Vec3>>(fibre.path)) point = placed_.place(point);
    }
    return fibre;
  }
  [[nodiscard]] LayerSpec full(LayerSpec layer) const {
    layer.name = placed_.name + "." + layer.name;
    layer.robot = placed_.name;
    if (layer.direction) layer.direction = placed_.place.rotation * *layer.direction;
    if (auto* surface = std::get_if<TriangleSurface>(&layer.where))
      for (Index v = 0; v < surface->vertices.rows(); ++v)
        surface->vertices.row(v) = placed_.place(vertex_at(surface->vertices, v)).transpose();
    else
      layer.where = full(std::get<RegionRef>(layer.where));
    return layer;
  }
  [[nodiscard]] std::shared_ptr<const SensorSpec> full(const SensorSpec& sensor) const {
    SensorSpec all = sensor;
    all.name = placed_.name + "." + sensor.name;
    all.robot = placed_.name;
    for (Vec3& point : all.points) point = placed_.place(point);
    for (std::string& section : all.sections)
      if (!section.empty()) section = full(section);
    all.axis = placed_.place.rotation * sensor.axis;
    return std::make_shared<const SensorSpec>(std::move(all));
  }
  /// Forces are commanded along the common axes: a robot that is turned must have its own along these.
  [[nodiscard]] std::optional<std::array<Vec3, 2>> turned_range(const ForceSpec& force,
                                                                const std::optional<std::array<Vec3, 2>>& range) const {
    if (!range) return std::nullopt;
    const Mat3& turn = placed_.place.rotation;
    const Mat3 whole = turn.array().round().matrix();
    constexpr double rounding = 1e-9;
    if (!((turn - whole).cwiseAbs().maxCoeff() < rounding))
      throw InvalidInput(force.at.origin, "force '" + force.name + "' of " + robot_label(placed_) +
                                              " is commanded along x, y and z, but the robot is turned, and not by "
                                              "quarters: command the force in the scene of all robots");
    const Vec3 a = whole * (*range)[0], b = whole * (*range)[1];
    return std::array<Vec3, 2>{a.cwiseMin(b), a.cwiseMax(b)};
  }
  [[nodiscard]] PointRef full(const PointRef& point) const {
    if (const auto* name = std::get_if<std::string>(&point.point)) return {full(*name), point.origin};
    return {placed_.place(std::get<Vec3>(point.point)), point.origin, placed_.name};
  }
  void place(Points& points) const {
    points = ((points * placed_.place.rotation.transpose()).rowwise() + placed_.place.translation.transpose()).eval();
    if (!points.allFinite()) throw InvalidInput("its place puts it too far away");
  }

  void add_regions() {
    const std::size_t groups = robot_.mesh.regions.size();
    for (std::size_t r = 0; r < robot_.regions.size(); ++r) {
      const RegionSpec& spec = robot_.regions[r];
      const Region& region = regions_.regions()[groups + r];
      all_.regions.push_back({full(spec.name), chosen("region '" + spec.name + "'", region), spec.origin});
    }
    // after the robot's own, which elements in both are shown as
    all_.regions.push_back({placed_.name, chosen("elements", regions_.find("all", placed_.origin)), placed_.origin});
    for (MaterialSpec& material : robot_.materials) {
      material.region = full(material.region);
      if (material.remanence) material.remanence = turned(*material.remanence);
      if (material.families) {
        FamiliesSpec families = *material.families;
        for (FamilySpec& family : families.families) family.direction = turned(family.direction);
        material.families = std::make_shared<const FamiliesSpec>(std::move(families));
      }
      all_.materials.push_back(std::move(material));
    }
    for (const RegionRef& where : robot_.voids) all_.voids.push_back(full(where));
  }

  [[nodiscard]] std::shared_ptr<const RemanenceSpec> turned(RemanenceSpec remanence) const {
    remanence.uniform = placed_.place.rotation * remanence.uniform;
    remanence.samples = (remanence.samples * placed_.place.rotation.transpose()).eval();
    place(remanence.places);
    return std::make_shared<const RemanenceSpec>(std::move(remanence));
  }

  [[nodiscard]] DirectionSpec turned(DirectionSpec direction) const {
    for (Vec3* along : {&direction.uniform, &direction.axis}) *along = placed_.place.rotation * *along;
    direction.center = placed_.place(direction.center);
    direction.samples = (direction.samples * placed_.place.rotation.transpose()).eval();
    place(direction.places);
    return direction;
  }

  void add_supports() {
    for (std::size_t f = 0; f < robot_.fixed.size(); ++f) {
      FixedSpec fixed = robot_.fixed[f];
      fixed.name = placed_.name + "." + support_name(robot_.fixed, f);
      turn(fixed);
      fixed.where = full(fixed.where);
      all_.fixed.push_back(std::move(fixed));
    }
    for (const RigidSpec& rigid : robot_.rigid)
      all_.rigid.push_back({full(rigid.where), rigid.name.empty() ? "" : placed_.name + "." + rigid.name});
  }

  /// Turns a support: its held directions span a space that must be spanned by axes again after the turn.
  void turn(FixedSpec& fixed) const {
    const Mat3& rotation = placed_.place.rotation;
    const auto ones = [](const std::array<bool, 3>& axes) { return Vec3(axes[0], axes[1], axes[2]); };
    const Vec3 own = ones(fixed.axes);
    const Mat3 space = rotation * own.asDiagonal() * rotation.transpose();
    for (int axis = 0; axis < 3; ++axis) fixed.axes[axis] = space(axis, axis) > 0.5;
    const Vec3 held = ones(fixed.axes);
    if ((space - Mat3(held.asDiagonal())).cwiseAbs().maxCoeff() > same_direction)
      throw InvalidInput(fixed.where.origin,
                         label(fixed.where) +
                             " is fixed along some axes, which the turn of the robot takes to none of the scene's: "
                             "fix it along x, y and z, or turn the robot by quarter turns about its axes");
    const bool refused = !fixed.displacement.cwiseProduct(Vec3::Ones() - own).isZero(0);  // by compile()
    fixed.displacement = rotation * fixed.displacement;
    if (!refused) fixed.displacement = fixed.displacement.cwiseProduct(held).eval();
    if (!fixed.rotation) return;
    fixed.rotation->axis = rotation * fixed.rotation->axis;
    if (fixed.rotation->about) fixed.rotation->about = placed_.place(*fixed.rotation->about);
  }

  void add_actuators() {
    for (ActuatorSpec& actuator : robot_.actuators) {
      if (actuator.is<FieldSpec>())
        throw InvalidInput(actuator.origin, "a robot among several has no magnetic field of its own: give it in " +
                                                all_.name + ", which joins the robots");
      std::visit([this](auto& drive) { this->fill(drive); }, actuator.drive);
      actuator.name = placed_.name + "." + actuator.name;
      actuator.robot = placed_.name;
      all_.actuators.push_back(std::move(actuator));
    }
  }

  void fill(PneumaticSpec& chamber) const {
    for (auto* region : {&chamber.region, &chamber.wall})
      if (*region) *region = full(**region);
    for (std::string& region : chamber.connected) region = full(region);
    if (chamber.surface) place(chamber.surface->vertices);
    if (chamber.void_at) chamber.void_at = placed_.place(*chamber.void_at);
  }
  void fill(CableSpec& cable) const {
    for (auto* points : {&cable.points, &cable.apexes})
      for (PointRef& point : *points) point = full(point);
  }
  void fill(DeaSpec& dea) const {
    dea.region = full(dea.region);
    if (dea.fractions)
      for (Index& prism : dea.fractions->prisms) prism += all_.mesh.prisms.size();
  }
  void fill(GrowthSpec& growth) const {
    for (GrowthPart& part : growth.parts) {
      part.region = full(part.region);
      if (part.direction) part.direction = turned(*part.direction);
    }
  }
  static void fill(FieldSpec&) {}  // refused

  void add_points() {
    for (const ForceSpec& force : robot_.loads.forces)
      all_.loads.forces.push_back({placed_.name + "." + force.name, full(force.at),
                                   placed_.place.rotation * force.force, turned_range(force, force.range),
                                   placed_.place.rotation * force.moment, turned_range(force, force.moment_range)});
    for (TractionSpec& traction : robot_.loads.tractions) {
      traction.name = placed_.name + "." + traction.name;
      traction.where = full(traction.where);
      traction.kilopascals = placed_.place.rotation * traction.kilopascals;
      all_.loads.tractions.push_back(std::move(traction));
    }
    for (FibreSpec& fibre : robot_.fibres) all_.fibres.push_back(full(std::move(fibre)));
    for (const auto& layer : robot_.layers) all_.layers.push_back(std::make_shared<const LayerSpec>(full(*layer)));
    for (const MarkerSpec& marker : robot_.markers) all_.markers.push_back(full(marker));
    for (const auto& sensor : robot_.sensors) all_.sensors.push_back(full(*sensor));
    for (FootSpec& foot : robot_.feet) {
      foot.marker = placed_.name + "." + foot.marker;
      all_.feet.push_back(std::move(foot));
    }
  }

  void add_mesh() {
    Mesh& mesh = robot_.mesh;
    std::vector<std::string> notes = robot_.notes;
    if (robot_.mesh_options.curve && order_of(mesh) == 2) curve_mesh(robot_, mesh, notes);
    for (const std::string& note : notes) all_.notes.push_back("Robot '" + placed_.name + "': " + note);
    place(mesh.vertices);
    std::erase_if(mesh.regions, [](const Region& region) { return region.name == "all"; });
    for (Region& region : mesh.regions) region.name = full(region.name);
    append(all_.mesh, mesh);
  }

  PlacedRobot& placed_;
  RobotSpec& robot_;
  RobotSpec& all_;
  RegionTable regions_;
};

template <class Part>
void append_parts(std::vector<Part>& all, std::vector<Part>& more) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

}  // namespace

RobotSpec joined(std::vector<PlacedRobot> robots, const CommonSpec& common) {
  if (robots.empty()) throw InvalidInput({common.name}, "there is no robot to join");
  RobotSpec all;
  all.name = common.name;
  all.formulation = common_formulation(robots, common);
  all.weights = common_weights(robots, common);
  all.loads.gravity = common_gravity(robots, common);
  const auto each = [&](const auto& act) {
    for (PlacedRobot& placed : robots) {
      try {
        act(placed);
      } catch (const InvalidInput& error) {
        throw InvalidInput(placed.origin, "robot '" + placed.name + "': " + error.what());
      }
    }
  };
  each([](PlacedRobot& placed) { elevate(placed.robot); });
  check_orders(robots);
  each([&](PlacedRobot& placed) { Joiner(placed, all).add(); });
  all.mesh_options.origin = all.robots[0].mesh_origin;
  all.mesh_options.accept_errors =
      std::any_of(all.robots.begin(), all.robots.end(), [](const RobotPart& part) { return part.accept_mesh_errors; });
  return all;
}

void add_common(RobotSpec& robots, RobotSpec common) {
  for (std::size_t f = 0; f < common.fixed.size(); ++f) {
    std::string name = support_name(common.fixed, f);
    const bool taken = std::any_of(robots.fixed.begin(), robots.fixed.end(),
                                   [&](const FixedSpec& fixed) { return fixed.name == name; });
    common.fixed[f].name = taken ? "fixed_" + std::to_string(f + 1) : std::move(name);
  }
  append_parts(robots.regions, common.regions);
  append_parts(robots.materials, common.materials);
  append_parts(robots.voids, common.voids);
  append_parts(robots.fixed, common.fixed);
  append_parts(robots.rigid, common.rigid);
  append_parts(robots.actuators, common.actuators);
  append_parts(robots.loads.forces, common.loads.forces);
  append_parts(robots.loads.tractions, common.loads.tractions);
  append_parts(robots.fibres, common.fibres);
  append_parts(robots.layers, common.layers);
  append_parts(robots.markers, common.markers);
  append_parts(robots.sensors, common.sensors);
  append_parts(robots.feet, common.feet);
  robots.contact = std::move(common.contact);
  robots.loads.liquid_around = common.loads.liquid_around;
}

}  // namespace softkin
