#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <softkin/core/memory.hpp>

namespace softkin {
namespace {

constexpr double mebi = 1024.0 * 1024;

TEST(Memory, IsNamedWithItsUnit) {
  EXPECT_EQ(memory_text(320 * mebi), "320 MiB");
  EXPECT_EQ(memory_text(1536 * mebi), "1.5 GiB");
}

TEST(Memory, FreeIsWhatTheProcessMayStillTake) {
  EXPECT_GT(free_memory_bytes(), mebi);
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit limit{256 * 1024 * 1024, RLIM_INFINITY};
    const bool limited = ::setrlimit(RLIMIT_AS, &limit) == 0;
    const double free = free_memory_bytes();
    ::_exit(limited && free >= 0 && free < 256 * mebi ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace softkin
