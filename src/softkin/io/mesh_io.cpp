#include <softkin/core/error.hpp>
#include <softkin/io/gmsh.hpp>
#include <softkin/io/mesh_io.hpp>
#include <softkin/io/stl.hpp>
#include <softkin/io/text_mesh_tools.hpp>
#include <softkin/io/text_meshes.hpp>
#include <softkin/io/vtk.hpp>
#include <softkin/model/boundary.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse_extension(const fs::path& path, const std::string& known) {
  throw InvalidInput({path.string()},
                     "unknown mesh file extension '" + path.extension().string() + "'; known: " + known);
}

/// A cell that several volume regions name keeps the first of them.
VtuContent vtu_content(const Mesh& mesh) {
  VtuContent content;
  content.points = mesh.vertices;
  content.tetrahedra = mesh.tetrahedra;
  content.prisms = mesh.prisms;
  content.cell_regions.assign(mesh.tetrahedra.size() + mesh.prisms.size(), -1);
  for (const Region& region : mesh.regions) {
    if (region.dimension != 3) continue;
    const auto number = static_cast<Index>(content.region_names.size());
    content.region_names.push_back(region.name);
    const auto mark = [&](std::size_t cell) {
      if (content.cell_regions[cell] < 0) content.cell_regions[cell] = number;
    };
    for (const Index i : region.tetrahedra) mark(static_cast<std::size_t>(i));
    for (const Index i : region.prisms) mark(mesh.tetrahedra.size() + static_cast<std::size_t>(i));
  }
  if (content.region_names.empty()) content.cell_regions.clear();
  return content;
}

void write_boundary(const fs::path& path, const Mesh& mesh) {
  std::vector<Tetrahedron> tetrahedra = mesh.tetrahedra;
  std::vector<Prism> prisms = mesh.prisms;
  for (Tetrahedron& t : tetrahedra)
    if (signed_volume(mesh.vertices, t) < 0) std::swap(t[2], t[3]);
  for (Prism& p : prisms)
    if (signed_volume(mesh.vertices, p) < 0) p = {p[3], p[4], p[5], p[0], p[1], p[2]};
  write_stl(path, mesh.vertices, triangulated(boundary_of(tetrahedra, prisms)));
}

}  // namespace

Mesh read_mesh(const fs::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".msh") return read_gmsh(path);
  if (extension == ".vtk") return read_vtk(path);
  if (extension == ".vtu") return read_vtu(path);
  if (extension == ".mesh") return read_medit(path);
  if (extension == ".node" || extension == ".ele") return read_tetgen(path);
  if (extension == ".inp") return read_abaqus(path);
  if (extension == ".tet") return read_tet(path);
  refuse_extension(path, ".msh, .vtk, .vtu, .mesh, .node, .ele, .inp, .tet");
}

void write_mesh(const fs::path& path, const Mesh& mesh) {
  const std::string extension = lower_extension(path);
  if (extension == ".msh") return write_gmsh(path, mesh);
  if (extension == ".vtu") return write_vtu(path, vtu_content(mesh));
  if (extension == ".stl") return write_boundary(path, mesh);
  refuse_extension(path, ".msh, .vtu, .stl");
}

}  // namespace softkin
