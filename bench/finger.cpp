#include "finger.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/box_tree.hpp>

namespace softkin::bench {

namespace {

constexpr double half_width = 12.5, height = 25;  // [mm]
constexpr double end_wall = 6, floor_wall = 2;    // [mm]
constexpr double wall = 1.4;                      // of the folds [mm]
constexpr int folds = 7;
constexpr double length = 120;
constexpr double half_neck = 4, neck_top = 9;  // where a fold joins the next: outside of the wall [mm]
constexpr double between = (length - 2 * end_wall - 2 * (folds - 1) * wall) / (2 * folds - 1);  // walls of folds [mm]
constexpr double min_cell = 0.3, largest_cell = 10;

/// A stretch of cells along one axis, and what part of the robot it belongs to.
enum class Part { solid, fold, plate, gap, rim, annulus, neck, core };
constexpr int part_count = static_cast<int>(Part::core) + 1;
struct Line {
  std::vector<double> at{0.0};  // of the vertices [mm]
  std::vector<Part> parts;      // of the cells between them

  void add(double extent, double cell, Part part, int least = 1) {
    const int cells = std::max(least, static_cast<int>(std::lround(extent / cell)));
    const double begin = at.back();
    for (int c = 1; c <= cells; ++c) at.push_back(begin + extent * c / cells);
    parts.insert(parts.end(), cells, part);
  }
  [[nodiscard]] int cells() const { return static_cast<int>(parts.size()); }
  [[nodiscard]] std::array<std::int64_t, part_count> cells_by_part() const {
    std::array<std::int64_t, part_count> cells{};
    for (const Part part : parts) ++cells[static_cast<int>(part)];
    return cells;
  }
};

struct Grid {
  Line x, y, z;

  [[nodiscard]] Index vertex(int i, int j, int k) const { return i + (x.cells() + 1) * (j + (y.cells() + 1) * k); }
};

Grid grid_of(double cell) {
  Grid grid;
  grid.x.add(end_wall, cell, Part::solid);
  grid.x.add(between, cell, Part::fold);
  for (int fold = 1; fold < folds; ++fold) {
    grid.x.add(wall, cell, Part::plate);
    grid.x.add(between, cell, Part::gap);
    grid.x.add(wall, cell, Part::plate);
    grid.x.add(between, cell, Part::fold);
  }
  grid.x.add(end_wall, cell, Part::solid);

  constexpr double half_core = half_neck - wall;
  grid.y.add(wall, cell, Part::rim);
  grid.y.add(half_width - wall - half_neck, cell, Part::annulus, 2);
  grid.y.add(wall, cell, Part::neck);
  grid.y.add(half_core, cell, Part::core);  // by halves: an even number of cells, mirror images in y = 0
  grid.y.add(half_core, cell, Part::core);
  grid.y.add(wall, cell, Part::neck);
  grid.y.add(half_width - wall - half_neck, cell, Part::annulus, 2);
  grid.y.add(wall, cell, Part::rim);
  for (double& y : grid.y.at) y -= half_width;

  grid.z.add(floor_wall, cell, Part::solid);
  grid.z.add(neck_top - wall - floor_wall, cell, Part::core);
  grid.z.add(wall, cell, Part::neck);
  grid.z.add(height - wall - neck_top, cell, Part::annulus, 3);
  grid.z.add(wall, cell, Part::rim);
  return grid;
}

enum class Fill { nothing, body, chamber };

Fill fill_of(Part x, Part y, Part z) {
  if (x == Part::solid || z == Part::solid) return Fill::body;
  if (y == Part::core && z == Part::core) return Fill::chamber;
  if (x == Part::plate) return Fill::body;
  if (x == Part::fold) return y == Part::rim || z == Part::rim ? Fill::body : Fill::chamber;
  const bool in_neck = (y == Part::core || y == Part::neck) && (z == Part::core || z == Part::neck);
  return in_neck ? Fill::body : Fill::nothing;
}

/// visit(i, j, k) for every cell that is filled so.
template <class Visit>
void each_cell(const Grid& grid, Fill fill, const Visit& visit) {
  for (int k = 0; k < grid.z.cells(); ++k)
    for (int j = 0; j < grid.y.cells(); ++j)
      for (int i = 0; i < grid.x.cells(); ++i)
        if (fill_of(grid.x.parts[i], grid.y.parts[j], grid.z.parts[k]) == fill) visit(i, j, k);
}

/// Splits a cell into five tetrahedra; every other cell is mirrored, so that neighbours have the same face diagonals.
void split_cell(const Grid& grid, int i, int j, int k, std::vector<Tetrahedron>& tetrahedra) {
  const int mirror = (i + j + k) % 2;
  const auto corner = [&](int c) {
    const int at = c ^ mirror;
    return grid.vertex(i + (at & 1), j + (at >> 1 & 1), k + (at >> 2));
  };
  constexpr int corners[5][4] = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}};
  for (const auto& c : corners) {
    Tetrahedron t{corner(c[0]), corner(c[1]), corner(c[2]), corner(c[3])};
    if (mirror != 0) std::swap(t[2], t[3]);
    tetrahedra.push_back(t);
  }
}

