#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <softkin/model/layer.hpp>
#include <softkin/model/robot_spec.hpp>

namespace softkin::testing {

/// Two sheets of film, flat and welded along their rim.
struct Pillow {
  Mesh mesh;
  Index top = -1, bottom = -1;  // vertices in the middle
  std::vector<Index> rim;
};

/// A sheet of triangles; by its side which vertices are of the rim.
struct Sheet {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<bool> rim;
};

/// Of a disc: rings of six triangles more each.
inline Sheet disc(double radius, int rings) {
  Sheet sheet{{Vec3::Zero()}, {}, {rings == 0}};
  const auto place = [](int ring, int k) {  // number of the k-th vertex of a ring
    return static_cast<Index>(ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + (k + 6 * ring) % (6 * ring));
  };
  for (int i = 1; i <= rings; ++i)
    for (int k = 0; k < 6 * i; ++k) {
      const double angle = 2 * std::numbers::pi * k / (6 * i);
      sheet.points.emplace_back(radius * i / rings * std::cos(angle), radius * i / rings * std::sin(angle), 0);
      sheet.rim.push_back(i == rings);
    }
  for (int i = 1; i <= rings; ++i)
    for (int side = 0; side < 6; ++side)
      for (int j = 0; j < i; ++j) {
        const Index out = place(i, side * i + j), next = place(i, side * i + j + 1);
        sheet.triangles.push_back({place(i - 1, side * (i - 1) + j), out, next});
        if (j < i - 1)
          sheet.triangles.push_back({place(i - 1, side * (i - 1) + j), next, place(i - 1, side * (i - 1) + j + 1)});
      }
  return sheet;
}

/// The sheet twice, on itself.
inline Pillow pillow(const Sheet& sheet) {
  Pillow made;
  std::vector<Vec3> points = sheet.points;
  std::vector<Index> below(points.size());
  for (std::size_t v = 0; v < sheet.points.size(); ++v) {
    below[v] = sheet.rim[v] ? static_cast<Index>(v) : static_cast<Index>(points.size());
    if (sheet.rim[v])
      made.rim.push_back(v);
    else
      points.push_back(sheet.points[v]);
  }
  made.top = 0;
  made.bottom = below[0];
  made.mesh.vertices.resize(points.size(), 3);
  for (std::size_t v = 0; v < points.size(); ++v) made.mesh.vertices.row(v) = points[v].transpose();
  made.mesh.triangles = sheet.triangles;
  for (const Triangle& t : sheet.triangles) made.mesh.triangles.push_back({below[t[0]], below[t[2]], below[t[1]]});
  return made;
}

inline double across(const Pillow& made, const Points& positions) {
  return (positions.row(made.top) - positions.row(made.bottom)).norm();
}

/// An isotropic film on a region that wrinkles [mm, MPa].
inline std::shared_ptr<const LayerSpec> film_layer(const std::string& region, double thickness_mm, double modulus) {
  LayerSpec film;
  film.name = "film";
  film.where = RegionRef{region, {}};
  film.thickness_mm = thickness_mm;
  film.e1 = film.e2 = modulus;
  film.nu12 = 0.3;
  film.g12 = film.e1 / 2.6;
  film.tension_only = true;
  return std::make_shared<const LayerSpec>(film);
}

/// Film of E t = 250 N/mm that wrinkles, held at the middle of its underside and so that it cannot turn.
inline RobotSpec film_robot(const Pillow& made, Control control = Control::load, double high = 5) {
  RobotSpec spec;
  spec.name = "pillow.yaml";
  spec.formulation = Formulation::physical;
  spec.mesh = made.mesh;
  spec.layers.push_back(film_layer("all", 0.05, 5000));
  const auto one = [](Index v) { return RegionRef{Selector(VertexList{{v}}), {}}; };
  spec.fixed = {{one(made.bottom), {true, true, true}},
                {one(made.rim[0]), {false, true, true}},
                {one(made.rim[made.rim.size() / 4]), {false, false, true}}};
  ActuatorSpec air;
  air.name = "air";
  air.drive = PneumaticSpec{.wall = "all"};
  air.control = control;
  air.low = control == Control::filling ? 1 : 0;
  air.high = high;
  air.rest = 0;
  if (control == Control::filling) air.as<PneumaticSpec>()->filling = FillingSpec{};
  spec.actuators.push_back(air);
  return spec;
}

}  // namespace softkin::testing
