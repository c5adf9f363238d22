#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <softkin/core/types.hpp>

#include "fk_samples.hpp"

namespace softkin::testing {
namespace {

using nlohmann::json;

/// Beside block.yaml: the block in cm, and scenes of robots.
struct RobotsFolder : BlockFolder {
  RobotsFolder() : BlockFolder(physical_scene()) {
    write("cm.msh", Block(5, 0.4).mesh.text());
    write("cm.yaml", replaced(replaced(replaced(physical_scene("units: {length: cm}\n"), "block.msh", "cm.msh"),
                                       "[[0, 6, 12], [20, 6, 12]]", "[[0, 0.6, 1.2], [2, 0.6, 1.2]]"),
                              "[20, 12, 12]", "[2, 1.2, 1.2]"));
  }

  /// `right` is turned, so that it mirrors what it is in its own frame: x to -x, y to -y; and it faces the left one.
  [[nodiscard]] std::string pair(const std::string& gap_mm, const std::string& more = "") const {
    return write("pair.yaml",
                 "softkin: 1\nrobots:\n  - {name: left, scene: block.yaml}\n"
                 "  - {name: right, scene: cm.yaml, place: {rotate: {axis: [0, 0, 1], degrees: 180}, translate: [" +
                     gap_mm + ", 12, 0]}}\n" + more);
  }
};

json printed_report(const ProgramResult& result) {
  EXPECT_EQ(result.exit_code, 0) << result.errors << result.output;
  return json::parse(result.output);
}

Vec3 vector_of(const json& at) {
  return {at[0].get<double>(), at[1].get<double>(), at[2].get<double>()};
}

/// Each answers as it does alone, its lengths in its own unit, and everything that is written knows both.
TEST(SeveralRobotsCommand, EachMovesAsItDoesAlone) {
  const RobotsFolder folder;
  const std::string pair = folder.pair("100");
  const json alone = printed_report(run_fk(folder.scene, {"--set", "air=1.2", "--json"})).at("steps").at(0);
  const json both = printed_report(run_fk(pair, {"--set", "left.air=1.1", "--set", "right.air=1.2", "--json", "-o",
                                                 folder / "pair.vtu", "--image", folder / "pair.png"}));
  EXPECT_EQ(both.at("formulation"), "physical");
  const json& step = both.at("steps").at(0);
  for (const char* marker : {"tip", "corner"}) {
    const Vec3 own = vector_of(alone.at("markers").at(marker));
    const Vec3 placed(100 - own.x(), 12 - own.y(), own.z());
    EXPECT_LT((vector_of(step.at("markers").at(std::string("right.") + marker)) - placed).norm(), 1e-6) << marker;
  }
  EXPECT_GT((vector_of(step.at("markers").at("left.corner")) - Vec3(20, 12, 12)).norm(), 0.01);
  for (const char* name : {"air", "tendon"})
    for (const auto& [key, value] : alone.at("actuators").at(name).items()) {
      if (!value.is_number_float()) continue;
      const auto own = value.get<double>();
      EXPECT_NEAR(step.at("actuators").at(std::string("right.") + name).at(key).get<double>(), own,
                  1e-6 * std::max(1.0, std::abs(own)))
          << name << " " << key;
    }
  std::vector<std::string> supports;
  for (const json& reaction : step.at("reactions")) supports.push_back(reaction.at("support"));
  EXPECT_EQ(supports, (std::vector<std::string>{"left.base", "right.base"}));
  expect_words(read_text(folder / "pair.vtu"), {"left.body", "right.body", "support_right.base", "_left.air"});
  EXPECT_EQ(read_text(folder / "pair.png").substr(1, 3), "PNG");
}

/// Columns of paths and lines of tables have the full names.
TEST(SeveralRobotsCommand, PathsNameTheRobotsActuators) {
  const RobotsFolder folder;
  const std::string pair = folder.pair("100");
  const std::string path = folder.write("path.csv", "right.air, left.air\n1, 1\n1.1, 1.2\n");
  const json steps = printed_report(run_fk(pair, {"--path", path, "--json", "-o", folder / "pair.pvd"})).at("steps");
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_NEAR(steps[1].at("actuators").at("left.air").at("achieved").get<double>(), 1.2, 1e-6);
  EXPECT_NEAR(steps[1].at("actuators").at("right.air").at("achieved").get<double>(), 1.1, 1e-6);
  EXPECT_FALSE(read_text(folder / "pair.pvd").empty());
  const ProgramResult wrong = run_fk(pair, {"--set", "left.ari=1.1"});
  EXPECT_EQ(wrong.exit_code, 2);
  expect_words(wrong.errors, {"'left.ari'", "'left.air'"});
}

/// Faces 0.2 mm apart press on each other when one of the robots grows; the other's support carries the same force.
TEST(SeveralRobotsCommand, WhatTouchesIsNamed) {
  const RobotsFolder folder;
  const std::string pair = folder.pair("40.2", "contact: {distance: 0.05}\n");
  const std::vector<std::string> grown{"--set", "left.air=1.8", "--set", "left.tendon=1.2"};
  const ProgramResult text = run_fk(pair, grown);
  EXPECT_EQ(text.exit_code, 0) << text.errors;
  expect_words(text.output, {"robot 'left'", "robot 'right'"});
  const json step = printed_report(run_fk(pair, {grown[0], grown[1], grown[2], grown[3], "--json"})).at("steps").at(0);
  const json touching = step.at("contacts");
  const auto of = [&](const std::string& on, const std::string& by) {
    const auto found = std::find_if(touching.begin(), touching.end(),
                                    [&](const json& each) { return each.at("on") == on && each.at("by") == by; });
    EXPECT_NE(found, touching.end()) << touching;
    return found == touching.end() ? Vec3(Vec3::Zero()) : vector_of(found->at("force_N"));
  };
  const Vec3 push = of("left", "right");
  EXPECT_LT(push.x(), -0.01);
  const json& held = step.at("reactions");  // of left.base and right.base
  EXPECT_LT((vector_of(held.at(1).at("force_N")) - push).norm(), 1e-3 * push.norm());
  EXPECT_LT((vector_of(held.at(0).at("force_N")) + push).norm(), 1e-3 * push.norm());
}

}  // namespace
}  // namespace softkin::testing