/// Vertices of the elements alone, numbered anew in their order; returns the new number of each (-1: left out).
std::vector<Index> take_vertices(const Grid& grid, Mesh& mesh) {
  std::vector<Index> number(static_cast<std::size_t>(grid.vertex(grid.x.cells(), grid.y.cells(), grid.z.cells())) + 1,
                            -1);
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (const Index v : t) number[v] = 0;
  Index count = 0;
  for (Index& n : number)
    if (n == 0) n = count++;
  mesh.vertices.resize(count, 3);
  for (int k = 0; k <= grid.z.cells(); ++k)
    for (int j = 0; j <= grid.y.cells(); ++j)
      for (int i = 0; i <= grid.x.cells(); ++i)
        if (const Index n = number[grid.vertex(i, j, k)]; n >= 0)
          mesh.vertices.row(n) << grid.x.at[i], grid.y.at[j], grid.z.at[k];
  for (Tetrahedron& t : mesh.tetrahedra)
    for (Index& v : t) v = number[v];
  return number;
}

std::vector<Index> numbers(Index begin, Index end) {
  std::vector<Index> all;
  for (Index i = begin; i < end; ++i) all.push_back(i);
  return all;
}

void add_surface(Mesh& mesh, const std::string& name, const std::vector<Triangle>& triangles) {
  Region region;
  region.name = name;
  region.dimension = 2;
  region.triangles = numbers(mesh.triangles.size(), mesh.triangles.size() + triangles.size());
  mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
  mesh.regions.push_back(std::move(region));
}

void add_surfaces(Mesh& mesh, Index body) {
  const std::vector<Tetrahedron> chamber(mesh.tetrahedra.begin() + body, mesh.tetrahedra.end());
  const Boundary outside = boundary_of(mesh.tetrahedra, {}), cavity = boundary_of(chamber, {});
  const auto at = [&](double x) {
    std::vector<Triangle> found;
    for (const Triangle& t : outside.triangles)
      if (std::all_of(t.begin(), t.end(), [&](Index v) { return std::abs(mesh.vertices(v, 0) - x) < 1e-9; }))
        found.push_back(t);
    return found;
  };
  add_surface(mesh, "fixed", at(0));
  add_surface(mesh, "tip", at(length));
  add_surface(mesh, "cavity_wall", cavity.triangles);
}

const Region& find_region(const Mesh& mesh, const std::string& name, int dimension, const std::string& origin) {
  for (const Region& region : mesh.regions)
    if (region.name == name && region.dimension == dimension) return region;
  throw InvalidInput({.file = origin},
                     "the finger needs a region '" + name + "' of dimension " + std::to_string(dimension));
}

bool has_region(const Mesh& mesh, const std::string& name) {
  return std::any_of(mesh.regions.begin(), mesh.regions.end(), [&](const Region& r) { return r.name == name; });
}

Vec3 middle_of_lower_edge(const Mesh& mesh, const std::vector<Index>& face) {
  double low = std::numeric_limits<double>::infinity();
  for (const Index v : face) low = std::min(low, mesh.vertices(v, 2));
  Bounds edge;
  for (const Index v : face)
    if (mesh.vertices(v, 2) < low + 1e-6) edge.extend(mesh.vertices.row(v).transpose());
  return edge.center();
}

constexpr double angle_tolerance = 0.05;  // [degrees]

