#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "mesh_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

struct Check {
  int exit_code;
  json report;
};

Check check(const std::string& file, const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments{"mesh", "check", file, "--json"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.errors, "");
  const json report = json::parse(result.output);
  EXPECT_EQ(report["usable"], result.exit_code == 0);
  return {result.exit_code, report};
}

/// Count of each kind that was found.
std::map<std::string, int> counts(const json& report) {
  std::map<std::string, int> found;
  for (const json& finding : report["findings"])
    if (finding["count"] != 0) found[finding["kind"]] = finding["count"];
  return found;
}

const json& finding(const json& report, const std::string& kind) {
  for (const json& candidate : report["findings"])
    if (candidate["kind"] == kind) return candidate;
  throw std::runtime_error("no finding " + kind);
}

using Counts = std::map<std::string, int>;

/// Checks a hand-made mesh: what is found, and what the first of a kind is.
json expect_findings(const std::string& file, int exit_code, const Counts& expected) {
  const auto [code, report] = check(file);
  EXPECT_EQ(code, exit_code);
  EXPECT_EQ(counts(report), expected);
  return report;
}

json expect_findings(const GmshText& mesh, int exit_code, const Counts& expected) {
  const TemporaryFolder folder;
  return expect_findings(folder.write("sample.msh", mesh.text()), exit_code, expected);
}

TEST(MeshCheckCommand, CleanCubeIsUsable) {
  const json report = expect_findings(cube(), 0, {});
  EXPECT_EQ(report["vertices"], 8);
  EXPECT_EQ(report["tetrahedra"], 6);
  EXPECT_EQ(report["findings"].size(), 9u);
  ASSERT_EQ(report["parts"].size(), 1u);
  EXPECT_EQ(report["parts"][0]["vertices"], 8);
  EXPECT_NEAR(report["parts"][0]["volume_mm3"], 8, 1e-12);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(report["parts"][0]["centroid_mm"][axis], 1, 1e-12);
}

TEST(MeshCheckCommand, NegativeElementsAreRemarks) {
  const json report = expect_findings(tetrahedra({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}, {{0, 2, 1, 3}}), 0,
                                      {{"negative_elements", 1}});
  const json& found = finding(report, "negative_elements");
  EXPECT_EQ(found["severity"], "remark");
  EXPECT_EQ(found["first"], json::array({{{"tetrahedra", {0}}, {"position_mm", {1.0, 1.0, 1.0}}}}));
}

TEST(MeshCheckCommand, PrismsCountFromZero) {
  GmshText mesh = prism();
  mesh.elements[0].vertices = {3, 4, 5, 0, 1, 2};
  mesh.vertices.push_back({0, 0, -6});
  mesh.elements.push_back({4, 1, {0, 2, 1, 6}});
  const json report = expect_findings(mesh, 0, {{"negative_elements", 1}});
  const json& place = finding(report, "negative_elements")["first"][0];
  EXPECT_EQ(place["prisms"], json::array({0}));
  EXPECT_FALSE(place.contains("tetrahedra"));
  EXPECT_NEAR(place["position_mm"][2], 2.5, 1e-12);
}

TEST(MeshCheckCommand, DegenerateElementsBlock) {
  const json report =
      expect_findings(tetrahedra({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {8, 8, 0}}, {{0, 1, 2, 3}, {0, 1, 4, 2}}),
                      1, {{"degenerate_elements", 1}});
  const json& found = finding(report, "degenerate_elements");
  EXPECT_EQ(found["severity"], "error");
  EXPECT_EQ(found["first"], json::array({{{"tetrahedra", {1}}, {"position_mm", {3.0, 3.0, 0.0}}}}));
}

TEST(MeshCheckCommand, DuplicateElementsBlock) {
  const TemporaryFolder folder;  // Medit: the reader of Gmsh drops them itself
  const std::string file = folder.write("twice.mesh",
                                        "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n4 0 0 0\n0 4 0 0\n"
                                        "0 0 4 0\nTetrahedra 2\n1 2 3 4 1\n2 3 1 4 1\nEnd\n");
  const json report = expect_findings(file, 1, {{"duplicate_elements", 1}});
  EXPECT_EQ(finding(report, "duplicate_elements")["severity"], "error");
  EXPECT_EQ(finding(report, "duplicate_elements")["first"][0]["tetrahedra"], json::array({1}));
}

