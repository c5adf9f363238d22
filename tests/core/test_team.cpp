#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <softkin/core/error.hpp>
#include <softkin/core/team.hpp>

namespace softkin {

TEST(Team, EveryIndexOnceLoopAfterLoop) {
  for (const int threads : {1, 2, 3, 8}) {
    Team team(threads);
    EXPECT_EQ(team.size(), threads);
    for (int loop = 0; loop < 2000; ++loop) {
      const Index count = loop % 37;
      std::vector<int> visits(count, 0);  // not atomic: two threads at one index would be a race
      team.each(count, [&](Index i) { ++visits[i]; });
      for (const int visit : visits) ASSERT_EQ(visit, 1);
    }
  }
}

TEST(Team, PiecesCoverTheRange) {
  for (const int threads : {1, 2, 5})
    for (const Index count : {0, 1, 3, 1001}) {
      Team team(threads);
      std::vector<int> visits(count, 0);
      team.pieces(count, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) ++visits[i];
      });
      for (const int visit : visits) EXPECT_EQ(visit, 1);
    }
}

TEST(Team, ZeroMeansTheMachine) {
  // hardware_concurrency() may be unknown: 0
  EXPECT_EQ(Team(0).size(), static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

TEST(Team, ResultsOfALoopAreSeenByTheNext) {
  Team team(4);
  std::vector<std::int64_t> values(512, 1);
  for (int loop = 0; loop < 500; ++loop) {
    std::vector<std::int64_t> next(values.size());
    team.each(values.size(), [&](Index i) { next[i] = values[(i + 1) % values.size()] + 1; });
    values.swap(next);
  }
  for (const std::int64_t value : values) EXPECT_EQ(value, 501);
}

/// An instruction set that there is not is refused before a loop asks for it, where what is thrown ends the program.
TEST(TeamDeathTest, IsNotMadeForAnInstructionSetThatThereIsNot) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // in a process that has not chosen yet
  EXPECT_EXIT(
      {
        setenv("SOFTKIN_TARGET", "abacus", 1);
        try {
          Team(2).each(2, [](Index) {});
        } catch (const InvalidInput& error) {
          std::fputs(error.what(), stderr);
          std::exit(3);
        }
        std::exit(0);
      },
      ::testing::ExitedWithCode(3), "SOFTKIN_TARGET=abacus: not an instruction set");
}

TEST(TeamPool, LendsATeamAgain) {
  TeamPool pool;
  const Team* first = nullptr;
  {
    const TeamPool::Lent pair = pool.lend(2), other = pool.lend(2);
    EXPECT_EQ(pair->size(), 2);
    EXPECT_NE(pair.get(), other.get());
    first = pair.get();
  }
  const TeamPool::Lent trio = pool.lend(3), one = pool.lend(2), two = pool.lend(2);
  EXPECT_EQ(trio->size(), 3);
  EXPECT_TRUE(one.get() == first || two.get() == first);
  std::atomic<int> sum{0};
  two->each(100, [&](Index i) { sum += i; });
  EXPECT_EQ(sum, 4950);
}

}  // namespace softkin