Points centred(const Points& positions, const std::vector<Index>& vertices) {
  Points points(vertices.size(), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) points.row(i) = positions.row(vertices[i]);
  const Eigen::RowVector3d mean = points.colwise().mean();
  return points.rowwise() - mean;
}

/// Walks along the equilibria of growing volume.
class Walk {
 public:
  Walk(const Model& model, const Statics& statics, const std::vector<Index>& face, const StaticsOptions& options)
      : model_(model), statics_(statics), options_(options), bend_(model.rest, face) {
    here_.state = statics.rest();
    here_.tip = model.markers.at(0).point.at(model.rest);
  }

  /// Goes on to the first shape that is bent by the angle.
  std::optional<BentShape> to(double angle) {
    while (here_.degrees < angle - angle_tolerance) {
      const double ratio = here_.ratio + step_;
      if (ratio > model_.actuators[0].high) return std::nullopt;
      const std::optional<BentShape> next = solve(ratio);
      if (!next) {
        step_ /= 2;
        if (step_ < 1e-4) return std::nullopt;
        continue;
      }
      const double turned = std::abs(next->degrees - here_.degrees);
      if (turned > largest_turn) {
        step_ /= 2;
        continue;
      }
      if (next->degrees > angle + angle_tolerance) return close_in(*next, angle);
      advance(*next);
      if (turned < largest_turn / 4) step_ *= 1.5;
    }
    return here_;
  }

 private:
  static constexpr double largest_turn = 60;  // of a step [degrees]

  [[nodiscard]] std::optional<BentShape> solve(double ratio) const {
    const Equilibrium found = statics_.solve(Actuation::Constant(1, ratio), here_.state, options_);
    if (found.report.status != Status::converged) return std::nullopt;
    BentShape shape;
    shape.state = found.state;
    shape.ratio = ratio;
    shape.pressure = found.state.multipliers[0];
    Bend bend = bend_;
    shape.degrees = bend.follow(found.state.positions);
    shape.tip = model_.markers[0].point.at(found.state.positions);
    return shape;
  }

  /// The angle lies between here_ and beyond: regula falsi, halved where it creeps.
  std::optional<BentShape> close_in(const BentShape& beyond, double angle) {
    double low = here_.ratio, high = beyond.ratio;
    double low_miss = here_.degrees - angle, high_miss = beyond.degrees - angle;
    for (int attempt = 0; attempt < 40; ++attempt) {
      const double fraction = attempt % 4 == 3 ? 0.5 : -low_miss / (high_miss - low_miss);
      const std::optional<BentShape> shape = solve(low + fraction * (high - low));
      if (!shape) return std::nullopt;
      const double miss = shape->degrees - angle;
      if (std::abs(miss) <= angle_tolerance) {
        advance(*shape);
        return shape;
      }
      (miss < 0 ? low : high) = shape->ratio;
      (miss < 0 ? low_miss : high_miss) = miss;
    }
    return std::nullopt;
  }

  void advance(const BentShape& shape) {
    bend_.follow(shape.state.positions);
    here_ = shape;
  }

  const Model& model_;
  const Statics& statics_;
  StaticsOptions options_;
  Bend bend_;
  BentShape here_;
  double step_ = 0.05;  // of the ratio
};

}  // namespace

Mesh bellows_finger(double cell_mm) {
  if (!(cell_mm >= min_cell && cell_mm <= largest_cell))
    throw InvalidInput("the finger's cell size is to be 0.3 to 10 mm");
  const Grid grid = grid_of(cell_mm);
  Mesh mesh;
  const auto split = [&](int i, int j, int k) { split_cell(grid, i, j, k, mesh.tetrahedra); };
  each_cell(grid, Fill::body, split);
  const Index body = mesh.tetrahedra.size();
  each_cell(grid, Fill::chamber, split);
  const std::vector<Index> number = take_vertices(grid, mesh);
  Region region;
  region.name = "body";
  region.tetrahedra = numbers(0, body);
  mesh.regions.push_back(region);
  region.name = "chamber";
  region.tetrahedra = numbers(body, mesh.tetrahedra.size());
  mesh.regions.push_back(region);
  add_surfaces(mesh, body);
  Region marker;
  marker.name = "tip_marker";
  marker.dimension = 0;
  marker.vertices = {number[grid.vertex(grid.x.cells(), grid.y.cells() / 2, 0)]};
  mesh.regions.push_back(std::move(marker));
  return mesh;
}

