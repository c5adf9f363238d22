#include <gtest/gtest.h>

#include <filesystem>
#include <mutex>
#include <softkin/core/team.hpp>
#include <softkin/runs/store.hpp>
#include <softkin/statics/statics.hpp>
#include <thread>

#include "statics/physical_samples.hpp"

/// What several threads do at once; run under the thread sanitizer too.

namespace softkin {

namespace {

using namespace testing;

TEST(Threads, TeamsSideBySideDoEveryPieceOnce) {
  std::vector<std::thread> users;
  for (int user = 0; user < 3; ++user)
    users.emplace_back([] {
      Team team(3);
      for (int round = 0; round < 50; ++round) {
        std::vector<int> done(100, 0);  // not atomic: two threads at one index would be a race
        team.each(done.size(), [&](Index i) { ++done[i]; });
        for (const int count : done) ASSERT_EQ(count, 1);
      }
    });
  for (std::thread& user : users) user.join();
}

/// As the pieces of a factorisation do, each on a thread of its own.
TEST(Threads, ATeamOfOneIsSharedByThreads) {
  Team alone(1), several(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::vector<int>> done(8, std::vector<int>(50, 0));
    several.each(8, [&](Index piece) { alone.each(50, [&](Index i) { ++done[piece][i]; }); });
    for (const auto& each : done)
      for (const int count : each) ASSERT_EQ(count, 1);
  }
}

TEST(Threads, OneStaticsSolvesForSeveralAtOnce) {
  const Model model = compile(bending_finger());
  const Statics statics(model);
  StaticsOptions options;
  options.threads = 1;
  options.reuse_factor = false;
  const auto solve = [&](int i) {
    return statics.solve(Actuation::Constant(1, 1 + 0.02 * i), statics.rest(), options).state.positions;
  };
  std::vector<Points> alone, together(6);
  for (int i = 0; i < 6; ++i) alone.push_back(solve(i));
  std::vector<std::thread> threads;
  for (int i = 0; i < 6; ++i) threads.emplace_back([&, i] { together[i] = solve(i); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(together[i], alone[i]) << i;
}

TEST(Threads, ATeamOfTwoFindsWhatOneThreadFinds) {
  const Model model = compile(bending_finger());
  StaticsOptions options;
  std::vector<Points> found;
  for (const int threads : {1, 2}) {
    const Statics statics(model);
    options.threads = threads;
    found.push_back(statics.solve(Actuation::Constant(1, 1.1), statics.rest(), options).state.positions);
  }
  EXPECT_EQ(found[0], found[1]);
}

TEST(Threads, AStoreTakesRecordsOfSeveral) {
  runs::Store store({}, "head\n", false);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&store, t] {
      for (int i = 0; i < 50; ++i) store.append(std::to_string(t) + " " + std::to_string(i));
    });
  for (std::thread& thread : threads) thread.join();
  ASSERT_EQ(store.size(), 200u);
  std::vector<int> next(4, 0);
  store.each([&](std::size_t, std::string_view record) {
    const std::string text(record);
    const std::size_t t = text[0] - '0';
    EXPECT_EQ(std::stoi(text.substr(2)), next[t]++) << text;
    return true;
  });
}

}  // namespace

}  // namespace softkin
