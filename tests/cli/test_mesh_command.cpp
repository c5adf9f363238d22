#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <utility>

#include "mesh_samples.hpp"
#include "model/round_mesh.hpp"

namespace {

using namespace softkin;
using namespace softkin::testing;
using nlohmann::json;

json run_json(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  return json::parse(result.output);
}

void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 2) << result.errors;
  EXPECT_EQ(result.output, "");
  for (const std::string& word : words) EXPECT_NE(result.errors.find(word), std::string::npos) << result.errors;
}

void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in:\n" << text;
}

TEST(MeshInfo, MeasuresCube) {
  const TemporaryFolder folder;
  const json info = run_json({"mesh", "info", folder.write("cube.msh", cube().text())});
  EXPECT_EQ(info["form"], "Gmsh");
  EXPECT_EQ(info["order"], 1);
  EXPECT_EQ(info["vertices"], 8);
  EXPECT_EQ(info["tetrahedra"], 6);
  EXPECT_EQ(info["prisms"], 0);
  EXPECT_EQ(info["parts"], 1);
  EXPECT_EQ(info["surface_cells"], json({{"triangles", 2}, {"quads", 0}}));
  EXPECT_EQ(info["bounding_box_mm"]["low"], json({0.0, 0.0, 0.0}));
  EXPECT_EQ(info["bounding_box_mm"]["high"], json({2.0, 2.0, 2.0}));
  EXPECT_EQ(info["size_mm"], json({2.0, 2.0, 2.0}));
  EXPECT_NEAR(info["volume_mm3"], 8, 1e-12);
  EXPECT_NEAR(info["boundary_area_mm2"], 24, 1e-12);
  // 19 edges: 12 of the cube, 6 diagonals of its sides, 1 through its middle
  EXPECT_NEAR(info["edge_lengths_mm"]["min"], 2, 1e-12);
  EXPECT_NEAR(info["edge_lengths_mm"]["median"], 2, 1e-12);
  EXPECT_NEAR(info["edge_lengths_mm"]["max"], 2 * std::sqrt(3), 1e-12);
  // 3 inradius / circumradius; inradius = 3 volume / area, circumradius = half the cube's diagonal
  const double quality = 3 * (0.5 / (1 + std::sqrt(2))) / (std::sqrt(3) / 2);
  for (const char* key : {"min", "percentile_1", "median"}) EXPECT_NEAR(info["quality"][key], quality, 1e-12);
}