std::int64_t body_tetrahedra(double cell_mm) {
  const Grid grid = grid_of(cell_mm);
  const auto along_x = grid.x.cells_by_part(), along_y = grid.y.cells_by_part(), along_z = grid.z.cells_by_part();
  std::int64_t cells = 0;
  for (int x = 0; x < part_count; ++x)
    for (int y = 0; y < part_count; ++y)
      for (int z = 0; z < part_count; ++z)
        if (fill_of(Part(x), Part(y), Part(z)) == Fill::body) cells += along_x[x] * along_y[y] * along_z[z];
  return 5 * cells;
}

double cell_for(double wanted) {
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (double cell = min_cell; cell <= largest_cell; cell *= 1.002) {
    const double distance = std::abs(std::log(static_cast<double>(body_tetrahedra(cell)) / wanted));
    if (distance < least) {
      least = distance;
      best = cell;
    }
  }
  if (!(least < std::log(2.0)))
    throw InvalidInput("the finger comes in sizes from " + std::to_string(body_tetrahedra(largest_cell)) + " to " +
                       std::to_string(body_tetrahedra(min_cell)) + " body tetrahedra");
  return best;
}

std::vector<Index> tip_face(const Mesh& mesh, const std::string& origin) {
  std::vector<Index> vertices;
  for (const Index t : find_region(mesh, "tip", 2, origin).triangles)
    vertices.insert(vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  if (vertices.size() < 3) throw InvalidInput({.file = origin}, "region 'tip' has no triangles");
  return vertices;
}

RobotSpec finger_robot(Mesh mesh, FingerKind kind, const std::string& origin) {
  for (const char* name : {"body", "chamber"}) (void)find_region(mesh, name, 3, origin);
  (void)find_region(mesh, "fixed", 2, origin);
  const std::vector<Index> face = tip_face(mesh, origin);
  RobotSpec spec;
  spec.name = origin;
  MarkerSpec tip;
  tip.name = "tip";
  tip.at.point = middle_of_lower_edge(mesh, face);
  if (has_region(mesh, "tip_marker")) tip.at.point = std::string("tip_marker");
  spec.markers = {tip};
  spec.mesh = std::move(mesh);
  MaterialSpec material;
  material.region = "body";
  if (kind == FingerKind::target_shape) {
    material.shape_ratio = 1;
  } else {
    spec.formulation = Formulation::physical;
    spec.mesh_options.quadratic = kind == FingerKind::physical_quadratic;
    material.shape_ratio.reset();
    ElasticSpec elastic;
    elastic.law = Law::st_venant_kirchhoff;
    elastic.youngs_modulus = 12;
    elastic.poisson_ratio = 0.4;
    material.elastic = elastic;
  }
  spec.materials = {material};
  spec.fixed.push_back({{std::string("fixed"), {}}, {true, true, true}});
  ActuatorSpec air;
  air.name = "air";
  air.drive = PneumaticSpec{.region = "chamber"};
  air.low = 0.2;
  air.high = 20;
  spec.actuators = {air};
  return spec;
}

Bend::Bend(const Points& rest, std::vector<Index> face) : face_(std::move(face)), rest_(centred(rest, face_)) {}

double Bend::follow(const Points& positions) {
  const Mat3 correlation = centred(positions, face_).transpose() * rest_;
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 mirrored = svd.matrixU() * svd.matrixV().transpose();
  const Vec3 signs(1, 1, mirrored.determinant() < 0 ? -1 : 1);
  const Mat3 rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const double angle = std::atan2(rotation(0, 2) - rotation(2, 0), rotation(0, 0) + rotation(2, 2));
  const double turn = angle * 180 / std::numbers::pi - degrees_;
  degrees_ += turn - 360 * std::round(turn / 360);
  return degrees_;
}

std::vector<BentShape> find_bends(const Model& model, const Statics& statics, const std::vector<Index>& face,
                                  const std::vector<double>& angles, const StaticsOptions& options) {
  Walk walk(model, statics, face, options);
  std::vector<BentShape> shapes;
  for (const double angle : angles) {
    const std::optional<BentShape> shape = walk.to(angle);
    if (!shape) break;
    shapes.push_back(*shape);
  }
  return shapes;
}

}  // namespace softkin::bench
