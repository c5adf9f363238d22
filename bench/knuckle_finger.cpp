#include "knuckle_finger.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/io/scene/scene.hpp>

#include "model/block_mesh.hpp"

namespace softkin::bench {

namespace {

// of examples/knuckle_finger.geo [mm]
constexpr double length = 120, width = 25, height = 25, hinge = 5, flat = 4, slope = 0.4, cable_z = 21.5;
constexpr std::array<double, 3> notches{30, 64, 98};

/// Of the upper side.
double top_at(double x) {
  double top = height;
  for (const double notch : notches) top = std::min(top, hinge + std::max(0.0, std::abs(x - notch) - flat) / slope);
  return top;
}

/// Planes across the finger: the corners of its profile, and planes evenly between them, no farther apart than a size.
std::vector<double> planes(double size) {
  std::vector<double> corners{0};
  for (const double notch : notches)
    for (const double half : {-(flat + (height - hinge) * slope), -flat, flat, flat + (height - hinge) * slope})
      corners.push_back(notch + half);
  corners.push_back(length);
  std::vector<double> planes{0};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double extent = corners[i] - corners[i - 1], parts = std::max(1.0, std::round(extent / size));
    for (double part = 1; part <= parts; ++part) planes.push_back(corners[i - 1] + extent * part / parts);
  }
  return planes;
}

/// Cells along x, y and z for cells of a size.
std::array<int, 3> cells_for(double size) {
  const auto count = [size](double extent) { return std::max(2, 2 * static_cast<int>(std::round(extent / size / 2))); };
  return {static_cast<int>(planes(size).size()) - 1, count(width), count(0.7 * height)};
}

double tetrahedra_for(double size) {
  const std::array<int, 3> cells = cells_for(size);
  return 6.0 * cells[0] * cells[1] * cells[2];
}

double size_for(double tetrahedra) {
  double best = 5;
  for (double size = 12; size > 0.8; size *= 0.99)
    if (std::abs(std::log(tetrahedra_for(size) / tetrahedra)) < std::abs(std::log(tetrahedra_for(best) / tetrahedra)))
      best = size;
  return best;
}

Mesh finger_mesh(double size) {
  const std::array<int, 3> cells = cells_for(size);
  Mesh mesh = testing::block_mesh(cells, {1, 1, 1}, testing::Split::six);
  const std::vector<double> x = planes(size);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    auto p = mesh.vertices.row(v);
    p.x() = x[static_cast<std::size_t>(std::lround(p.x() * cells[0]))];
    p.y() = width * (p.y() - 0.5);
    p.z() *= top_at(p.x());
  }
  for (Region& region : mesh.regions) {
    if (region.name == "x_low") region.name = "base";
    if (region.name == "x_high") region.name = "tip";
  }
  return mesh;
}

}  // namespace

RobotSpec knuckle_finger(const std::string& scene, double tetrahedra, int order) {
  RobotSpec spec = read_scene(scene);
  spec.mesh = finger_mesh(size_for(tetrahedra));
  spec.quadratic = order == 2;
  const double beside = flat + (cable_z - hinge) * slope;  // of the notch's middle, where the cable leaves its wall
  for (std::size_t a = 0; a < spec.actuators.size() && a < notches.size(); ++a) {
    spec.actuators[a].points[1].point = Vec3(notches[a] - beside, 0, cable_z);
    spec.actuators[a].points[2].point = Vec3(notches[a] + beside, 0, cable_z);
  }
  return spec;
}

}  // namespace softkin::bench
