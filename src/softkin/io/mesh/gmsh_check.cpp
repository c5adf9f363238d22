#include <set>
#include <softkin/io/mesh/gmsh_write.hpp>

namespace softkin::gmsh {

namespace {

constexpr std::size_t kLongestName = 127;  // of the MSH format

std::string problem_of_name(const std::string& name) {
  if (name.empty()) return "a region has no name";
  if (name.size() > kLongestName) return "region name '" + name + "' is longer than the 127 bytes of a Gmsh name";
  if (is_unquotable(name)) return "a region name holds '\"' or a control character";
  return "";
}

std::string problem_of_list(const Region& region, const std::vector<Index>& list, std::size_t cells, bool fits,
                            const std::string& what) {
  const std::string who = "region '" + region.name + "' of dimension " + std::to_string(region.dimension);
  if (!list.empty() && !fits) return who + " cannot list " + what;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i] < 0 || static_cast<std::size_t>(list[i]) >= cells)
      return who + " lists number " + std::to_string(list[i]) + " of " + std::to_string(cells) + " " + what;
    if (i > 0 && list[i] <= list[i - 1]) return who + " must list " + what + " in ascending order, each once";
  }
  return "";
}

std::string problem_of_region(const Mesh& mesh, const Region& region) {
  std::string problem = problem_of_name(region.name);
  const int d = region.dimension;
  if (problem.empty() && (d < 0 || d > 3)) problem = "region '" + region.name + "' has dimension " + std::to_string(d);
  const auto check = [&](const std::vector<Index>& list, std::size_t cells, bool fits, const char* what) {
    if (problem.empty()) problem = problem_of_list(region, list, cells, fits, what);
  };
  check(region.tetrahedra, mesh.tetrahedra.size(), d == 3, "tetrahedra");
  check(region.prisms, mesh.prisms.size(), d == 3, "prisms");
  check(region.triangles, mesh.triangles.size(), d == 2, "triangles");
  check(region.quads, mesh.quads.size(), d == 2, "quads");
  check(region.vertices, static_cast<std::size_t>(mesh.vertices.rows()), d < 2, "vertices");
  return problem;
}

template <std::size_t N>
std::string problem_of_cells(const std::vector<std::array<Index, N>>& cells, Eigen::Index vertices, const char* what) {
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (const Index v : cells[i])
      if (v < 0 || v >= vertices)
        return std::string(what) + " " + std::to_string(i) + " has vertex " + std::to_string(v) + " of " +
               std::to_string(vertices);
  return "";
}

}  // namespace

std::string problem_of(const Mesh& mesh) {
  const Eigen::Index n = mesh.vertices.rows();
  if (!mesh.vertices.allFinite()) return "a vertex has a coordinate that is not finite";
  if (mesh.tetrahedra.empty() && mesh.prisms.empty()) return "the mesh has no volume elements";
  std::string problem = problem_of_cells(mesh.tetrahedra, n, "tetrahedron");
  if (problem.empty()) problem = problem_of_cells(mesh.edge_nodes, n, "tetrahedron");
  if (problem.empty()) problem = refusal_of_orders(mesh.tetrahedra.size(), mesh.edge_nodes.size(), mesh.prisms.size());
  if (problem.empty()) problem = problem_of_cells(mesh.prisms, n, "prism");
  if (problem.empty()) problem = problem_of_cells(mesh.triangles, n, "triangle");
  if (problem.empty()) problem = problem_of_cells(mesh.quads, n, "quad");
  std::set<std::string> names;
  for (const Region& region : mesh.regions) {
    if (problem.empty()) problem = problem_of_region(mesh, region);
    if (problem.empty() && !names.insert(region.name).second)
      problem = "two regions have the name '" + region.name + "'";
  }
  return problem;
}

}  // namespace softkin::gmsh
