#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <softkin/calibration/specimen_test.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/statics/physical/body.hpp>

namespace softkin::calibration {

namespace {

constexpr double max_tetrahedra = 1e6;

/// Vertices along x, y, z.
struct Grid {
  std::vector<double> x, y, z;
  std::size_t before = 0;  // cells along x before the interface

  [[nodiscard]] Index vertex(std::size_t i, std::size_t j, std::size_t k) const {
    return i + x.size() * (j + y.size() * k);
  }
};

void append_even(std::vector<double>& places, double from, double to, double cell) {
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round((to - from) / cell)));
  if (places.empty()) places.push_back(from);
  for (std::size_t i = 1; i < count; ++i)
    places.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(count));
  places.push_back(to);
}

Grid grid_of(const BarShape& shape) {
  const double cell = shape.height_mm / shape.cells;
  Grid grid;
  append_even(grid.x, 0, shape.interface_mm, cell);
  grid.before = grid.x.size() - 1;
  append_even(grid.x, shape.interface_mm, shape.length_mm, cell);
  append_even(grid.y, -shape.width_mm / 2, shape.width_mm / 2, cell);
  append_even(grid.z, -shape.height_mm / 2, shape.height_mm / 2, cell);
  return grid;
}

void check(const BarShape& shape) {
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  if (!positive(shape.length_mm) || !positive(shape.width_mm) || !positive(shape.height_mm))
    throw InvalidInput("a specimen needs length, width and height above 0");
  if (!(shape.interface_mm > 0 && shape.interface_mm < shape.length_mm))
    throw InvalidInput("a specimen's interface must lie between its ends");
  if (shape.cells < 1) throw InvalidInput("a specimen needs at least one cell across its height");
  const double cell = shape.height_mm / shape.cells;
  const double count = 5 * (shape.length_mm / cell + 2) * (shape.width_mm / cell + 1) * shape.cells;
  if (!(count < max_tetrahedra))
    throw InvalidInput("the specimen is too long or too wide for " + std::to_string(shape.cells) +
                       " cells across its height: its mesh would have more than a million tetrahedra");
}

/// Corner c of the cell is at (c & 1, c >> 1 & 1, c >> 2); the faces' diagonals of neighbours meet.
void append_cell(const std::array<Index, 8>& v, bool odd, std::vector<Tetrahedron>& tetrahedra) {
  constexpr int corners[5][4] = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}};
  for (const auto& [a, b, c, d] : corners) {
    if (odd)
      tetrahedra.push_back({v[a ^ 1], v[b ^ 1], v[d ^ 1], v[c ^ 1]});
    else
      tetrahedra.push_back({v[a], v[b], v[c], v[d]});
  }
}

void append_cells(const Grid& grid, Mesh& mesh) {
  Region a, b;
  a.name = "A";
  b.name = "B";
  for (std::size_t k = 0; k + 1 < grid.z.size(); ++k)
    for (std::size_t j = 0; j + 1 < grid.y.size(); ++j)
      for (std::size_t i = 0; i + 1 < grid.x.size(); ++i) {
        std::array<Index, 8> corners{};
        for (std::size_t c = 0; c < 8; ++c) corners[c] = grid.vertex(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        const std::size_t first = mesh.tetrahedra.size();
        append_cell(corners, (i + j + k) % 2 != 0, mesh.tetrahedra);
        Region& region = i < grid.before ? a : b;
        for (std::size_t t = first; t < mesh.tetrahedra.size(); ++t) region.tetrahedra.push_back(t);
      }
  mesh.regions.push_back(std::move(a));
  mesh.regions.push_back(std::move(b));
}

/// The faces of the tetrahedra at one place along x, each once.
void append_face(const std::string& name, double x, Mesh& mesh) {
  constexpr int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  Region region;
  region.name = name;
  region.dimension = 2;
  const bool last = name == "free_end";
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const auto& face : faces) {
      const auto on = [&](int corner) { return mesh.vertices(t[corner], 0) == x; };
      if (!on(face[0]) || !on(face[1]) || !on(face[2])) continue;
      const int apex = 6 - face[0] - face[1] - face[2];
      const bool element_before = mesh.vertices(t[apex], 0) < x;
      if (element_before != last) continue;  // an inner face counts with the element beyond it
      region.triangles.push_back(mesh.triangles.size());
      mesh.triangles.push_back({t[face[0]], t[face[1]], t[face[2]]});
    }
  mesh.regions.push_back(std::move(region));
}

constexpr double degrees = 180 / std::numbers::pi;

}  // namespace

Mesh bar_mesh(const BarShape& shape) {
  check(shape);
  const Grid grid = grid_of(shape);
  Mesh mesh;
  mesh.vertices.resize(grid.x.size() * grid.y.size() * grid.z.size(), 3);
  for (std::size_t k = 0; k < grid.z.size(); ++k)
    for (std::size_t j = 0; j < grid.y.size(); ++j)
      for (std::size_t i = 0; i < grid.x.size(); ++i)
        mesh.vertices.row(grid.vertex(i, j, k)) << grid.x[i], grid.y[j], grid.z[k];
  append_cells(grid, mesh);
  append_face("base", 0, mesh);
  append_face("interface", shape.interface_mm, mesh);
  append_face("free_end", shape.length_mm, mesh);
  return mesh;
}

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
  FixedSpec fixed{{Selector(VertexList{vertices}), {}}};
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
  (void)body.force({Actuation(0)}, positions, scratch, gradient, alone);
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
  const Equilibrium found = statics.solve(Actuation(0), start, options_.statics,
                                          [&](const Progress&) { return !options_.go_on || options_.go_on(); });
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