TEST(MeshCheckCommand, OverlappingElementsBlock) {
  const json report =
      expect_findings(tetrahedra({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {0, 0, 8}}, {{0, 1, 2, 3}, {0, 1, 2, 4}}),
                      1, {{"overlapping_elements", 1}});
  const json& found = finding(report, "overlapping_elements");
  EXPECT_EQ(found["severity"], "error");
  EXPECT_EQ(found["first"], json::array({{{"tetrahedra", {0, 1}}, {"position_mm", {1.0, 1.0, 1.5}}}}));
}

TEST(MeshCheckCommand, FacesOfThreeElementsBlock) {
  const json report =
      expect_findings(tetrahedra({{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {0, 0, 4}, {0, 0, 8}, {0, 0, -4}},
                                 {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 2, 1, 5}}),
                      1, {{"nonmanifold_faces", 1}, {"nonmanifold_edges", 3}, {"overlapping_elements", 1}});
  const json& found = finding(report, "nonmanifold_faces");
  EXPECT_EQ(found["severity"], "error");
  std::vector<int> vertices = found["first"][0]["vertices"];
  std::sort(vertices.begin(), vertices.end());
  EXPECT_EQ(vertices, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(found["first"][0]["position_mm"], json({2.0, 2.0, 0.0}));
}

TEST(MeshCheckCommand, QuadsOfThreePrismsBlock) {
  GmshText mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0},  {0, 3, 0},  {0, 0, 2}, {4, 0, 2},
                   {0, 3, 2}, {0, -3, 0}, {0, -3, 2}, {0, 9, 0}, {0, 9, 2}};
  mesh.elements = {{6, 1, {0, 1, 2, 3, 4, 5}}, {6, 1, {1, 0, 6, 4, 3, 7}}, {6, 1, {0, 1, 8, 3, 4, 9}}};
  const json report =
      expect_findings(mesh, 1, {{"nonmanifold_faces", 1}, {"nonmanifold_edges", 4}, {"overlapping_elements", 1}});
  EXPECT_EQ(finding(report, "nonmanifold_faces")["first"][0]["vertices"].size(), 4u);
  EXPECT_EQ(finding(report, "nonmanifold_faces")["first"][0]["position_mm"], json({2.0, 0.0, 1.0}));
  EXPECT_EQ(finding(report, "overlapping_elements")["first"][0]["prisms"], json({0, 2}));
}

TEST(MeshCheckCommand, DuplicateVerticesSeparateParts) {
  const json report = expect_findings(tetrahedra({{0, 0, 0},
                                                  {4, 0, 0},
                                                  {0, 4, 0},
                                                  {0, 0, 4},  //
                                                  {0, 0, 0},
                                                  {4, 0, 0},
                                                  {0, 4, 0},
                                                  {0, 0, -8}},
                                                 {{0, 1, 2, 3}, {4, 6, 5, 7}}),
                                      0, {{"duplicate_vertices", 3}});
  const json& found = finding(report, "duplicate_vertices");
  EXPECT_EQ(found["severity"], "warning");
  EXPECT_EQ(found["first"][1], json({{"vertices", {5}}, {"position_mm", {4.0, 0.0, 0.0}}}));
  ASSERT_EQ(report["parts"].size(), 2u);
  EXPECT_NEAR(report["parts"][1]["volume_mm3"], 4 * 4 * 8 / 6.0, 1e-12);
  EXPECT_NEAR(report["parts"][1]["centroid_mm"][2], -2, 1e-12);
}

TEST(MeshCheckCommand, HingesAreWarnings) {
  const json edge = expect_findings(
      tetrahedra({{0, 0, 0}, {0, 0, 4}, {4, 0, 0}, {0, 4, 0}, {-4, 0, 0}, {0, -4, 0}}, {{0, 2, 3, 1}, {0, 4, 5, 1}}), 0,
      {{"nonmanifold_edges", 1}});
  EXPECT_EQ(finding(edge, "nonmanifold_edges")["severity"], "warning");
  EXPECT_EQ(finding(edge, "nonmanifold_edges")["first"],
            json::array({{{"vertices", {0, 1}}, {"position_mm", {0.0, 0.0, 2.0}}}}));
  const json point =
      expect_findings(tetrahedra({{1, 2, 3}, {4, 0, 9}, {4, 4, 9}, {0, 4, 9}, {-4, 0, 0}, {0, -4, 0}, {0, 0, -4}},
                                 {{0, 1, 2, 3}, {0, 4, 5, 6}}),
                      0, {{"nonmanifold_vertices", 1}, {"negative_elements", 1}});
  EXPECT_EQ(finding(point, "nonmanifold_vertices")["severity"], "warning");
  EXPECT_EQ(finding(point, "nonmanifold_vertices")["first"],
            json::array({{{"vertices", {0}}, {"position_mm", {1.0, 2.0, 3.0}}}}));
}

