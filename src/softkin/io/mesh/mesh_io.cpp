#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

namespace fs = std::filesystem;

namespace {

struct Form {
  const char *extension, *name;
  Mesh (*read)(const fs::path&);  // nullptr: surfaces only
};

constexpr Form forms[] = {
    {".msh", "Gmsh", read_gmsh},     {".vtk", "VTK legacy", read_vtk},         {".vtu", "VTK XML", read_vtu},
    {".mesh", "Medit", read_medit},  {".node", "TetGen", read_tetgen},         {".ele", "TetGen", read_tetgen},
    {".inp", "Abaqus", read_abaqus}, {".tet", "tetrahedra as text", read_tet}, {".stl", "binary STL", nullptr}};

const Form* form_of(const fs::path& path) {
  const std::string extension = lower_extension(path);
  const auto found =
      std::find_if(std::begin(forms), std::end(forms), [&](const Form& form) { return form.extension == extension; });
  return found == std::end(forms) ? nullptr : found;
}

[[noreturn]] void refuse_extension(const fs::path& path, const std::string& known) {
  throw InvalidInput({path.string()},
                     "unknown mesh file extension '" + path.extension().string() + "'; known: " + known);
}

void separate_names(std::vector<Region>& regions) {
  std::map<std::string, int> highest;
  for (const Region& region : regions) {
    int& dimension = highest.try_emplace(region.name, region.dimension).first->second;
    dimension = std::max(dimension, region.dimension);
  }
  for (Region& region : regions)
    if (region.dimension < highest[region.name]) region.name += "_" + std::to_string(region.dimension) + "d";
}

/// A cell that several regions of its dimension name keeps the first of them. Of a mesh without volume the triangles.
VtuContent vtu_content(const Mesh& mesh) {
  const bool surface = mesh.tetrahedra.empty() && mesh.prisms.empty();
  VtuContent content;
  content.points = mesh.vertices;
  content.tetrahedra = mesh.tetrahedra;
  content.edge_nodes = mesh.edge_nodes;
  content.prisms = mesh.prisms;
  if (surface) content.triangles = mesh.triangles;
  content.cell_regions.assign(mesh.tetrahedra.size() + mesh.prisms.size() + content.triangles.size(), -1);
  for (const Region& region : mesh.regions) {
    if (region.dimension != (surface ? 2 : 3)) continue;
    const Index number = content.region_names.size();
    content.region_names.push_back(region.name);
    const auto mark = [&](std::size_t cell) {
      if (content.cell_regions[cell] < 0) content.cell_regions[cell] = number;
    };
    for (const Index i : region.tetrahedra) mark(i);
    for (const Index i : region.prisms) mark(mesh.tetrahedra.size() + static_cast<std::size_t>(i));
    if (surface)
      for (const Index i : region.triangles) mark(i);
  }
  if (content.region_names.empty()) content.cell_regions.clear();
  return content;
}

void write_boundary(const fs::path& path, const Mesh& mesh) {
  std::vector<Tetrahedron> tetrahedra = mesh.tetrahedra;
  std::vector<EdgeNodes> edge_nodes = mesh.edge_nodes;
  std::vector<Prism> prisms = mesh.prisms;
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
    if (signed_volume(mesh.vertices, tetrahedra[i]) < 0) {
      std::swap(tetrahedra[i][2], tetrahedra[i][3]);
      if (!edge_nodes.empty()) exchange_corners_2_and_3(edge_nodes[i]);
    }
  for (Prism& p : prisms)
    if (signed_volume(mesh.vertices, p) < 0) p = {p[3], p[4], p[5], p[0], p[1], p[2]};
  write_stl(path, mesh.vertices,
            tetrahedra.empty() && prisms.empty() ? mesh.triangles : boundary_triangles(tetrahedra, edge_nodes, prisms));
}

}  // namespace

const std::vector<std::string>& length_units() {
  static const std::vector<std::string> units{"mm", "cm", "m", "um", "in"};
  return units;
}

double mm_per(const std::string& unit) {
  constexpr std::array<double, 5> mm{1, 10, 1000, 0.001, 25.4};
  const auto found = std::find(length_units().begin(), length_units().end(), unit);
  return mm.at(found - length_units().begin());
}

Mesh read_mesh(const fs::path& path) {
  const Form* form = form_of(path);
  if (form != nullptr && form->read != nullptr) {
    Mesh mesh = form->read(path);
    separate_names(mesh.regions);
    return mesh;
  }
  std::string known;
  for (const Form& other : forms)
    if (other.read != nullptr) known += (known.empty() ? "" : ", ") + std::string(other.extension);
  for (const char* surface : {".stl", ".obj", ".ply", ".step", ".stp", ".iges", ".igs", ".brep"})
    if (lower_extension(path) == surface)
      throw InvalidInput({path.string()},
                         std::string("a ") + surface +
                             " is a surface, and a robot's mesh has elements inside: make one of it by 'python -m "
                             "softkin mesh generate --body F' (docs/python_mesh.md), or in Gmsh; known: " +
                             known);
  refuse_extension(path, known);
}

std::string mesh_form(const fs::path& path) {
  const Form* form = form_of(path);
  return form == nullptr ? "" : form->name;
}

void write_mesh(const fs::path& path, const Mesh& mesh) {
  const std::string extension = lower_extension(path);
  if (extension == ".msh") return write_gmsh(path, mesh);
  if (extension == ".vtu") return write_vtu(path, vtu_content(mesh));
  if (extension == ".stl") return write_boundary(path, mesh);
  refuse_extension(path, ".msh, .vtu, .stl");
}

}  // namespace softkin
