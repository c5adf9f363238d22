#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <iterator>
#include <softkin/statics/statics.hpp>
#include <thread>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

/// Threads of this process.
std::ptrdiff_t threads_now() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), std::filesystem::directory_iterator());
}

/// Returns if this process has a number of threads. One that has ended may be listed for a moment.
bool has_threads(std::ptrdiff_t count) {
  for (int wait = 0; wait < 500 && threads_now() != count; ++wait)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return threads_now() == count;
}

/// Returns equilibria on the path of the first actuator from rest to a ratio, each solved from the last.
std::vector<Points> walk_to(const Model& model, const Statics& statics, double ratio, const StaticsOptions& options) {
  std::vector<Points> shapes;
  Actuation command = model.rest_actuation();
  State state = statics.rest();
  for (int step = 1; step <= 4; ++step) {
    command[0] = 1 + (ratio - 1) * step / 4;
    state = statics.solve(command, state, options).state;
    shapes.push_back(state.positions);
    shapes.push_back(statics.sensitivity(state, options).positions.front());
  }
  return shapes;
}

std::vector<RobotSpec> both_formulations() {
  return {bending_finger(), finger_robot(true)};
}

}  // namespace

TEST(Sessions, SeveralThreadsAtOnceGetWhatOneAfterAnotherGets) {
  const std::vector<double> ratios{1.1, 1.2, 1.3, 0.9};
  for (const RobotSpec& robot : both_formulations())
    for (const int threads : {1, 2})
      for (const bool reuse : {false, true}) {
        const Model model = compile(robot);
        StaticsOptions options;
        options.threads = threads;
        options.reuse_factor = reuse;
        const Statics alone(model), shared(model);
        std::vector<std::vector<Points>> one_by_one, at_once(ratios.size());
        for (const double ratio : ratios) one_by_one.push_back(walk_to(model, alone, ratio, options));
        std::vector<std::thread> users;
        for (std::size_t i = 0; i < ratios.size(); ++i)
          users.emplace_back([&, i] { at_once[i] = walk_to(model, shared, ratios[i], options); });
        for (std::thread& user : users) user.join();
        // a factor that is used again may by then belong to another thread, which changes the last digits
        const double fraction = reuse ? 1e-6 : 0;
        for (std::size_t i = 0; i < ratios.size(); ++i)
          for (std::size_t s = 0; s < one_by_one[i].size(); ++s)
            EXPECT_LE((at_once[i][s] - one_by_one[i][s]).norm(), fraction * one_by_one[i][s].norm())
                << threads << " threads, walk " << i << ", shape " << s << (reuse ? ", factors reused" : "");
      }
}

/// A small move from an equilibrium is solved with the factor that is there, to what a new object finds.
TEST(Sessions, SmallMovesNeedNoFactorisation) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  Actuation command = model.rest_actuation();
  State state = statics.rest();
  for (const double ratio : {1.3, 1.3002, 1.3005, 1.3004}) {
    command[0] = ratio;
    const Equilibrium found = statics.solve(command, state);
    ASSERT_EQ(found.report.status, Status::converged);
    if (ratio == 1.3) {
      EXPECT_GT(found.report.factorisations, 0);
    } else {
      EXPECT_EQ(found.report.factorisations, 0) << ratio;
    }
    const Equilibrium alone = Statics(model).solve(command, Statics(model).rest());
    EXPECT_LT(largest_move(found.state.positions, alone.state.positions), 10 * found.report.tolerance_mm);
    EXPECT_NEAR(found.state.multipliers[0], alone.state.multipliers[0], 1e-5 * std::abs(alone.state.multipliers[0]));
    state = found.state;
  }
}

TEST(Sessions, ThreadsAreStartedOnceAndEndWithTheStatics) {
  const std::ptrdiff_t before = threads_now();
  for (const RobotSpec& robot : both_formulations()) {
    const Model model = compile(robot);
    StaticsOptions options;
    options.threads = 3;
    {
      const Statics statics(model);
      for (int again = 0; again < 3; ++again) {
        walk_to(model, statics, 1.1, options);
        EXPECT_TRUE(has_threads(before + 2));
      }
    }
    EXPECT_TRUE(has_threads(before));
  }
}

TEST(Sessions, SmallRobotsStartNoThreadUnasked) {
  const Model model = compile(bending_finger());
  const std::ptrdiff_t before = threads_now();
  const Statics statics(model);
  walk_to(model, statics, 1.1, {});
  EXPECT_TRUE(has_threads(before));
}

}  // namespace softkin
