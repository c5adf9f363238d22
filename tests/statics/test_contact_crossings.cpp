#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <softkin/io/scene/scene.hpp>
#include <string>
#include <vector>

#include "statics/contact_scenes.hpp"
#include "statics/pressed_drops.hpp"
#include "support/degenerate_scenes.hpp"
#include "support/exact_crossing.hpp"

/// Whatever a solve ends with, nothing has passed through anything: decided exactly.

namespace softkin {
namespace {

using namespace testing;

const char* word_for(Status status) {
  return status == Status::converged ? "converged" : status == Status::limit ? "limit" : "not converged";
}

TEST(ContactCrossings, DegenerateScenes) {
  for (const double distance : {0.24, 0.4})
    for (int kind = 0; kind < static_cast<int>(DegenerateCase::count); ++kind) {
      RobotSpec spec = degenerate_scene(static_cast<DegenerateCase>(kind), 1.25, 3).robot;
      spec.contact = contact_below(distance);
      const Model model = compile(spec);
      const Statics statics(model);
      const Equilibrium found = statics.solve({}, statics.rest());
      const SolveReport& report = found.report;
      EXPECT_TRUE(crossings(found.state.positions, model.contact.triangles).empty()) << spec.name;
      EXPECT_EQ(report.status, Status::converged) << spec.name << ", " << distance << ": " << report.remark;
      std::printf("%-16s distance %.2f: %-13s reached %.3f, %4d iterations, %3d equilibria, %.2f s %s\n",
                  spec.name.c_str(), distance, word_for(report.status), report.reached, report.iterations,
                  report.continuation_steps, report.seconds, report.remark.c_str());
    }
}

TEST(ContactCrossings, RandomDrops) {
  std::map<Status, int> counts;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const PressedDrop run = press_drop(seed, 1);
    for (const PressedDrop::Shape& shape : run.shapes) {
      ++counts[shape.report.status];
      EXPECT_EQ(shape.crossings, 0u) << "seed " << seed;
    }
  }
  EXPECT_GT(counts[Status::converged], 30);
  for (const auto& [status, count] : counts) std::printf("%s: %d\n", word_for(status), count);
}

TEST(ContactCrossings, RandomDropsInSteps) {
  for (std::uint64_t seed = 100; seed < 110; ++seed)
    for (const PressedDrop::Shape& shape : press_drop(seed, 3).shapes)
      EXPECT_EQ(shape.crossings, 0u) << "seed " << seed;
}

/// A start may not contain the places of its supports: they then move from where they are to their targets.
TEST(ContactCrossings, RandomDropsFromShapesOfNoKnownShare) {
  for (const std::uint64_t seed : {73, 97, 101, 120, 121, 122})
    for (const PressedDrop::Shape& shape : press_drop(seed, 3, false).shapes)
      EXPECT_EQ(shape.crossings, 0u) << "seed " << seed;
}

/// Where the documents take them, from rest.
TEST(ContactCrossings, ExamplesAndScenesOfTheDocuments) {
  struct Pose {
    const char* scene;
    std::map<std::string, double> commands;
  };
  const std::vector<Pose> poses{
      {"docs/scenes/finger_on_floor.yaml", {{"air", 1.3}}},
      {"docs/scenes/finger_on_smooth_floor.yaml", {{"air", 1.3}}},
      {"docs/scenes/arm_around_rod.yaml", {{"tendon1", 0.75}, {"tendon2", 0.7}, {"tendon3", 0.7}}},
      {"docs/scenes/actuator_on_ball.yaml", {{"air1", 1.57}, {"air2", 1.53}, {"air3", 1.1}}},
      {"examples/two_finger_gripper/two_finger_gripper.yaml", {{"left.air", 1.15}, {"right.air", 1.15}}}};
  for (const Pose& pose : poses) {
    SCOPED_TRACE(pose.scene);
    const Model model = compile(read_scene(std::string(SOFTKIN_SOURCE_DIR) + "/" + pose.scene));
    Actuation actuation = model.rest_actuation();
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      if (const auto found = pose.commands.find(model.actuators[a].name); found != pose.commands.end())
        actuation[a] = found->second;
    const Statics statics(model);
    const Equilibrium found = statics.solve(actuation, statics.rest());
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    EXPECT_FALSE(statics.measured(found.state).contacts.value().pairs.empty());
    EXPECT_EQ(crossings(found.state.positions, model.contact.triangles).size(), 0u);
  }
}

}  // namespace
}  // namespace softkin
