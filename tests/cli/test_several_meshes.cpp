#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <softkin/core/types.hpp>

#include "fk_samples.hpp"

namespace softkin::testing {
namespace {

using nlohmann::json;

/// Two fingers of one file, the second turned about x: each moves as the first does alone.
TEST(SeveralMeshes, EachMovesAsItDoesAlone) {
  const TemporaryFolder folder;
  folder.write("block.msh", Block(5).mesh.text());
  const std::string materials = "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, density: 1000}]\n";
  const std::string alone =
      folder.write("alone.yaml", "softkin: 1\nmesh: {file: block.msh}\n" + materials +
                                     "fixed: [{region: base}]\nmarkers: [{name: tip, point: [20, 12, 12]}]\n"
                                     "actuators: [{name: air, kind: pneumatic, region: chamber, range: [1, 1.5]}]\n");
  const std::string both =
      folder.write("both.yaml",
                   "softkin: 1\nmeshes:\n  - {name: a, file: block.msh}\n"
                   "  - {name: b, file: block.msh, move: [0, 0, 20], rotate: {axis: [1, 0, 0], degrees: 90}}\n" +
                       materials +
                       "fixed: [{region: a.base}, {region: b.base}]\n"
                       "markers: [{name: a_tip, point: [20, 12, 12]}, {name: b_tip, point: [20, -32, 12]}]\n"
                       "actuators:\n  - {name: a, kind: pneumatic, region: a.chamber, range: [1, 1.5]}\n"
                       "  - {name: b, kind: pneumatic, region: b.chamber, range: [1, 1.5]}\n");
  const auto step = [](const ProgramResult& result) {
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output).at("steps").at(0);
  };
  const json one = step(run_fk(alone, {"--set", "air=1.3", "--json"}));
  const json two = step(run_fk(both, {"--set", "a=1", "--set", "b=1.3", "--json"}));
  const auto tip = [](const json& in, const char* name) {
    const json& at = in.at("markers").at(name);
    return Vec3(at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
  };
  const Vec3 moved = tip(one, "tip");
  EXPECT_GT((moved - Vec3(20, 12, 12)).norm(), 0.1);
  EXPECT_LT((tip(two, "a_tip") - Vec3(20, 12, 12)).norm(), 1e-9);
  EXPECT_LT((tip(two, "b_tip") - Vec3(moved.x(), -moved.z() - 20, moved.y())).norm(), 1e-6);
  EXPECT_NEAR(two.at("actuators").at("b").at("pressure_kPa").get<double>(),
              one.at("actuators").at("air").at("pressure_kPa").get<double>(), 1e-6);
}

}  // namespace
}  // namespace softkin::testing
