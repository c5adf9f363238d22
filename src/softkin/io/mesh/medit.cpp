#include <set>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/mesh/text_meshes.hpp>
#include <softkin/model/mesh/element_order.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

namespace {

/// Sections whose content softkin does not need: numbers per entry.
const std::map<std::string, std::size_t>& skipped_sections() {
  static const std::map<std::string, std::size_t> sections = {{"Corners", 1},
                                                              {"RequiredVertices", 1},
                                                              {"ParallelVertices", 1},
                                                              {"Edges", 3},
                                                              {"EdgesP2", 4},
                                                              {"Ridges", 1},
                                                              {"RequiredEdges", 1},
                                                              {"ParallelEdges", 1},
                                                              {"RequiredTriangles", 1},
                                                              {"ParallelTriangles", 1},
                                                              {"RequiredQuadrilaterals", 1},
                                                              {"ParallelQuadrilaterals", 1},
                                                              {"RequiredTetrahedra", 1},
                                                              {"Normals", 3},
                                                              {"NormalAtVertices", 2},
                                                              {"NormalAtTriangleVertices", 3},
                                                              {"NormalAtQuadrilateralVertices", 3},
                                                              {"Tangents", 3},
                                                              {"TangentAtVertices", 2},
                                                              {"TangentAtEdges", 3}};
  return sections;
}

std::vector<std::string> known_sections() {
  std::vector<std::string> names = {"Dimension", "Vertices",    "Tetrahedra",     "TetrahedraP2", "Prisms",
                                    "Triangles", "TrianglesP2", "Quadrilaterals", "End"};
  for (const auto& [name, numbers] : skipped_sections()) names.push_back(name);
  return names;
}

class MeditReader {
 public:
  explicit MeditReader(const std::filesystem::path& path)
      : content_(read_without_comments(path)), scanner_(path.string(), content_) {}

  Mesh read() {
    scanner_.expect("MeshVersionFormatted");
    (void)scanner_.integer("MeshVersionFormatted", 0, 4);
    for (std::string name(scanner_.token("End")); name != "End"; name = scanner_.token("End")) read_section(name);
    expect_elements(mesh_, scanner_);
    const std::string refusal =
        refusal_of_orders(mesh_.tetrahedra.size(), mesh_.edge_nodes.size(), mesh_.prisms.size());
    if (!refusal.empty()) scanner_.fail(refusal);
    expect_end(scanner_);
    append_regions(mesh_, std::move(volumes_), "ref_", 3);
    append_regions(mesh_, std::move(surfaces_), "surface_ref_", 2);
    return std::move(mesh_);
  }

 private:
  void read_section(const std::string& name) {
    if (!seen_.insert(name).second) scanner_.fail("section " + name + " appears a second time");
    const auto skipped = skipped_sections().find(name);
    if (name == "Dimension")
      read_dimension();
    else if (name == "Vertices")
      read_vertices();
    else if (name == "Tetrahedra")
      read_elements("tetrahedra", mesh_.tetrahedra, volumes_, &Region::tetrahedra);
    else if (name == "TetrahedraP2")
      read_elements("tetrahedra of order 2", mesh_.tetrahedra, volumes_, &Region::tetrahedra, 10, &mesh_.edge_nodes);
    else if (name == "Prisms")
      read_elements("prisms", mesh_.prisms, volumes_, &Region::prisms);
    else if (name == "Triangles")
      read_elements("triangles", mesh_.triangles, surfaces_, &Region::triangles);
    else if (name == "TrianglesP2")
      read_elements("triangles of order 2", mesh_.triangles, surfaces_, &Region::triangles, 6);
    else if (name == "Quadrilaterals")
      read_elements("quadrilaterals", mesh_.quads, surfaces_, &Region::quads);
    else if (skipped != skipped_sections().end())
      skip_numbers(skipped->first, skipped->second);
    else
      refuse_section(name);
  }

  void read_dimension() {
    if (scanner_.integer("Dimension", 1, 3) != 3) scanner_.fail("only meshes of Dimension 3 are read");
  }

  void read_vertices() {
    if (!seen_.contains("Dimension")) scanner_.fail("Dimension must stand before Vertices");
    const Index count = read_count(scanner_, "vertices", 1, 8);
    mesh_.vertices.resize(count, 3);
    for (Index i = 0; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) mesh_.vertices(i, axis) = scanner_.real("coordinate");
      (void)read_label(scanner_, "vertex reference");
    }
  }

  /// Appends elements of so many nodes by their K corners; the nodes after them are on edges, in softkin's order.
  template <std::size_t K>
  void read_elements(const char* what, std::vector<std::array<Index, K>>& elements, LabelledRegions& regions,
                     std::vector<Index> Region::*members, std::size_t nodes = K,
                     std::vector<EdgeNodes>* edge_nodes = nullptr) {
    if (!seen_.contains("Vertices")) scanner_.fail(std::string("Vertices must stand before ") + what);
    const Index count = read_count(scanner_, what, 0, 2 * (nodes + 1));
    for (Index i = 0; i < count; ++i) {
      std::array<Index, K> corners;
      for (Index& vertex : corners) vertex = read_vertex();
      EdgeNodes others{};
      for (std::size_t k = K; k < nodes; ++k) others[k - K] = read_vertex();
      (regions[read_label(scanner_, "reference")].*members).push_back(static_cast<Index>(elements.size()));
      elements.push_back(corners);
      if (edge_nodes != nullptr) edge_nodes->push_back(others);
    }
  }

  Index read_vertex() {
    return read_index(scanner_, "vertex number", 1, static_cast<Index>(mesh_.vertices.rows())) - 1;
  }

  void skip_numbers(const std::string& name, std::size_t numbers) {
    const auto count = static_cast<std::size_t>(read_count(scanner_, name.c_str(), 0, 2 * numbers));
    for (std::size_t i = 0; i < count * numbers; ++i) (void)scanner_.real(name.c_str());
  }

  void refuse_section(const std::string& name) {
    if (name == "Hexahedra" || name == "Pyramids") {
      const Origin origin = scanner_.here();
      if (read_count(scanner_, name.c_str(), 0, 2) == 0) return;
      throw InvalidInput(origin, name + " are not supported, only tetrahedra and prisms");
    }
    if (name.ends_with("Ordering"))
      scanner_.fail(name + " is not supported: edge nodes are read in the usual order, edges 12, 23, 13, 14, 24, 34");
    if (name.size() > 2 && name[name.size() - 2] == 'P' && name.back() >= '2' && name.back() <= '4')
      scanner_.fail(name + ": elements of this order are not supported");
    scanner_.fail("unknown section '" + name.substr(0, 40) + "'" + suggest_name(name.substr(0, 40), known_sections()));
  }

  std::string content_;
  Scanner scanner_;
  Mesh mesh_;
  std::set<std::string> seen_;
  LabelledRegions volumes_, surfaces_;
};

}  // namespace

Mesh read_medit(const std::filesystem::path& path) {
  return MeditReader(path).read();
}

}  // namespace softkin
