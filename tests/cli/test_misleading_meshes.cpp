#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <softkin/io/mesh/mesh_io.hpp>

#include "model/block_mesh.hpp"
#include "run_program.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;
using softkin::Index;
using softkin::Vec3;

/// A cube of 30 mm in hollow.msh, its middle cell the region chamber, with the rest of a scene.
std::string hollow_scene(const std::string& rest, const std::string& mesh = "hollow.msh") {
  return "softkin: 1\nmesh: {file: " + mesh + "}\nmaterials: [{region: all, youngs_modulus: 1, poisson_ratio: 0.3}]\n" +
         "fixed: [{region: x_low}]\n" + rest;
}

void write_hollow(const TemporaryFolder& folder) {
  softkin::write_gmsh(folder / "hollow.msh", hollow_mesh(), false);
}

/// Refused by fk with exit code 2 and nothing written.
void expect_refused(const TemporaryFolder& folder, const std::string& scene, const std::string& fragment) {
  const std::string file = folder.write("robot.yaml", scene);
  const std::size_t files = folder.files();
  const ProgramResult result = run_program({"fk", file, "-o", folder / "out.vtu", "--report", folder / "report.json"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find(fragment), std::string::npos) << "wanted: " << fragment << "\ngot: " << result.errors;
  EXPECT_EQ(folder.files(), files);
}

TEST(MisleadingMeshes, AnOpenChamber) {
  const TemporaryFolder folder;
  softkin::Mesh mesh = block_mesh({6, 3, 3}, {30, 15, 15});
  add_volume_region(mesh, "mouth",
                    [](const Vec3& p) { return p[0] > 10 && (p.tail<2>().array() - 7.5).abs().maxCoeff() < 2.5; });
  softkin::write_gmsh(folder / "hole.msh", mesh, false);
  expect_refused(
      folder, hollow_scene("actuators: [{name: air, kind: pneumatic, region: mouth, range: [0.5, 2]}]\n", "hole.msh"),
      "robot.yaml:5: actuator 'air' has a chamber that is open: 2 faces around (30, 7.5, 7.5) mm");
}

TEST(MisleadingMeshes, DoubledElements) {
  const TemporaryFolder folder;
  softkin::Mesh mesh = block_mesh({2, 1, 1}, {20, 10, 10});
  std::string text = "MeshVersionFormatted 2\nDimension 3\nVertices\n" + std::to_string(mesh.vertices.rows()) + "\n";
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    for (int axis = 0; axis < 3; ++axis) text += std::to_string(mesh.vertices(v, axis)) + " ";
    text += "0\n";
  }
  text += "Tetrahedra\n24\n";
  for (int twice = 0; twice < 2; ++twice)
    for (const softkin::Tetrahedron& t : mesh.tetrahedra) {
      for (const Index v : t) text += std::to_string(v + 1) + " ";
      text += "1\n";
    }
  folder.write("twice.mesh", text + "End\n");
  const std::string rest =
      "materials: [{region: all, youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{box: [[-1, -1, -1], [0.1, 11, 11]]}]\nforces: [{name: f, point: [20, 5, 5], force: "
      "[0, 0, -0.1]}]\n";
  expect_refused(folder, "softkin: 1\nmesh: {file: twice.mesh}\n" + rest,
                 "robot.yaml:2: the mesh has errors: duplicate elements (12): same vertices as an earlier element");
  const std::string file =
      folder.write("robot.yaml", "softkin: 1\nmesh: {file: twice.mesh, accept_errors: true}\n" + rest);
  const ProgramResult result = run_program({"fk", file, "--report", folder / "report.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::string notes = json::parse(read_text(folder / "report.json")).dump();
  EXPECT_NE(notes.find("taken in spite of its errors (accept_errors): duplicate elements (12)"), std::string::npos);
  const ProgramResult check = run_program({"mesh", "check", file});
  EXPECT_EQ(check.exit_code, 0);
  EXPECT_NE(check.output.find("usable, since the scene accepts errors: duplicate elements (12)"), std::string::npos)
      << check.output;
  EXPECT_EQ(run_program({"mesh", "check", folder / "twice.mesh"}).exit_code, 1);
}

TEST(MisleadingMeshes, SurfacesOfSkinsAndOfOtherUnits) {
  const TemporaryFolder folder;
  write_hollow(folder);
  const auto with_surface = [](const std::string& surface) {
    return hollow_scene("void: [chamber]\nactuators: [{name: air, kind: pneumatic, surface: " + surface +
                        ", range: [0.5, 2]}]\n");
  };
  const softkin::TriangleSurface cavity = box_surface({10, 10, 10}, {10, 10, 10});
  softkin::write_stl(folder / "metres.stl", cavity.vertices / 1000, cavity.triangles);
  expect_refused(folder, with_surface("metres.stl"), "robot.yaml:6: actuator 'air' has a surface of 0.0173205 mm from");
  const std::string file = folder.write("robot.yaml", with_surface("{file: metres.stl, unit: m}"));
  const ProgramResult result = run_program({"fk", file, "--set", "air=1.2", "--report", folder / "report.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(read_text(folder / "report.json").find("bounds the empty space of 1000 mm^3"), std::string::npos);

  softkin::TriangleSurface two = box_surface({0, 0, 0}, {30, 30, 30});
  softkin::Points vertices(two.vertices.rows() + cavity.vertices.rows(), 3);
  vertices << two.vertices, cavity.vertices;
  const Index first = two.vertices.rows();
  for (const auto& [a, b, c] : cavity.triangles) two.triangles.push_back({first + a, first + b, first + c});
  softkin::write_stl(folder / "skin.stl", vertices, two.triangles);
  expect_refused(folder, with_surface("skin.stl"),
                 "one of 1000 mm^3 around (15, 15, 15) mm lies inside one of 27000 mm^3");
}

TEST(MisleadingMeshes, EmptySpacesAreListed) {
  const TemporaryFolder folder;
  write_hollow(folder);
  const std::string solid = folder / "hollow.msh",
                    robot = folder.write("robot.yaml", hollow_scene("void: [chamber]\n"));
  EXPECT_EQ(json::parse(run_program({"mesh", "check", solid, "--json"}).output)["empty_spaces"], json::array());
  EXPECT_EQ(run_program({"mesh", "check", solid}).output.find("empty space"), std::string::npos);
  const json spaces = json::parse(run_program({"mesh", "check", robot, "--json"}).output)["empty_spaces"];
  ASSERT_EQ(spaces.size(), 1u);
  EXPECT_NEAR(spaces[0]["volume_mm3"], 1000, 1e-9);
  EXPECT_EQ(spaces[0]["faces"], 12);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(spaces[0]["center_mm"][axis], 15, 1e-9);
  EXPECT_NE(
      run_program({"mesh", "check", robot})
          .output.find("\n1 empty space that the elements enclose\n    1000 mm^3 (12 faces) around (15, 15, 15) mm\n"),
      std::string::npos);

  softkin::Mesh mesh = hollow_mesh();
  const std::vector<Index> middle = mesh.regions.back().tetrahedra;
  for (std::size_t i = middle.size(); i-- > 0;) mesh.tetrahedra.erase(mesh.tetrahedra.begin() + middle[i]);
  mesh.regions.clear();
  softkin::write_gmsh(folder / "empty.msh", mesh, false);
  EXPECT_EQ(json::parse(run_program({"mesh", "info", folder / "empty.msh", "--json"}).output)["empty_spaces"].size(),
            1u);
  EXPECT_NE(
      run_program({"mesh", "info", folder / "empty.msh"}).output.find("1 empty space that the elements enclose\n"),
      std::string::npos);
}

}  // namespace
