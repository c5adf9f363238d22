#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <softkin/io/scene/parts.hpp>

namespace softkin::scene {

namespace {

/// Begins at `degrees` about the axis from x; from y where the axis is along x.
Helix read_helix(const Context& context, const Node& node) {
  const Map map(node, {"start", "axis", "radius", "pitch", "turns", "handed", "degrees"});
  const Node& direction = map.at("axis");
  Helix helix{.start = read_position(context, map.at("start")),
              .axis = read_vector(direction),
              .first = Vec3::Zero(),
              .radius = read_positive_length(context, map.at("radius")),
              .pitch = read_length(context, map.at("pitch")),
              .turns = positive(map.at("turns"))};
  if (helix.pitch < 0) fail(map.at("pitch"), "'pitch' must be 0 or more: 'axis' says which way");
  if (helix.axis.isZero(0)) fail(direction, direction.name + " must not be zero");
  if (const Node* handed = map.find("handed")) helix.left_handed = choice(*handed, {"right", "left"}) == 1;
  const Node* degrees = map.find("degrees");
  const Vec3 along = (helix.axis / helix.axis.cwiseAbs().maxCoeff()).normalized();
  const Vec3 from = along.cross(Vec3::UnitX()).norm() > 1e-6 ? Vec3::UnitX() : Vec3::UnitY();
  const Vec3 first = (from - from.dot(along) * along).normalized(), second = along.cross(first);
  const double angle = degrees ? number(*degrees) * std::numbers::pi / 180 : 0;
  helix.first = std::cos(angle) * first + std::sin(angle) * second;
  return helix;
}

std::vector<Vec3> read_corners(const Context& context, const Node::Entry& path) {
  std::vector<Vec3> corners;
  if (path.key == "points") {
    for (const auto& point : list(*path.value)) corners.push_back(read_position(context, *point));
    return corners;
  }
  const Points points = load_file(context, *path.value, context.files.route);
  for (Index i = 0; i < points.rows(); ++i) corners.push_back(vertex_at(points, i));
  return corners;
}

}  // namespace

bool is_true(const Map& map, std::string_view key) {
  const Node* node = map.find(key);
  return node != nullptr && choice(*node, {"false", "true"}) == 1;
}

FibreSpec read_fibre(const Context& context, const Node& node, Names& names) {
  const Map map(node, {"name", "points", "helix", "file", "stiffness", "inextensible", "tension_only", "region"});
  FibreSpec fibre;
  fibre.name = names.add_label(map.at("name"));
  fibre.origin = node.origin;
  const Node::Entry& path = map.one_of({"points", "helix", "file"});
  if (path.key == "helix")
    fibre.path = read_helix(context, *path.value);
  else
    fibre.path = read_corners(context, path);
  const Node::Entry& held = map.one_of({"stiffness", "inextensible"});
  if (held.key == "stiffness")
    fibre.stiffness_N = positive(*held.value);
  else if (!is_true(map, "inextensible"))
    fail(*held.value, "give the 'stiffness' of a fibre that stretches");
  fibre.tension_only = is_true(map, "tension_only");
  if (const Node* region = map.find("region")) fibre.region = text(*region);
  return fibre;
}

}  // namespace softkin::scene