TEST(MeshCheckCommand, ListsFiveAndCountsTheRest) {
  GmshText mesh = cube();
  for (int i = 0; i < 7; ++i) mesh.vertices.push_back({3.0 + i, 0, 0});
  const TemporaryFolder folder;
  const std::string file = folder.write("sample.msh", mesh.text());
  const json report = expect_findings(file, 0, {{"unreferenced_vertices", 7}});
  const json& found = finding(report, "unreferenced_vertices");
  EXPECT_EQ(found["severity"], "remark");
  ASSERT_EQ(found["first"].size(), 5u);
  EXPECT_EQ(found["first"][4], json({{"vertices", {12}}, {"position_mm", {7.0, 0.0, 0.0}}}));
  const std::string text = run_program({"mesh", "check", file, "--unit", "cm"}).output;
  EXPECT_NE(text.find("\nremark  unreferenced vertices  7  of no element"), std::string::npos) << text;
  EXPECT_NE(text.find("\n    vertex 12 at (70, 0, 0) mm\n    ... and 2 more\n1 part connected"), std::string::npos)
      << text;
  EXPECT_NE(text.find("\nok      degenerate elements    0\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n    8 vertices  8000 mm^3  centroid (10, 10, 10) mm\nusable\n"), std::string::npos) << text;
}

TEST(MeshCheckCommand, TextNamesWhatBlocks) {
  const TemporaryFolder folder;
  const std::string file = folder.write(
      "sample.msh",
      tetrahedra({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {0, 0, 8}}, {{0, 1, 2, 3}, {0, 1, 2, 4}}).text());
  const ProgramResult result = run_program({"mesh", "check", file});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("\n    tetrahedra 0, 1 at (1, 1, 1.5) mm\n"), std::string::npos) << result.output;
  EXPECT_TRUE(result.output.ends_with("\nnot usable: overlapping elements (1)\n")) << result.output;
}

std::string scene(const std::string& rest) {
  return "softkin: 1\nunits: {length: cm}\nmesh: {file: cube.msh}\nmaterials: [{shape_ratio: 1}]\n" + rest;
}

/// Counts of the kinds that only meshes of order 2 have.
Counts edge_counts(const json& report) {
  Counts found;
  for (const char* kind : {"split_edges", "shared_edge_nodes", "far_edge_nodes", "uneven_edges"})
    if (finding(report, kind)["count"] != 0) found[kind] = finding(report, kind)["count"];
  return found;
}