/// Of a rod of twelve corners and 10 mm radius: what `curve` would give, what a scene's gives, and a mesh's own edges.
TEST(MeshInfo, TellsOfSurfaces) {
  const TemporaryFolder folder;
  const std::string triangle =
      folder.write("film.msh",
                   "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 3 0 0\n3 0 4 0\n$EndNodes\n"
                   "$Elements\n1\n1 2 2 0 1 1 2 3\n$EndElements\n");
  const auto info_of = [](const std::string& file) {
    const ProgramResult result = run_program({"mesh", "info", file, "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.errors.find("no volume element"), std::string::npos) << result.errors;
    return json::parse(result.output);
  };
  const json info = info_of(triangle);
  EXPECT_EQ(info["tetrahedra"], 0);
  EXPECT_EQ(info["surface_cells"], json({{"triangles", 1}, {"quads", 0}}));
  EXPECT_EQ(info["size_mm"], json({3.0, 4.0, 0.0}));
  EXPECT_EQ(info["edge_lengths_mm"], json({{"min", 3.0}, {"median", 4.0}, {"max", 5.0}}));
  const std::string copy = folder / "film.vtu";
  EXPECT_EQ(run_program({"mesh", "convert", triangle, copy}).exit_code, 0);
  EXPECT_EQ(info_of(copy)["surface_cells"]["triangles"], 1);
}

TEST(MeshInfo, MeasuresWithCurvedEdges) {
  const TemporaryFolder folder;
  const Mesh rod = rod_mesh(12, 1, 5, 10, 40);
  const double round = std::numbers::pi * 100 * 40, polygon = 12 * 50 * std::sin(std::numbers::pi / 6) * 40;
  write_mesh(folder / "rod.msh", rod);
  const json info = run_json({"mesh", "info", folder / "rod.msh"});
  EXPECT_NEAR(info["volume_mm3"], polygon, 1e-9 * polygon);
  EXPECT_EQ(info["curved"]["of"], "smooth");
  EXPECT_NEAR(info["curved"]["volume_mm3"], round, 2e-3 * round);
  EXPECT_GT(info["curved"]["nodes_moved"], 100);
  EXPECT_EQ(info["curved"]["nodes_held_back"], 0);
  EXPECT_NEAR(info["regions"][0]["curved_volume_mm3"], info["curved"]["volume_mm3"], 1e-6);
  expect_contains(run_program({"mesh", "info", folder / "rod.msh"}).output, "'curve: true'");

  const std::string scene = folder.write("rod.yaml",
                                         "softkin: 1\nmesh: {file: rod.msh, order: 2, curve: {cylinder: {start: [0, 0, "
                                         "0], end: [40, 0, 0], radius: 10}}}\n");
  const json given = run_json({"mesh", "info", scene})["curved"];
  EXPECT_EQ(given["of"], "scene");
  EXPECT_NEAR(given["volume_mm3"], round, 5e-4 * round);

  Mesh own = elevated(rod);
  CurveSpec curve;
  curve.smooth = true;
  curve_edges(own, labels_of(own, own.regions), curve);
  write_mesh(folder / "own.msh", own);
  const json read = run_json({"mesh", "info", folder / "own.msh"})["curved"];
  EXPECT_EQ(read["of"], "mesh");
  EXPECT_NEAR(read["volume_mm3"], info["curved"]["volume_mm3"], 1e-6);
  EXPECT_FALSE(read.contains("nodes_moved"));
  EXPECT_TRUE(run_json({"mesh", "info", folder.write("cube.msh", cube().text())})["curved"].is_null());
}

TEST(MeshInfo, ListsRegions) {
  const TemporaryFolder folder;
  const json regions = run_json({"mesh", "info", folder.write("cube.msh", cube().text())})["regions"];
  ASSERT_EQ(regions.size(), 4u);
  EXPECT_EQ(regions[0]["name"], "body");
  EXPECT_EQ(regions[0]["dimension"], 3);
  EXPECT_EQ(regions[0]["elements"], 4);
  EXPECT_EQ(regions[0]["vertices"], 7);
  EXPECT_NEAR(regions[0]["volume_mm3"], 16.0 / 3, 1e-12);
  EXPECT_EQ(regions[1]["elements"], 2);
  EXPECT_EQ(regions[1]["vertices"], 5);
  EXPECT_NEAR(regions[1]["volume_mm3"], 8.0 / 3, 1e-12);
  EXPECT_EQ(regions[2]["name"], "base");
  EXPECT_EQ(regions[2]["faces"], 2);
  EXPECT_EQ(regions[2]["vertices"], 4);
  EXPECT_NEAR(regions[2]["area_mm2"], 4, 1e-12);
  EXPECT_EQ(regions[3], json({{"name", "corner"}, {"dimension", 0}, {"vertices", 1}}));
}

TEST(MeshInfo, TakesScenesAndTellsMeshesWithoutRegions) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("cube.msh", cube().text());
  const std::string scene = folder.write(
      "two.yaml",
      "softkin: 1\nunits: {length: cm}\nmeshes: [{file: cube.msh}, {file: cube.msh, name: b, move: [9, 0, 0]}]\n");
  const json one = run_json({"mesh", "info", mesh, "--unit", "cm"}), both = run_json({"mesh", "info", scene});
  EXPECT_EQ(both["vertices"], 2 * one["vertices"].get<int>());
  EXPECT_NEAR(both["volume_mm3"].get<double>(), 2 * one["volume_mm3"].get<double>(),
              1e-9 * one["volume_mm3"].get<double>());
  EXPECT_EQ(both["parts"], 2);
  EXPECT_EQ(both["regions"].size(), 2 * one["regions"].size());
  expect_contains(run_program({"mesh", "info", scene}).output, "two.yaml (the mesh of the scene)");
  const ProgramResult unit = run_program({"mesh", "info", scene, "--unit", "m"});
  EXPECT_EQ(unit.exit_code, 2);
  expect_contains(unit.errors, "a scene names its own unit");
  const std::string bare = folder.write(
      "bare.vtk",
      "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 "
      "0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n");
  expect_contains(run_program({"mesh", "info", bare}).output, "none: the file names no part of the mesh");
}

TEST(MeshInfo, StatesOrder2) {
  const TemporaryFolder folder;
  const std::string file = folder.write("cube.msh", quadratic(cube()).text());
  const json info = run_json({"mesh", "info", file});
  EXPECT_EQ(info["order"], 2);
  EXPECT_EQ(info["vertices"], 8 + 19);
  EXPECT_EQ(info["tetrahedra"], 6);
  EXPECT_EQ(info["parts"], 1);
  EXPECT_NEAR(info["volume_mm3"], 8, 1e-12);
  EXPECT_NEAR(info["boundary_area_mm2"], 24, 1e-12);
  EXPECT_NEAR(info["edge_lengths_mm"]["max"], 2 * std::sqrt(3), 1e-12);
  EXPECT_EQ(info["regions"][0]["vertices"], 7 + 15);  // body: four tetrahedra around an edge
  EXPECT_EQ(info["regions"][2]["vertices"], 4 + 5);   // base: two triangles
  expect_contains(run_program({"mesh", "info", file}).output, "6 tetrahedra of order 2, 0 prisms in 1 part");
}

TEST(MeshInfo, UnitScalesPrism) {
  const TemporaryFolder folder;
  const std::string file = folder.write("prism.msh", prism().text());
  for (const auto& [unit, mm] : {std::pair{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"um", 0.001}, {"in", 25.4}}) {
    const json info = run_json({"mesh", "info", file, "--unit", unit});
    EXPECT_EQ(info["unit"], unit);
    EXPECT_EQ(info["prisms"], 1);
    EXPECT_EQ(info["surface_cells"]["quads"], 1);
    EXPECT_NEAR(info["size_mm"][2].get<double>() / mm, 5, 1e-12);
    EXPECT_NEAR(info["volume_mm3"].get<double>() / (mm * mm * mm), 30, 1e-10);
    EXPECT_NEAR(info["boundary_area_mm2"].get<double>() / (mm * mm), 72, 1e-10);
    EXPECT_NEAR(info["regions"][1]["area_mm2"].get<double>() / (mm * mm), 15, 1e-10);
    EXPECT_NEAR(info["edge_lengths_mm"]["median"].get<double>() / mm, 5, 1e-12);  // 3 3 4 4 5 5 5 5 5
  }
}

TEST(MeshInfo, ReversedElementsAndStrayVerticesDoNotCount) {
  GmshText mesh = cube();
  std::swap(mesh.elements[2].vertices[0], mesh.elements[2].vertices[1]);
  mesh.vertices.push_back({100, 100, 100});
  const TemporaryFolder folder;
  const json info = run_json({"mesh", "info", folder.write("cube.msh", mesh.text())});
  EXPECT_EQ(info["vertices"], 9);
  EXPECT_NEAR(info["volume_mm3"], 8, 1e-12);
  EXPECT_EQ(info["size_mm"], json({2.0, 2.0, 2.0}));
}

TEST(MeshInfo, TextNamesEveryUnit) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program({"mesh", "info", folder.write("cube.msh", cube().text()), "--unit", "cm"});
  EXPECT_EQ(result.exit_code, 0);
  expect_contains(result.output, "(Gmsh, lengths in cm)\n");
  expect_contains(result.output, "\nvertices       8\n");
  expect_contains(result.output, "\nelements       6 tetrahedra, 0 prisms in 1 part\n");
  expect_contains(result.output, "\nbounding box   (0, 0, 0) mm to (20, 20, 20) mm\n");
  expect_contains(result.output, "\nsize           20 x 20 x 20 mm\n");
  expect_contains(result.output, "\nvolume         8000 mm^3\n");
  expect_contains(result.output, "\nboundary area  2400 mm^2\n");
  expect_contains(result.output, "\nedge lengths   min 20, median 20, max 34.64 mm\n");
  expect_contains(result.output, "\n  body     3D  4 elements  7 vertices  5333.33 mm^3\n");
  expect_contains(result.output, "\n  base     2D     2 faces  4 vertices      400 mm^2\n");
  expect_contains(result.output, "\n  corner   0D                1 vertex\n");
}

