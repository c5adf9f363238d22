#pragma once

#include <algorithm>
#include <string>

#include "model/block_mesh.hpp"

namespace softkin::testing {

/// Adds the region "wall": the faces of the elements of a region that are not faces of the whole mesh, so that the
/// chamber that they bound is open where it ends at the mesh's boundary.
inline void add_open_wall(Mesh& mesh, const std::string& chamber) {
  const auto sorted = [](Triangle t) {
    std::sort(t.begin(), t.end());
    return t;
  };
  std::vector<Triangle> outside;
  for (const Triangle& t : boundary_of(mesh.tetrahedra, {}).triangles) outside.push_back(sorted(t));
  std::sort(outside.begin(), outside.end());
  std::vector<Tetrahedron> inside;
  for (const Region& region : mesh.regions)
    if (region.name == chamber)
      for (const Index i : region.tetrahedra) inside.push_back(mesh.tetrahedra[i]);
  Region wall;
  wall.name = "wall";
  wall.dimension = 2;
  for (Triangle t : boundary_of(inside, {}).triangles) {
    if (std::binary_search(outside.begin(), outside.end(), sorted(t))) continue;
    if (wall.triangles.size() % 3 == 0) std::swap(t[0], t[1]);  // groups of faces are turned at random
    wall.triangles.push_back(mesh.triangles.size());
    mesh.triangles.push_back(t);
  }
  mesh.regions.push_back(wall);
}

}  // namespace softkin::testing