/// Two triangles in every file format: all commands print the same words, which suggest what to do.
TEST(MeshCheckCommand, AMeshWithoutVolumeIsNotUsable) {
  const TemporaryFolder folder;
  GmshText sheet;
  sheet.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {10, 10, 0}};
  sheet.names = {"2 1 \"skin\""};
  sheet.elements = {{2, 1, {0, 1, 2}}, {2, 1, {1, 3, 2}}};
  const std::string corners = "0 0 0 0\n10 0 0 0\n0 10 0 0\n10 10 0 0\n";
  folder.write("a.msh", sheet.text());
  folder.write("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n" + corners +
                             "Triangles\n2\n1 2 3 1\n2 4 3 1\nEnd\n");
  folder.write("a.inp",
               "*NODE\n1,0,0,0\n2,10,0,0\n3,0,10,0\n4,10,10,0\n*ELEMENT, TYPE=S3, ELSET=skin\n1,1,2,3\n2,2,4,3\n");
  folder.write("a.vtk",
               "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
               "0 0 0 10 0 0 0 10 0 10 10 0\nCELLS 2 8\n3 0 1 2\n3 1 3 2\nCELL_TYPES 2\n5 5\n");
  ASSERT_EQ(run_program({"mesh", "convert", folder / "a.msh", folder / "a.vtu"}).exit_code, 0);
  const std::string advice =
      "the mesh has triangles and no volume element: mesh it in three dimensions, with tetrahedra or prisms; where "
      "that "
      "was done, the file lacks them: in Gmsh, which saves physical groups alone where there are any, add the volume "
      "to "
      "a physical group, too, or save all elements (Mesh.SaveAll = 1); a mesh of triangles alone serves a robot of "
      "fabric or film, which the scene describes by `layers` in the physical formulation";
  const std::string rest =
      "materials:\n  - {youngs_modulus: 1, poisson_ratio: 0.4}\nfixed:\n  - {box: [[-1, -1, -1], [1, 11, 1]]}\n";
  for (const std::string form : {"msh", "vtk", "vtu", "mesh", "inp"}) {
    SCOPED_TRACE(form);
    const std::string file = folder / ("a." + form);
    const ProgramResult checked = run_program({"mesh", "check", file});
    EXPECT_EQ(checked.exit_code, 1);
    EXPECT_NE(checked.output.find("\nnot usable: " + advice + "\n"), std::string::npos) << checked.output;
    EXPECT_EQ(check(file).report["no_volume"], advice);
    const ProgramResult info = run_program({"mesh", "info", file});
    EXPECT_EQ(info.exit_code, 0);
    EXPECT_EQ(info.errors, "softkin: warning: " + file + ": " + advice + "\n");
    folder.write("s.yaml", "softkin: 1\nmesh: {file: a." + form + "}\n" + rest);
    const ProgramResult solved = run_program({"fk", folder / "s.yaml"});
    EXPECT_EQ(solved.exit_code, 2);
    EXPECT_NE(solved.errors.find(advice), std::string::npos) << solved.errors;
    folder.write("s.yaml", "softkin: 1\nformulation: physical\nmesh: {file: a." + form +
                               "}\nlayers:\n  - {name: film, region: all, thickness: 0.1, youngs_modulus: 100, "
                               "poisson_ratio: 0.3}\nfixed:\n  - {vertices: [0, 1, 2]}\n");
    const ProgramResult layers = run_program({"mesh", "check", folder / "s.yaml"});
    EXPECT_EQ(layers.exit_code, 0) << layers.output << layers.errors;
  }
}

TEST(MeshCheckCommand, EdgesOfOrder2) {
  const TemporaryFolder folder;
  GmshText mesh =
      quadratic(tetrahedra({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {4, 4, 4}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}));
  const auto check_now = [&] { return check(folder.write("a.msh", mesh.text())); };
  const Check clean = check_now();
  EXPECT_EQ(clean.exit_code, 0);
  EXPECT_EQ(clean.report["order"], 2);
  EXPECT_EQ(clean.report["findings"].size(), 13u);
  EXPECT_EQ(edge_counts(clean.report), Counts{});

  // vertex 5 is in the middle of the edge from 0 to 1, of length 4
  mesh.vertices[5] = {2, -0.5, 0};
  const Check curved = check_now();
  EXPECT_EQ(curved.exit_code, 0);
  EXPECT_EQ(edge_counts(curved.report), (Counts{{"uneven_edges", 1}}));
  EXPECT_EQ(finding(curved.report, "uneven_edges")["severity"], "remark");
  EXPECT_EQ(finding(curved.report, "uneven_edges")["first"][0]["vertices"], json({0, 1, 5}));

  mesh.vertices[5] = {0.9, 0, 0};
  const Check far = check_now();
  EXPECT_EQ(far.exit_code, 1);
  EXPECT_EQ(edge_counts(far.report), (Counts{{"far_edge_nodes", 1}}));
}

TEST(MeshCheckCommand, EdgesWithTwoNodesBlock) {
  const TemporaryFolder folder;
  GmshText mesh =
      quadratic(tetrahedra({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {4, 4, 4}}, {{0, 1, 2, 3}, {1, 2, 3, 4}}));
  const int shared = mesh.elements[1].vertices[4];  // between vertices 1 and 2
  mesh.elements[1].vertices[4] = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back({2, 2, 0});
  const std::string file = folder.write("a.msh", mesh.text());
  const auto [exit_code, report] = check(file);
  EXPECT_EQ(exit_code, 1);
  EXPECT_EQ(edge_counts(report), (Counts{{"split_edges", 1}}));
  EXPECT_EQ(finding(report, "split_edges")["first"][0]["vertices"], json({1, 2, shared, mesh.vertices.size() - 1}));
  const std::string text = run_program({"mesh", "check", file}).output;
  EXPECT_NE(text.find("2 tetrahedra of order 2, 0 prisms"), std::string::npos) << text;
  EXPECT_NE(text.find("not usable: split edges (1)"), std::string::npos) << text;
}