TEST(MeshInfo, CutsLongTables) {
  GmshText mesh = cube();
  for (int group = 10; group < 60; ++group) mesh.elements.push_back({15, group, {0}});
  const TemporaryFolder folder;
  const std::string file = folder.write("cube.msh", mesh.text());
  const std::string text = run_program({"mesh", "info", file}).output;
  expect_contains(text, "\nregions        54\n");
  expect_contains(text, "\n  ... and 14 more\n");
  EXPECT_EQ(run_json({"mesh", "info", file})["regions"].size(), 54u);
}

void expect_same_elements(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.vertices.rows(), b.vertices.rows());
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.tetrahedra, b.tetrahedra);
  EXPECT_EQ(a.edge_nodes, b.edge_nodes);
  EXPECT_EQ(a.prisms, b.prisms);
}

TEST(MeshConvert, WarnsWhereATetHasNoSidecar) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("a.tet", "4 vertices\n1 tets\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n4 0 1 2 3\n");
  const std::string warnings =
      "softkin: warning: no chambers of a.tet are known: there is no a_chamber.txt beside it\n"
      "softkin: warning: no handle and rigid part of a.tet are known: there is no a_rigid_handle.txt beside it\n";
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"info", mesh}, {"check", mesh}, {"convert", mesh, folder / "a.vtu"}}) {
    std::vector<std::string> arguments{"mesh"};
    arguments.insert(arguments.end(), command.begin(), command.end());
    EXPECT_EQ(run_program(arguments).errors, warnings) << command[0];
    arguments.insert(arguments.end(), {"--json", "--force-overwrite"});
    if (command[0] != "convert") arguments.pop_back();
    EXPECT_EQ(json::parse(run_program(arguments).output)["warnings"].size(), 2u) << command[0];
  }
  folder.write("a_chamber.txt", "1\n");
  const ProgramResult found = run_program({"mesh", "info", mesh});
  EXPECT_EQ(found.errors, "");
  EXPECT_FALSE(json::parse(run_program({"mesh", "info", mesh, "--json"}).output).contains("warnings"));
}

