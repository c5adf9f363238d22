#include <gtest/gtest.h>

#include <random>
#include <softkin/model/mesh/mesh_check.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

void double_elements(RobotSpec& spec) {
  const std::vector<Tetrahedron> once = spec.mesh.tetrahedra;
  spec.mesh.tetrahedra.insert(spec.mesh.tetrahedra.end(), once.begin(), once.end());
}

void add_overlapping(RobotSpec& spec) {
  Mesh& mesh = spec.mesh;
  const Index apex = mesh.vertices.rows();
  const auto& [a, b, c, d] = mesh.tetrahedra[0];
  Points vertices(apex + 1, 3);
  vertices << mesh.vertices, 0.5 * mesh.vertices.row(d) + (mesh.vertices.row(a) + mesh.vertices.row(b)) / 4;
  mesh.vertices = vertices;
  mesh.tetrahedra.push_back({a, b, c, apex});
}

TEST(MeshErrors, AreRefusedAsMeshCheckDoes) {
  for (const bool physical : {false, true}) {
    const Mesh mesh = block_mesh({2, 1, 1}, {20, 10, 10});
    RobotSpec spec = physical ? physical_robot(mesh) : block_robot(mesh);
    spec.name = "robot.yaml";
    spec.mesh_options.origin = line(2);
    expect_refused(
        spec,
        {{"doubled", double_elements,
          "robot.yaml:2: the mesh has errors: duplicate elements (12): same vertices as an earlier element, the first: "
          "tetrahedron 12 at (7.5, 5, 2.5) mm (numbers from 0). `softkin mesh check robot.yaml` lists them all"},
         {"overlapping", add_overlapping,
          "overlapping elements (1): on the same side of a common face, the first: tetrahedra 0, 12 at ("}});
  }
}

TEST(MeshErrors, AreTakenWhereTheSceneAcceptsThem) {
  RobotSpec spec = physical_robot(block_mesh({2, 1, 1}, {20, 10, 10}));
  double_elements(spec);
  spec.mesh_options.accept_errors = true;
  const Model model = compile(spec);
  EXPECT_EQ(model.elements.tetrahedra.size(), 24u);
  EXPECT_TRUE(has_note(model, "The mesh is taken in spite of its errors (accept_errors): duplicate elements (12)"));
}

TEST(MeshErrors, OfVoidElementsDoNotMatter) {
  RobotSpec spec = physical_robot(block_mesh({3, 1, 1}, {30, 10, 10}));
  const std::size_t once = spec.mesh.tetrahedra.size();
  double_elements(spec);
  add_volume_region(spec.mesh, "end", [](const Vec3& p) { return p[0] > 20; });
  Region copies;
  copies.name = "copies";
  for (std::size_t i = once; i < 2 * once; ++i) copies.tetrahedra.push_back(i);
  spec.mesh.regions.push_back(copies);
  spec.voids = {named("end"), named("copies")};
  EXPECT_EQ(compile(spec).elements.tetrahedra.size(), 12u);
  // a number in the message is that of the file, not that among the elements that are used
  spec.voids = {named("end")};
  EXPECT_NE(refusal(spec).find("duplicate elements (12): same vertices as an earlier element, the first: tetrahedron " +
                               std::to_string(once)),
            std::string::npos)
      << refusal(spec);
}

/// The quick answer is that of the whole check, on sound meshes and on random damage to them.
TEST(MeshErrors, TheScreenAgreesWithTheCheck) {
  std::mt19937 random(5);
  int clashes = 0;
  for (int round = 0; round < 200; ++round) {
    Mesh mesh = block_mesh({3, 2, 2}, {3, 2, 2}, round % 2 == 0 ? Split::six : Split::prisms);
    if (round >= 50 && !mesh.tetrahedra.empty()) {
      Tetrahedron t = mesh.tetrahedra[random() % mesh.tetrahedra.size()];
      t[random() % 4] = random() % static_cast<unsigned>(mesh.vertices.rows());
      const double volume = signed_volume(mesh.vertices, t);
      if (std::abs(volume) < 1e-3) continue;
      if (volume < 0) std::swap(t[2], t[3]);
      mesh.tetrahedra.push_back(t);
    } else if (round >= 50) {
      mesh.prisms.push_back(mesh.prisms[random() % mesh.prisms.size()]);
    }
    const MeshCheck check = check_mesh(mesh);
    const bool wrong = !(check.duplicate_elements.empty() && check.overlapping.empty() &&
                         check.nonmanifold_faces.empty() && check.nonmanifold_quads.empty());
    clashes += wrong;
    EXPECT_EQ(have_common_side(mesh.tetrahedra, {}, mesh.prisms, mesh.vertices.rows()), wrong);
  }
  EXPECT_GT(clashes, 50);
}

}  // namespace