TEST(MeshCheckCommand, NodesOfTwoEdgesBlock) {
  const TemporaryFolder folder;
  GmshText mesh = quadratic(tetrahedra({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}, {{0, 1, 2, 3}}));
  mesh.elements[0].vertices[5] = mesh.elements[0].vertices[4];
  const auto [exit_code, report] = check(folder.write("a.msh", mesh.text()));
  EXPECT_EQ(exit_code, 1);
  EXPECT_EQ(edge_counts(report), (Counts{{"shared_edge_nodes", 1}, {"far_edge_nodes", 1}}));
  EXPECT_EQ(finding(report, "shared_edge_nodes")["first"][0]["vertices"], json::array({4}));
}

TEST(MeshCheckCommand, SceneHoldsTheMesh) {
  GmshText mesh = cube();
  mesh.vertices.push_back({5, 5, 5});
  const TemporaryFolder folder;
  folder.write("cube.msh", mesh.text());
  const std::string file = folder.write("cube.yaml", scene("fixed: [{region: base}]\n"));
  const auto [code, report] = check(file);
  EXPECT_EQ(code, 0);
  EXPECT_NEAR(report["parts"][0]["volume_mm3"], 8000, 1e-9);
  EXPECT_EQ(finding(report, "unreferenced_vertices")["first"][0]["position_mm"], json({50.0, 50.0, 50.0}));
  EXPECT_EQ(report["scene"]["notes"].size(), 1u);
  EXPECT_TRUE(report["scene"]["error"].is_null());
  const ProgramResult text = run_program({"mesh", "check", "--scene", file});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_NE(text.output.find("\nscene compiles, and notes:\n    1 vertex belongs to no element"), std::string::npos)
      << text.output;
}

TEST(MeshCheckCommand, SceneThatHoldsNothingIsRefused) {
  const TemporaryFolder folder;
  folder.write("cube.msh", cube().text());
  const std::string file = folder.write("cube.yaml", scene("fixed: [{region: corner}]\n"));
  const auto [code, report] = check(file);
  EXPECT_EQ(code, 1);
  EXPECT_EQ(counts(report), Counts{});
  const std::string error = report["scene"]["error"];
  EXPECT_NE(error.find("can turn about x, y and z"), std::string::npos) << error;
  const ProgramResult text = run_program({"mesh", "check", file});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_TRUE(text.output.ends_with("\nnot usable: the scene is refused\n")) << text.output;
}

TEST(MeshCheckCommand, EveryLoosePartIsNamed) {
  GmshText mesh = cube();  // and two tetrahedra beside it
  for (const double x : {10.0, 20.0}) {
    const int first = static_cast<int>(mesh.vertices.size());
    for (const auto& [y, z] : {std::pair{0.0, 0.0}, {4.0, 0.0}, {0.0, 4.0}}) mesh.vertices.push_back({x, y, z});
    mesh.vertices.push_back({x + 4, 0, 0});
    mesh.elements.push_back({4, 1, {first, first + 1, first + 2, first + 3}});
  }
  const TemporaryFolder folder;
  folder.write("cube.msh", mesh.text());
  const auto [code, report] = check(folder.write("cube.yaml", scene("fixed: [{region: base}]\n")));
  EXPECT_EQ(code, 1);
  EXPECT_EQ(report["parts"].size(), 3u);
  const std::string error = report["scene"]["error"];
  for (const char* place : {"4 vertices around (110, 10, 10) mm", "4 vertices around (210, 10, 10) mm"})
    EXPECT_NE(error.find(place), std::string::npos) << error;
}

TEST(MeshCheckCommand, BadInputIsNotAVerdict) {
  const TemporaryFolder folder;
  folder.write("cube.msh", cube().text());
  const auto refused = [](const std::string& file, const std::string& word) {
    const ProgramResult result = run_program({"mesh", "check", file});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.errors.find(word), std::string::npos) << result.errors;
  };
  refused(folder.write("a.yaml", scene("fixde: []\n")), "a.yaml:5");
  refused(folder.write("b.yaml", "softkin: 1\nmesh: {file: absent.msh}\n"), "b.yaml:2");
  refused(folder.write("c.msh", "$MeshFormat\n9 9 9\n"), "c.msh:2");
  refused(folder / "absent.msh", "no such file");
}

}  // namespace