TEST(MeshConvert, GmshKeepsEverything) {
  const TemporaryFolder folder;
  for (const GmshText& sample : {cube(), prism(), quadratic(cube())}) {
    const std::string in = folder.write("in.msh", sample.text()), out = folder / "out.msh";
    for (const bool ascii : {false, true}) {
      std::vector<std::string> arguments{"mesh", "convert", in, out};
      if (ascii) arguments.emplace_back("--ascii");
      const json report = run_json(arguments);
      EXPECT_EQ(report["not_kept"], json::array());
      EXPECT_EQ(report["regions"].size(), sample.names.size());
      EXPECT_EQ(read_text(out).find('\0') == std::string::npos, ascii);
      const Mesh before = read_mesh(in), after = read_mesh(out);
      expect_same_elements(before, after);
      ASSERT_EQ(before.regions.size(), after.regions.size());
      for (std::size_t i = 0; i < before.regions.size(); ++i) {
        const Region &a = before.regions[i], &b = after.regions[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.dimension, b.dimension);
        EXPECT_EQ(a.tetrahedra, b.tetrahedra);
        EXPECT_EQ(a.prisms, b.prisms);
        EXPECT_EQ(a.triangles, b.triangles);
        EXPECT_EQ(a.quads, b.quads);
        EXPECT_EQ(a.vertices, b.vertices);
      }
    }
  }
}

