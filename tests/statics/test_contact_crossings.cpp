#include <gtest/gtest.h>

#include <cstdio>
#include <map>

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

/// A start that does not tell where its supports are: they come from there to their places.
TEST(ContactCrossings, RandomDropsFromShapesOfNoKnownShare) {
  for (const std::uint64_t seed : {73, 97, 101, 120, 121, 122})
    for (const PressedDrop::Shape& shape : press_drop(seed, 3, false).shapes)
      EXPECT_EQ(shape.crossings, 0u) << "seed " << seed;
}

}  // namespace
}  // namespace softkin
