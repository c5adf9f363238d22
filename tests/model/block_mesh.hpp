#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/robot_spec.hpp>
#include <string>
#include <tuple>
#include <vector>

namespace softkin::testing {

enum class Split { five, six, prisms };  // tetrahedra or prisms (extruded along z) per cell

inline Index grid_vertex(const std::array<int, 3>& cells, int i, int j, int k) {
  return i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
}

inline Points grid_points(const std::array<int, 3>& cells, const Vec3& size) {
  Points points((cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1), 3);
  for (int k = 0; k <= cells[2]; ++k)
    for (int j = 0; j <= cells[1]; ++j)
      for (int i = 0; i <= cells[0]; ++i)
        points.row(grid_vertex(cells, i, j, k)) << size[0] * i / cells[0], size[1] * j / cells[1],
            size[2] * k / cells[2];
  return points;
}

/// Appends the elements of one cell; corner c of the cell is at (c & 1, c >> 1 & 1, c >> 2).
inline void split_cell(const std::array<Index, 8>& v, Split split, bool odd, Mesh& mesh) {
  if (split == Split::prisms) {
    mesh.prisms.push_back({v[0], v[1], v[3], v[4], v[5], v[7]});
    mesh.prisms.push_back({v[0], v[3], v[2], v[4], v[7], v[6]});
  } else if (split == Split::five) {
    const int mirror = odd ? 1 : 0;  // neighbours share face diagonals
    const auto add = [&](int a, int b, int c, int d) {
      Tetrahedron t{v[a ^ mirror], v[b ^ mirror], v[c ^ mirror], v[d ^ mirror]};
      if (odd) std::swap(t[2], t[3]);
      mesh.tetrahedra.push_back(t);
    };
    add(0, 1, 2, 4);
    add(3, 2, 1, 7);
    add(5, 1, 4, 7);
    add(6, 2, 7, 4);
    add(1, 2, 4, 7);
  } else {
    for (const auto& [a, b, positive] : {std::tuple(1, 2, true), std::tuple(2, 4, true), std::tuple(4, 1, true),
                                         std::tuple(2, 1, false), std::tuple(4, 2, false), std::tuple(1, 4, false)})
      mesh.tetrahedra.push_back(positive ? Tetrahedron{v[0], v[a], v[a | b], v[7]}
                                         : Tetrahedron{v[0], v[a | b], v[a], v[7]});
  }
}

/// Returns elements alone; the lowest layer of cells may be split differently, unless one of the splits is `five`.
[[nodiscard]] inline Mesh layered_mesh(const std::array<int, 3>& cells, const Vec3& size, Split above,
                                       Split lowest = Split::prisms) {
  Mesh mesh;
  mesh.vertices = grid_points(cells, size);
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        std::array<Index, 8> corners{};
        for (int c = 0; c < 8; ++c) corners[c] = grid_vertex(cells, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        split_cell(corners, k == 0 ? lowest : above, (i + j + k) % 2 != 0, mesh);
      }
  return mesh;
}

inline void add_face_regions(Mesh& mesh, const Vec3& size) {
  const Boundary boundary = boundary_of(mesh.tetrahedra, mesh.prisms);
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      Region face;
      face.name = std::string(1, "xyz"[axis]) + (high ? "_high" : "_low");
      face.dimension = 2;
      const auto on_face = [&](const auto& cell) {
        return std::all_of(cell.begin(), cell.end(), [&](Index v) {
          return std::abs(mesh.vertices(v, axis) - (high ? size[axis] : 0)) < 1e-9 * size[axis];
        });
      };
      for (const Triangle& t : boundary.triangles)
        if (on_face(t)) {
          face.triangles.push_back(mesh.triangles.size());
          mesh.triangles.push_back(t);
        }
      for (const Quad& q : boundary.quads)
        if (on_face(q)) {
          face.quads.push_back(mesh.quads.size());
          mesh.quads.push_back(q);
        }
      mesh.regions.push_back(std::move(face));
    }
}

/// A box of cells[0] x cells[1] x cells[2] cells from the origin to size [mm], split conformingly. Vertices run along
/// x first, then y, then z. Regions: "body" (all elements) and the faces "x_low", "x_high", "y_low", ... as cells.
[[nodiscard]] inline Mesh block_mesh(const std::array<int, 3>& cells, const Vec3& size, Split split = Split::six) {
  Mesh mesh = layered_mesh(cells, size, split, split);
  Region body;
  body.name = "body";
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) body.tetrahedra.push_back(i);
  for (std::size_t i = 0; i < mesh.prisms.size(); ++i) body.prisms.push_back(i);
  mesh.regions.push_back(std::move(body));
  add_face_regions(mesh, size);
  return mesh;
}

/// Adds the volume region of all elements whose centroid `inside` accepts.
template <class Inside>
void add_volume_region(Mesh& mesh, const std::string& name, const Inside& inside) {
  const auto centroid = [&](const auto& element) {
    Vec3 sum = Vec3::Zero();
    for (const Index v : element) sum += mesh.vertices.row(v).transpose();
    return Vec3(sum / static_cast<double>(element.size()));
  };
  Region region;
  region.name = name;
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i)
    if (inside(centroid(mesh.tetrahedra[i]))) region.tetrahedra.push_back(i);
  for (std::size_t i = 0; i < mesh.prisms.size(); ++i)
    if (inside(centroid(mesh.prisms[i]))) region.prisms.push_back(i);
  mesh.regions.push_back(std::move(region));
}

/// 30 mm cube of 27 cells; region "chamber" is the middle one.
inline Mesh hollow_mesh() {
  Mesh mesh = block_mesh({3, 3, 3}, {30, 30, 30});
  add_volume_region(mesh, "chamber", [](const Vec3& p) { return (p - Vec3(15, 15, 15)).cwiseAbs().maxCoeff() < 5; });
  return mesh;
}

/// A closed surface, normals outwards.
inline TriangleSurface box_surface(const Vec3& low, const Vec3& size) {
  const Mesh box = block_mesh({1, 1, 1}, size);
  return {box.vertices.rowwise() + low.transpose(), triangulated(boundary_of(box.tetrahedra, {}))};
}

/// Adds a region of single vertices.
inline double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

inline void add_vertex_region(Mesh& mesh, const std::string& name, std::vector<Index> vertices) {
  Region region;
  region.name = name;
  region.dimension = 0;
  region.vertices = std::move(vertices);
  mesh.regions.push_back(std::move(region));
}

/// The mesh as a robot of one material (shape_ratio 1), its face x = 0 fixed, without actuators.
inline RobotSpec block_robot(Mesh mesh) {
  RobotSpec spec;
  spec.name = "block";
  spec.mesh = std::move(mesh);
  MaterialSpec material;
  material.region = "all";
  spec.materials.push_back(material);
  spec.fixed.push_back({{std::string("x_low"), {}}, {true, true, true}});
  return spec;
}

}  // namespace softkin::testing