TEST(MeshConvert, VtuKeepsVolumeRegions) {
  const TemporaryFolder folder;
  const std::string in = folder.write("in.msh", cube().text()), out = folder / "out.vtu";
  const json report = run_json({"mesh", "convert", in, out});
  EXPECT_EQ(report["regions"], json({"body", "chamber"}));
  EXPECT_EQ(report["not_kept"], json({"region 'base' (2D, 2 faces)", "region 'corner' (0D, 1 vertex)"}));
  const Mesh before = read_mesh(in), after = read_mesh(out);
  expect_same_elements(before, after);
  ASSERT_EQ(after.regions.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(after.regions[i].name, before.regions[i].name);
    EXPECT_EQ(after.regions[i].tetrahedra, before.regions[i].tetrahedra);
  }
}

TEST(MeshConvert, VtuNamesRegionsThatLoseElements) {
  GmshText mesh = cube();
  mesh.names.emplace_back("3 5 \"all\"");
  for (int i = 0; i < 5; ++i) {  // MSH 2.2 repeats an element for each of its groups
    mesh.elements.push_back(mesh.elements[i]);
    mesh.elements.back().group = 5;
  }
  const TemporaryFolder folder;
  const ProgramResult result =
      run_program({"mesh", "convert", folder.write("in.msh", mesh.text()), folder / "out.vtu"});
  EXPECT_EQ(result.exit_code, 0);
  expect_contains(result.output, "8 vertices, 6 tetrahedra, 0 prisms, 2 regions\nnot kept:\n");
  expect_contains(result.output, "    region 'all' (3D, 5 elements)\n");
}

TEST(MeshConvert, VtuKeepsOrder2) {
  const TemporaryFolder folder;
  const std::string in = folder.write("in.msh", quadratic(cube()).text()), out = folder / "out.vtu";
  const json report = run_json({"mesh", "convert", in, out});
  EXPECT_EQ(report["order"], 2);
  EXPECT_EQ(report["vertices"], 27);
  EXPECT_EQ(report["regions"], json({"body", "chamber"}));
  EXPECT_EQ(read_mesh(out).edge_nodes.size(), 6u);
  expect_same_elements(read_mesh(in), read_mesh(out));
  expect_contains(run_program({"mesh", "convert", in, out}).output, "27 vertices, 6 tetrahedra of order 2, 0 prisms");
}

TEST(MeshConvert, StlHoldsBoundary) {
  const TemporaryFolder folder;
  const auto convert = [&](const GmshText& mesh) {
    const json report = run_json({"mesh", "convert", folder.write("in.msh", mesh.text()), folder / "out.stl"});
    const TriangleSurface surface = read_stl(folder / "out.stl");
    EXPECT_EQ(report["facets"], surface.triangles.size());
    EXPECT_EQ(report["vertices"], surface.vertices.rows());
    EXPECT_EQ(report["tetrahedra"], 0);
    EXPECT_EQ(report["not_kept"].size(), 2 + mesh.names.size());
    return std::pair(surface.triangles.size(), enclosed_volume(surface.vertices, surface.triangles));
  };
  EXPECT_EQ(convert(cube()), std::pair(std::size_t{12}, 8.0));
  EXPECT_EQ(convert(quadratic(cube())), std::pair(std::size_t{48}, 8.0));
  EXPECT_EQ(convert(prism()), std::pair(std::size_t{8}, 30.0));
}

TEST(MeshConvert, NeverOntoItself) {
  const TemporaryFolder folder;
  const std::string file = folder.write("cube.msh", cube().text());
  expect_refused({"mesh", "convert", file, file, "--force-overwrite"}, {"OUT", "cube.msh", "a file that is read"});
  EXPECT_EQ(read_text(file), cube().text());
  EXPECT_EQ(folder.files(), 1u);
}

