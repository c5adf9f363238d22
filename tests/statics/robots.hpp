#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <random>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>

#include "model/block_mesh.hpp"

namespace softkin::testing {

inline Actuation values(std::initializer_list<double> list) {
  Actuation actuation(list.size());
  std::copy(list.begin(), list.end(), actuation.data());
  return actuation;
}

inline Distribution shared(bool minimum_norm) {
  return minimum_norm ? Distribution::minimum_norm : Distribution::uniform;
}

inline ActuatorSpec actuator(const std::string& name, DriveSpec drive, double low, double high, bool minimum_norm) {
  ActuatorSpec spec;
  spec.name = name;
  spec.drive = std::move(drive);
  spec.low = low;
  spec.high = high;
  spec.distribution = shared(minimum_norm);
  return spec;
}

/// A beam of 60 x 20 x 24 mm with every kind of element and actuator: the lowest layer is a skin of prisms, above it
/// tetrahedra with a chamber in the middle, a cable runs along the top. Its end x = 0 is fixed.
inline RobotSpec mixed_robot(bool minimum_norm, double shape_ratio = 1, int refine = 1) {
  const std::array<int, 3> cells{6 * refine, 2 * refine, 3 * refine};
  const Vec3 size(60, 20, 24);
  Mesh mesh = layered_mesh(cells, size, Split::six);
  add_volume_region(mesh, "skin", [&](const Vec3& p) { return p.z() < 8.0 / refine && p.x() > 20; });
  mesh.regions.back().tetrahedra.clear();
  add_volume_region(mesh, "chamber", [](const Vec3& p) { return p.z() > 8 && p.z() < 16 && p.x() > 20 && p.x() < 40; });
  add_face_regions(mesh, size);
  RobotSpec spec = block_robot(std::move(mesh));
  spec.materials[0].shape_ratio = shape_ratio;

  ActuatorSpec skin = actuator("skin", DeaSpec{.region = "skin"}, 0.5, 2, minimum_norm);
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 3, minimum_norm);
  ActuatorSpec cable = actuator("cable", CableSpec{}, 0.5, 1, minimum_norm);
  for (const double x : {5.0, 25.0, 45.0, 60.0}) cable.as<CableSpec>()->points.push_back({Vec3(x, 9, 22), {}});
  spec.actuators = {skin, air, cable};
  return spec;
}

/// A beam of 50 x 10 x 10 mm with a chamber below its middle plane; about 500 tetrahedra.
inline RobotSpec finger_robot(bool minimum_norm, double shape_ratio = 1) {
  Mesh mesh = block_mesh({10, 3, 3}, {50, 12, 12}, Split::six);
  add_volume_region(mesh, "chamber", [](const Vec3& p) {
    return p.x() > 5 && p.x() < 45 && p.y() > 4 && p.y() < 8 && p.z() > 4 && p.z() < 8;
  });
  add_volume_region(mesh, "floor", [](const Vec3& p) { return p.z() < 4; });
  RobotSpec spec = block_robot(std::move(mesh));
  spec.materials[0].shape_ratio = shape_ratio;
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 4, minimum_norm);
  spec.actuators = {air};
  return spec;
}

inline Points noise(Index count, double size, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0, size);
  return Points::NullaryExpr(count, 3, [&] { return normal(engine); });
}

/// Folder of the reference data, or empty where it is absent.
inline std::filesystem::path reference_folder() {
  const char* named = std::getenv("SOFTKIN_REFERENCE");
  const std::filesystem::path folder = named ? named : SOFTKIN_SOURCE_DIR "/../shared/reference";
  return std::filesystem::exists(folder) ? folder : std::filesystem::path();
}

}  // namespace softkin::testing
