#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <softkin/model/robot_spec.hpp>
#include <vector>

namespace softkin::testing {

/// Triangles of a plane or a closed surface, to be repeated in layers.
struct Footprint {
  Points vertices;
  std::vector<Triangle> triangles;
};

/// Returns a disc of radius 1 around the origin, of rings with equal numbers of corners; a hole leaves its middle
/// empty.
inline Footprint disc(int corners, int rings, double hole = 0) {
  Footprint plan;
  plan.vertices = Points::Zero(1 + corners * (hole > 0 ? rings + 1 : rings), 3);
  const auto at = [&](int ring, int corner) { return static_cast<Index>(1 + corners * ring + corner % corners); };
  const int circles = hole > 0 ? rings + 1 : rings;
  for (int r = 0; r < circles; ++r)
    for (int c = 0; c < corners; ++c) {
      const double radius = hole > 0 ? hole + (1 - hole) * r / rings : (r + 1.0) / rings;
      const double angle = 2 * std::numbers::pi * c / corners;
      plan.vertices.row(at(r, c)) << radius * std::cos(angle), radius * std::sin(angle), 0;
    }
  for (int c = 0; c < corners; ++c) {
    if (!(hole > 0)) plan.triangles.push_back({0, at(0, c), at(0, c + 1)});
    for (int r = 0; r + 1 < circles; ++r) {
      plan.triangles.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1)});
      plan.triangles.push_back({at(r, c), at(r + 1, c + 1), at(r, c + 1)});
    }
  }
  return plan;
}

/// Cuts each triangle on the sphere of radius 1 in four, so often.
inline Footprint cut_on_ball(std::vector<Vec3> at, std::vector<Triangle> triangles, int cuts) {
  Footprint plan;
  plan.triangles = std::move(triangles);
  for (int cut = 0; cut < cuts; ++cut) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [found, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(at.size()));
      if (fresh) at.push_back((at[a] + at[b]).normalized());
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : plan.triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    plan.triangles = finer;
  }
  plan.vertices.resize(at.size(), 3);
  for (std::size_t i = 0; i < at.size(); ++i) plan.vertices.row(i) = at[i].transpose();
  return plan;
}

/// A sphere of radius 1: an icosahedron whose faces are cut in four so often.
inline Footprint ball_surface(int cuts) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> at{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                       {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& p : at) p.normalize();
  return cut_on_ball(std::move(at),
                     {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}},
                     cuts);
}

/// Returns its half above z = 0, of a pyramid with a number of sides.
inline Footprint dome_surface(int sides, int cuts) {
  std::vector<Vec3> at;
  std::vector<Triangle> triangles;
  for (Index i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    at.emplace_back(std::cos(angle), std::sin(angle), 0);
    triangles.push_back({i, (i + 1) % sides, static_cast<Index>(sides)});
  }
  at.emplace_back(0, 0, 1);
  return cut_on_ball(std::move(at), std::move(triangles), cuts);
}

/// Layers of prisms over a footprint, each of three tetrahedra, at the places place(vertex's place, layer over the
/// number of layers). What is no vertex of a triangle stays in the mesh, of no element.
template <class Place>
Mesh layered(const Footprint& plan, int layers, const Place& place) {
  Mesh mesh;
  const Index each = plan.vertices.rows();
  mesh.vertices.resize(each * (layers + 1), 3);
  for (int k = 0; k <= layers; ++k)
    for (Index v = 0; v < each; ++v)
      mesh.vertices.row(k * each + v) =
          place(Vec3(plan.vertices.row(v).transpose()), static_cast<double>(k) / layers).transpose();
  for (int k = 0; k < layers; ++k)
    for (Triangle t : plan.triangles) {
      std::sort(t.begin(), t.end());  // so that neighbours share their diagonals
      const auto [a, b, c] = t;
      const Index low = k * each, high = low + each;
      for (Tetrahedron tet :
           {Tetrahedron{a + low, b + low, c + low, c + high}, Tetrahedron{a + low, b + low, b + high, c + high},
            Tetrahedron{a + low, a + high, b + high, c + high}}) {
        if (signed_volume(mesh.vertices, tet) < 0) std::swap(tet[2], tet[3]);
        mesh.tetrahedra.push_back(tet);
      }
    }
  Region body;
  body.name = "body";
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) body.tetrahedra.push_back(i);
  mesh.regions.push_back(std::move(body));
  return mesh;
}

/// A rod of radius r along x, or a tube where hole is above 0 (inner over outer radius).
inline Mesh rod_mesh(int corners, int rings, int layers, double radius, double length, double hole = 0) {
  return layered(disc(corners, rings, hole), layers,
                 [&](const Vec3& p, double along) { return Vec3(along * length, radius * p.x(), radius * p.y()); });
}

/// A ball around a hollow.
inline Mesh shell_mesh(int cuts, int layers, double inner, double outer) {
  return layered(ball_surface(cuts), layers,
                 [&](const Vec3& p, double across) { return Vec3((inner + across * (outer - inner)) * p); });
}

}  // namespace softkin::testing