TEST(MeshConvert, ReferencesOfSeveralDimensionsStayApart) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.mesh",
                                        "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n"
                                        "0 0 1 1\nTetrahedra 1\n1 2 3 4 7\nTriangles 1\n1 2 3 7\nEnd\n");
  const json report = run_json({"mesh", "convert", file, folder / "a.msh"});
  EXPECT_EQ(report["regions"], json({"ref_7", "surface_ref_7"}));
  EXPECT_EQ(report["not_kept"], json::array());
}

TEST(MeshConvert, RefusesAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string good = folder.write("good.msh", cube().text());
  const std::string bad = folder.write("bad.msh", cube().text().substr(0, 300));
  const std::string existing = folder.write("old.vtu", "keep me");
  expect_refused({"mesh", "convert", bad, folder / "out.vtu"}, {"bad.msh:"});
  expect_refused({"mesh", "convert", bad, existing}, {"old.vtu", "is there already"});
  expect_refused({"mesh", "convert", folder / "absent.msh", folder / "out.vtu"}, {"absent.msh", "no such file"});
  expect_refused({"mesh", "convert", good, folder / "out.obj"}, {"out.obj", "'.obj'", ".msh, .vtu, .stl"});
  expect_refused({"mesh", "convert", good, folder / "no/out.msh"}, {"no/out.msh", "cannot be written"});
  EXPECT_EQ(read_text(existing), "keep me");
  EXPECT_EQ(folder.files(), 3u);
}

TEST(MeshUsage, BadUsageNamesOption) {
  const TemporaryFolder folder;
  const std::string file = folder.write("cube.msh", cube().text());
  expect_refused({"mesh"}, {"subcommand", "info, check, convert", "--help"});
  expect_refused({"mesh", "melt", file}, {"melt", "--help"});
  expect_refused({"mesh", "info"}, {"MESH", "required", "--help"});
  expect_refused({"mesh", "info", file, "--unit", "parsec"}, {"--unit", "parsec", "cm", "--help"});
  expect_refused({"mesh", "info", file, "--unit"}, {"--unit", "--help"});
  expect_refused({"mesh", "info", file, "--bogus"}, {"--bogus", "--help"});
  expect_refused({"mesh", "info", file, "other.msh"}, {"other.msh", "--help"});
  expect_refused({"mesh", "convert", file}, {"OUT", "required", "--help"});
  expect_refused({"mesh", "convert", file, folder / "a.vtu", "--ascii"}, {"--ascii", "a.vtu", "--help"});
  expect_refused({"mesh", "check"}, {"MESH", "--scene", "--help"});
  expect_refused({"mesh", "check", file, "--scene", "a.yaml"}, {"MESH", "--scene", "--help"});
  expect_refused({"mesh", "check", "--scene", file}, {"--scene", ".yaml", "--help"});
  expect_refused({"mesh", "check", "a.yaml", "--unit", "cm"}, {"--unit", "--help"});
  EXPECT_EQ(folder.files(), 1u);
}

TEST(MeshUsage, HelpShowsOptionsAndExample) {
  for (const char* command : {"info", "check", "convert"}) {
    const ProgramResult result = run_program({"mesh", command, "--help"});
    EXPECT_EQ(result.exit_code, 0);
    expect_contains(result.output, std::string("softkin mesh ") + command + " finger.");
    expect_contains(result.output, "--json");
  }
  expect_contains(run_program({"mesh", "check", "--help"}).output, "--scene SCENE");
  expect_contains(run_program({"mesh", "info", "--help"}).output, "--unit UNIT");
  expect_contains(run_program({"mesh", "convert", "--help"}).output, "--ascii");
}

TEST(MeshUsage, RefusesCoordinatesThatOverflow) {
  GmshText mesh = cube();
  mesh.vertices[7] = {1e70, 1e70, 1e70};
  const TemporaryFolder folder;
  const std::string file = folder.write("cube.msh", mesh.text());
  for (const char* command : {"info", "check"}) expect_refused({"mesh", command, file}, {"cube.msh", "too large"});
}

}  // namespace
