#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/core/together.hpp>
#include <thread>

namespace softkin {
namespace {

TEST(WorkTogether, EveryPieceIsDoneOnce) {
  for (const int threads : {1, 2, 5}) {
    std::atomic<bool> stopped = false;
    std::atomic<int> next = 0;
    std::mutex mutex;
    std::multiset<int> done;
    work_together(threads, stopped, [&] {
      const int piece = next++;
      if (piece >= 100) return false;
      const std::lock_guard lock(mutex);
      done.insert(piece);
      return true;
    });
    EXPECT_EQ(done.size(), 100u) << threads;
    EXPECT_EQ(std::set<int>(done.begin(), done.end()).size(), 100u) << threads;
    EXPECT_FALSE(stopped);
  }
}

TEST(WorkTogether, WhatIsThrownStopsTheOthersAndComesOut) {
  for (const int threads : {1, 3}) {
    std::atomic<bool> stopped = false;
    std::atomic<int> steps = 0;
    const auto step = [&] {
      if (++steps == 7) throw InvalidInput("the seventh");
      std::this_thread::yield();
      return true;  // for ever
    };
    EXPECT_THROW(work_together(threads, stopped, step), InvalidInput);
    EXPECT_TRUE(stopped);
  }
}

TEST(WorkTogether, EndsWhereItIsStopped) {
  std::atomic<bool> stopped = false;
  std::atomic<int> steps = 0;
  work_together(2, stopped, [&] {
    if (++steps == 50) stopped = true;
    return true;
  });
  EXPECT_GE(steps, 50);
  EXPECT_LT(steps, 60);
}

}  // namespace
}  // namespace softkin
