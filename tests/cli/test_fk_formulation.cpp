#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <softkin/io/mesh/mesh_io.hpp>

#include "fk_physical_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

TEST(FkFormulation, OneSceneServesBoth) {
  const std::string both = replaced(block_scene(), "shape_ratio: 1.0",
                                    "shape_ratio: 1.0, youngs_modulus: 1, "
                                    "poisson_ratio: 0.3");
  const BlockFolder paper(block_scene()), folder(both);
  const json target = report_of(folder, {"--set", "air=1.4", "--formulation", "target-shape"});
  EXPECT_EQ(target["formulation"], "target-shape");
  expect_same_markers(target["steps"][0], step_of(paper, {"--set", "air=1.4"}), 1e-12);
  EXPECT_LT(target["steps"][0]["actuators"]["air"]["achieved"], 1.39);
  EXPECT_FALSE(target["steps"][0]["actuators"]["air"].contains("pressure_kPa"));

  const json physical = report_of(folder, {"--set", "air=1.4", "--formulation", "physical"});
  EXPECT_EQ(physical["formulation"], "physical");
  EXPECT_NEAR(physical["steps"][0]["actuators"]["air"]["achieved"], 1.4, 1e-9);
  EXPECT_NE(physical["robot_fingerprint"], target["robot_fingerprint"]);
  EXPECT_EQ(timeless(physical["steps"][0]), timeless(step_of(folder, {"--set", "air=1.4"}))) << "elastic: the default";
  const json slow = step_of(folder, {"--set", "air=1.4", "--formulation", "target-shape", "--solver", "local-global"});
  expect_same_markers(target["steps"][0], slow, 1e-4);
  const BlockFolder loads(replaced(loaded_scene(), "{youngs", "{shape_ratio: 1.0, youngs"));
  expect_refused(loads, {"--formulation", "target-shape"}, "needs the physical formulation");
}

TEST(FkFormulation, TetrahedraOfOrderTwo) {
  const BlockFolder folder(replaced(physical_scene(), "block.msh", "block.msh, order: 2"));
  const ProgramResult result = run_fk(folder.scene, {"--set", "air=1.3", "-o", folder / "a.vtu", "--report",
                                                     folder / "a.json", "--image", folder / "a.png"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("539 vertices, 252 tetrahedra of order 2; physical"), std::string::npos)
      << result.output;
  const json report = json::parse(read_text(folder / "a.json"));
  EXPECT_EQ(report["mesh"]["order"], 2);
  EXPECT_NEAR(report["steps"][0]["actuators"]["air"]["achieved"], 1.3, 1e-7);
  EXPECT_EQ(report["steps"][0]["inverted_elements"], 0);
  EXPECT_EQ(softkin::read_mesh(folder / "a.vtu").edge_nodes.size(), 252u);
  EXPECT_EQ(read_text(folder / "a.png").substr(1, 3), "PNG");
}

/// Sucked empty, the finger bends backwards until its folds lie in each other.
TEST(FkSelfOverlap, IsToldOfEveryStep) {
  const TemporaryFolder folder;
  const std::string scene =
      folder.write("finger.yaml", "softkin: 1\nmesh: {file: " SOFTKIN_SOURCE_DIR
                                  "/examples/pneumatic_finger/pneumatic_finger.msh, order: 1}\n"
                                  "materials: [{region: body, youngs_modulus: 45, poisson_ratio: 0.45}]\n"
                                  "fixed: [{region: base}]\n"
                                  "actuators: [{name: air, kind: pneumatic, region: chamber, control: pressure, "
                                  "range: [-3000, 0]}]\n");
  const std::string path = folder.write("path.csv", "air\n-1200\n-2000\n-2050\n");
  const ProgramResult result = run_fk(scene, {"--path", path, "--report", folder / "a.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json steps = json::parse(read_text(folder / "a.json"))["steps"];
  ASSERT_EQ(steps.size(), 3u);
  const auto overlap = [&](std::size_t step, const char* key) { return steps[step]["self_overlap"][key]; };
  EXPECT_EQ(overlap(0, "points"), 0);
  EXPECT_EQ(overlap(0, "where_mm"), nullptr);
  EXPECT_GT(overlap(1, "points"), 5);
  EXPECT_GT(overlap(2, "deepest_mm"), overlap(1, "deepest_mm"));
  EXPECT_LT(overlap(2, "deepest_mm"), 2);  // no wall is thicker
  const std::string of_last =
      "warning: the shape passes through itself: " + std::to_string(overlap(2, "points").get<int>()) +
      " points of its surface lie inside it";
  EXPECT_NE(result.output.find(of_last), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("warning: the shape passes through itself in step 1, the deepest"), std::string::npos)
      << result.output;
}

}  // namespace
