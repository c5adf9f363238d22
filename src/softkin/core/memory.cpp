#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <softkin/core/memory.hpp>
#include <softkin/core/text.hpp>

namespace softkin {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double mebi = 1024.0 * 1024;

/// The number that a file begins with; endless where it does not.
double number_in(const std::string& file) {
  double value = 0;
  return std::ifstream(file) >> value ? value : endless;
}

double free_of_machine() {
  std::ifstream file("/proc/meminfo");
  double sum = 0, kibi = 0;
  bool known = false;
  for (std::string key, unit; file >> key >> kibi && std::getline(file, unit);)
    if (key == "MemAvailable:" || key == "SwapFree:") {
      sum += 1024 * kibi;
      known = true;
    }
  return known ? sum : endless;
}

double free_of_group() {
  const std::string group = "/sys/fs/cgroup/memory.";
  const double most = number_in(group + "max"), used = number_in(group + "current");
  return used == endless ? endless : std::max(0.0, most - used);
}

double free_of_process() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return endless;
  const double pages = number_in("/proc/self/statm");
  if (pages == endless) return endless;
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(::sysconf(_SC_PAGESIZE)));
}

}  // namespace

double free_memory_bytes() {
  return std::min({free_of_machine(), free_of_group(), free_of_process()});
}

std::string memory_text(double bytes) {
  return bytes >= 1024 * mebi ? decimal(bytes / (1024 * mebi), 1) + " GiB" : decimal(bytes / mebi, 0) + " MiB";
}

}  // namespace softkin
