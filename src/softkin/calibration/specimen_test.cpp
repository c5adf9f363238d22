#include <cmath>
#include <numbers>
#include <softkin/calibration/specimen_mesh.hpp>
#include <softkin/calibration/specimen_test.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/statics/physical/body.hpp>

namespace softkin::calibration {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

RegionRef list_of(std::vector<Index> vertices) {
  return {Selector(VertexList{std::move(vertices)}), {}};
}

}  // namespace

int cells_across(const SpecimenOptions& options, Formulation formulation) {
  constexpr int quadratic = 3, linear = 4;
  if (options.cells != 0) return options.cells;
  return formulation == Formulation::physical ? quadratic : linear;
}

ShapeRatios shape_ratios(double log_ratio, double stiffer) {
  const double softer = stiffer * std::exp(-std::abs(log_ratio));
  return log_ratio >= 0 ? ShapeRatios{stiffer, softer} : ShapeRatios{softer, stiffer};
}

SpecimenTest::SpecimenTest(const SpecimenOptions& options, Formulation formulation, double length_mm,
                           double interface_mm)
    : options_(options), length_mm_(length_mm), interface_mm_(interface_mm) {
  robot_.name = "specimen";
  robot_.formulation = formulation;
  robot_.mesh =
      bar_mesh({length_mm, interface_mm, options.width_mm, options.height_mm, cells_across(options, formulation)});
  if (formulation == Formulation::physical) robot_.mesh = elevated(robot_.mesh);
  robot_.markers.push_back({"interface", {std::string("interface"), {}}});
}

SpecimenTest::SpecimenTest(const SpecimenOptions& options, Formulation formulation, const StretchedSpecimen& specimen)
    : SpecimenTest(options, formulation, specimen.length_mm, specimen.interface_mm) {
  const bool clamped = options.grip == Grip::clamped;
  hold(vertices_at(0), {true, clamped, clamped});
  hold(vertices_at(length_mm_), {true, clamped, clamped});
  robot_.fixed.back().displacement = {specimen.stretch_mm, 0, 0};
  if (!clamped) slide();
}

SpecimenTest::SpecimenTest(const SpecimenOptions& options, Formulation formulation, const TwistedSpecimen& specimen)
    : SpecimenTest(options, formulation, specimen.length_mm, specimen.interface_mm) {
  hold(vertices_at(0), {true, true, true});
  const double turn = specimen.twist_deg / degrees;
  for (const Index v : vertices_at(length_mm_)) {
    hold({v}, {true, true, true});
    const double y = robot_.mesh.vertices(v, 1), z = robot_.mesh.vertices(v, 2);
    robot_.fixed.back().displacement = {0, std::cos(turn) * y - std::sin(turn) * z - y,
                                        std::sin(turn) * y + std::cos(turn) * z - z};
  }
}

void SpecimenTest::hold(const std::vector<Index>& vertices, std::array<bool, 3> axes) {
  FixedSpec fixed{list_of(vertices)};
  fixed.axes = axes;
  robot_.fixed.push_back(fixed);
}

/// Across the bar only what keeps it from moving as one: the corner (-, -) of the base, and the corner (+, -) along z.
void SpecimenTest::slide() {
  for (const Index v : vertices_at(0)) {
    const double y = robot_.mesh.vertices(v, 1), z = robot_.mesh.vertices(v, 2);
    if (z != -options_.height_mm / 2) continue;
    if (y == -options_.width_mm / 2) hold({v}, {false, true, true});
    if (y == options_.width_mm / 2) hold({v}, {false, false, true});
  }
}

void SpecimenTest::set_materials(double log_ratio) {
  const ShapeRatios shape = shape_ratios(log_ratio, options_.stiffer_shape_ratio);
  robot_.materials.clear();
  for (const bool is_a : {true, false}) {
    MaterialSpec material;
    material.region = is_a ? "A" : "B";
    if (robot_.formulation == Formulation::target_shape) {
      material.shape_ratio = is_a ? shape.a : shape.b;
    } else {
      ElasticSpec elastic;
      elastic.law = options_.law;
      elastic.youngs_modulus = is_a ? std::exp(log_ratio) : 1;
      elastic.poisson_ratio = options_.poisson_ratio;
      material.elastic = elastic;
    }
    robot_.materials.push_back(material);
  }
}

std::vector<Index> SpecimenTest::vertices_at(double x) const {
  std::vector<Index> found;
  for (Index v = 0; v < robot_.mesh.vertices.rows(); ++v)
    if (robot_.mesh.vertices(v, 0) == x) found.push_back(v);
  return found;
}

/// The turn that fits the interface best, seen along the bar.
double SpecimenTest::turn_of_interface(const Points& positions) const {
  const std::vector<Index> vertices = vertices_at(interface_mm_);
  Vec3 center = Vec3::Zero();
  for (const Index v : vertices) center += positions.row(v).transpose() / static_cast<double>(vertices.size());
  double along = 0, across = 0;
  for (const Index v : vertices) {
    const double y = robot_.mesh.vertices(v, 1), z = robot_.mesh.vertices(v, 2);
    const double new_y = positions(v, 1) - center[1], new_z = positions(v, 2) - center[2];
    along += y * new_y + z * new_z;
    across += y * new_z - z * new_y;
  }
  return degrees * std::atan2(across, along);
}

double SpecimenTest::force_at_end(const Model& model, const Points& positions) const {
  if (model.formulation != Formulation::physical) return 0;
  const physical::Body body(model);
  physical::Body::Scratch scratch = body.make_scratch();
  Points gradient(positions.rows(), 3);
  Team alone(1);
  (void)body.force(Actuation(0), positions, scratch, gradient, alone);
  double sum = 0;
  for (const Index v : vertices_at(length_mm_)) sum += gradient(v, 0);
  return sum;
}

SpecimenResponse SpecimenTest::at(double log_ratio) {
  set_materials(log_ratio);
  const Model model = compile(robot_);
  const Statics statics(model);
  State start = statics.rest();
  if (last_.rows() > 0) start = {last_};
  const Equilibrium found = statics.solve(Actuation(0), start, options_.statics);
  SpecimenResponse response;
  response.status = found.report.status;
  response.remark = found.report.remark;
  const EmbeddedPoint& interface = model.markers.front().point;
  response.moved_mm = (interface.at(found.state.positions) - interface.at(model.rest))[0];
  response.turned_deg = turn_of_interface(found.state.positions);
  response.force_n = force_at_end(model, found.state.positions);
  if (response.status == Status::converged) last_ = found.state.positions;
  return response;
}

}  // namespace softkin::calibration
