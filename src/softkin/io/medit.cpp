#include <set>
#include <softkin/io/text_mesh_tools.hpp>
#include <softkin/io/text_meshes.hpp>
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
  std::vector<std::string> names = {"Dimension", "Vertices",       "Tetrahedra", "Prisms",
                                    "Triangles", "Quadrilaterals", "End"};
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
    else if (name == "Prisms")
      read_elements("prisms", mesh_.prisms, volumes_, &Region::prisms);
    else if (name == "Triangles")
      read_elements("triangles", mesh_.triangles, surfaces_, &Region::triangles);
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

  template <std::size_t K>
  void read_elements(const char* what, std::vector<std::array<Index, K>>& elements, LabelledRegions& regions,
                     std::vector<Index> Region::*members) {
    if (!seen_.contains("Vertices")) scanner_.fail(std::string("Vertices must stand before ") + what);
    const Index count = read_count(scanner_, what, 0, 2 * (K + 1));
    elements.resize(static_cast<std::size_t>(count));
    for (Index i = 0; i < count; ++i) {
      for (Index& vertex : elements[static_cast<std::size_t>(i)])
        vertex = read_index(scanner_, "vertex number", 1, static_cast<Index>(mesh_.vertices.rows())) - 1;
      (regions[read_label(scanner_, "reference")].*members).push_back(i);
    }
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
    if (name.size() > 2 && name[name.size() - 2] == 'P' && name.back() >= '2' && name.back() <= '4')
      scanner_.fail(name + ": elements of higher order are not supported");
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
