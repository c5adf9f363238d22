#include <set>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/mesh_report.hpp>
#include <softkin/io/mesh/vtk.hpp>

#include "fuzz/targets.hpp"

namespace softkin::fuzz {

namespace {

template <class Cells>
void check_vertices(const Cells& cells, Index vertices) {
  for (const auto& cell : cells)
    for (const Index v : cell) require(v >= 0 && v < vertices, "a cell has a vertex that is not there");
}

void check_list(const std::vector<Index>& list, std::size_t end) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    require(list[i] >= 0 && static_cast<std::size_t>(list[i]) < end, "a region holds what is not there");
    require(i == 0 || list[i - 1] < list[i], "a region is not ascending");
  }
}

void check(const Mesh& mesh) {
  const Index vertices = mesh.vertices.rows();
  require(mesh.vertices.allFinite(), "a coordinate is not finite");
  require(!mesh.tetrahedra.empty() || !mesh.prisms.empty() || !mesh.triangles.empty(), "a mesh without elements");
  check_vertices(mesh.tetrahedra, vertices);
  check_vertices(mesh.edge_nodes, vertices);
  check_vertices(mesh.prisms, vertices);
  check_vertices(mesh.triangles, vertices);
  check_vertices(mesh.quads, vertices);
  require(mesh.edge_nodes.empty() || (mesh.edge_nodes.size() == mesh.tetrahedra.size() && mesh.prisms.empty()),
          "elements of two orders");
  std::set<std::string> names;
  for (const Region& region : mesh.regions) {
    require(names.insert(region.name).second, "two regions of one name");
    require(region.dimension >= 0 && region.dimension <= 3, "a region of no dimension");
    check_list(region.tetrahedra, mesh.tetrahedra.size());
    check_list(region.prisms, mesh.prisms.size());
    check_list(region.triangles, mesh.triangles.size());
    check_list(region.quads, mesh.quads.size());
    check_list(region.vertices, vertices);
  }
}

bool same(const Mesh& a, const Mesh& b) {
  if (a.vertices.rows() != b.vertices.rows() || a.vertices != b.vertices) return false;
  if (a.tetrahedra != b.tetrahedra || a.edge_nodes != b.edge_nodes || a.prisms != b.prisms) return false;
  if (a.triangles != b.triangles || a.quads != b.quads || a.regions.size() != b.regions.size()) return false;
  for (std::size_t i = 0; i < a.regions.size(); ++i) {
    const Region &r = a.regions[i], &s = b.regions[i];
    if (r.name != s.name || r.tetrahedra != s.tetrahedra || r.prisms != s.prisms || r.triangles != s.triangles ||
        r.quads != s.quads || r.vertices != s.vertices)
      return false;
  }
  return true;
}

/// What was read comes back out of a file that is written of it.
void run_gmsh(const Input& input) {
  const Mesh mesh = read_gmsh(input.file("mesh.msh"));
  check(mesh);
  for (const bool binary : {true, false}) {
    write_gmsh(input.path("again.msh"), mesh, binary);  // refuses names that Gmsh does not know
    Mesh again;
    try {
      again = read_gmsh(input.path("again.msh"));
    } catch (const InvalidInput& error) {
      require(false, error.what());
    }
    require(same(mesh, again), "a written mesh reads otherwise");
  }
}

template <Mesh (*read)(const std::filesystem::path&)>
void run_reader(const Input& input) {
  check(read(input.file("mesh.any")));
}

void run_abaqus(const Input& input) {
  (void)input.file("more.inp", 1);  // which the deck may include
  check(read_abaqus(input.file("mesh.inp")));
}

void run_tetgen(const Input& input) {
  (void)input.file("mesh.ele", 1);
  (void)input.file("mesh.face", 2);
  check(read_tetgen(input.file("mesh.node")));
}

void run_tet(const Input& input) {
  (void)input.file("mesh_chamber.txt", 1);
  (void)input.file("mesh_rigid_handle.txt", 2);
  check(read_tet(input.file("mesh.tet")));
}

void check(const TriangleSurface& surface) {
  require(surface.vertices.allFinite(), "a coordinate is not finite");
  check_vertices(surface.triangles, surface.vertices.rows());
}

/// A surface in single precision, which is what a first copy has, is copied exactly.
void run_stl(const Input& input) {
  const TriangleSurface surface = read_stl(input.file("mesh.stl"));
  check(surface);
  write_stl(input.path("copy.stl"), surface.vertices, surface.triangles);
  const TriangleSurface copy = read_stl(input.path("copy.stl"));
  check(copy);
  write_stl(input.path("again.stl"), copy.vertices, copy.triangles);
  const TriangleSurface again = read_stl(input.path("again.stl"));
  require(copy.vertices == again.vertices && copy.triangles == again.triangles, "a copied surface reads otherwise");
}

/// Reads a surface whose format is determined from its content.
void run_surface(const Input& input) {
  const TriangleSurface surface = read_surface(input.file("surface.any"));
  check(surface);
  require(!surface.triangles.empty(), "a surface without faces");
}

/// What `softkin mesh` does with a mesh: measures it, looks for faults, writes it in every form.
void run_review(const Input& input) {
  const std::string file = input.file("mesh.msh").string();
  (void)to_json(mesh_info(file, "mm"));
  (void)to_json(mesh_verdict(file, "mm"));
  for (const char* copy : {"copy.vtu", "copy.stl", "copy.msh"}) {
    try {
      (void)convert_mesh(file, input.path(copy).string(), false);
    } catch (const InvalidInput&) {  // a form may refuse what another takes
    }
  }
}

}  // namespace

std::vector<Target> mesh_targets() {
  return {{"gmsh", "gmsh.dict", run_gmsh},
          {"vtk", "vtk.dict", run_reader<read_vtk>},
          {"vtu", "vtk.dict", run_reader<read_vtu>},
          {"medit", "text_meshes.dict", run_reader<read_medit>},
          {"tetgen", "text_meshes.dict", run_tetgen},
          {"abaqus", "text_meshes.dict", run_abaqus},
          {"tet", "text_meshes.dict", run_tet},
          {"stl", "text_meshes.dict", run_stl},
          {"surface", "surfaces.dict", run_surface},
          {"mesh_review", "gmsh.dict", run_review}};
}

}  // namespace softkin::fuzz
