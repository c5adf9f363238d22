#include <algorithm>
#include <map>
#include <set>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

namespace {

/// Sections whose content softkin does not need, by the numbers per entry.
const std::map<std::size_t, std::set<std::string>>& skipped_sections() {
  static const std::map<std::size_t, std::set<std::string>> sections = {
      {1,
       {"Corners", "RequiredVertices", "ParallelVertices", "Ridges", "RequiredEdges", "ParallelEdges",
        "RequiredTriangles", "ParallelTriangles", "RequiredQuadrilaterals", "ParallelQuadrilaterals",
        "RequiredTetrahedra"}},
      {2, {"NormalAtVertices", "TangentAtVertices"}},
      {3,
       {"Edges", "Normals", "NormalAtTriangleVertices", "NormalAtQuadrilateralVertices", "Tangents", "TangentAtEdges"}},
      {4, {"EdgesP2"}}};
  return sections;
}

std::vector<std::string> known_sections() {
  std::vector<std::string> names = {"Dimension", "Vertices",    "Tetrahedra",     "TetrahedraP2", "Prisms",
                                    "Triangles", "TrianglesP2", "Quadrilaterals", "End"};
  std::set<std::string> skipped;
  for (const auto& [numbers, sections] : skipped_sections()) skipped.insert(sections.begin(), sections.end());
  names.insert(names.end(), skipped.begin(), skipped.end());
  return names;
}

class MeditReader {
 public:
  explicit MeditReader(const std::filesystem::path& path)
      : content_(read_without_comments(path)), scanner_(path.string(), content_) {}

  Mesh read() {
    scanner_.expect("MeshVersionFormatted");
    (void)scanner_.integer("MeshVersionFormatted", 0, 4);
    while (!scanner_.at_end()) {  // many write no End: sections are complete by their counts
      const std::string name(scanner_.token("End"));
      if (name == "End") {
        expect_end(scanner_);
        break;
      }
      read_section(name);
    }
    if (mesh_.tetrahedra.empty() && mesh_.prisms.empty() && mesh_.triangles.empty())
      scanner_.fail(missing_volume(mesh_));
    const std::string refusal = refusal_of_orders(mesh_);
    if (!refusal.empty()) scanner_.fail(refusal);
    append_regions(mesh_, std::move(volumes_), "ref_", 3);
    append_regions(mesh_, std::move(surfaces_), "surface_ref_", 2);
    return std::move(mesh_);
  }

 private:
  void read_section(const std::string& name) {
    if (!seen_.insert(name).second) scanner_.fail("section " + name + " appears a second time");
    const auto skipped = std::find_if(skipped_sections().begin(), skipped_sections().end(),
                                      [&](const auto& sections) { return sections.second.contains(name); });
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
      skip_numbers(name, skipped->first);
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
      (regions[read_label(scanner_, "reference")].*members).push_back(elements.size());
      elements.push_back(corners);
      if (edge_nodes != nullptr) edge_nodes->push_back(others);
    }
  }

  Index read_vertex() { return read_index(scanner_, "vertex number", 1, mesh_.vertices.rows()) - 1; }

  void skip_numbers(const std::string& name, std::size_t numbers) {
    const std::size_t count = read_count(scanner_, name.c_str(), 0, 2 * numbers);
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
