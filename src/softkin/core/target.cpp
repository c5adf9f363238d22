#include <algorithm>
#include <cstdlib>
#include <softkin/core/error.hpp>
#include <softkin/core/target.hpp>
#include <string>

namespace softkin {

namespace {

std::string names_of(const std::vector<Target>& targets) {
  std::string names;
  for (const Target each : targets) names += (names.empty() ? "" : ", ") + std::string(name_of(each));
  return names;
}

Target choose() {
  const std::vector<Target> here = targets_here();
  if (here.empty()) throw InvalidInput("this processor has no SSE4.2, without which softkin does not run");
  const char* requested = std::getenv("SOFTKIN_TARGET");
  if (requested == nullptr || *requested == '\0') return here.front();
  const auto found =
      std::find_if(here.begin(), here.end(), [&](Target each) { return requested == std::string(name_of(each)); });
  if (found != here.end()) return *found;
  throw InvalidInput("SOFTKIN_TARGET=" + std::string(requested) +
                     ": not an instruction set that softkin is made for and this "
                     "processor has; those are " +
                     names_of(here));
}

}  // namespace

const char* name_of(Target target) {
  switch (target) {
    case Target::sse4:
      return "sse4";
    case Target::avx2:
      return "avx2";
    case Target::avx512:
      return "avx512";
    case Target::neon:
      return "neon";
    case Target::plain:
      break;
  }
  return "plain";
}

std::vector<Target> targets_here() {
#if defined(__x86_64__) && !defined(SOFTKIN_PLAIN)
  std::vector<Target> here;
  const auto has_fma = [] { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); };
  if (has_fma() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    here.push_back(Target::avx512);
  if (has_fma()) here.push_back(Target::avx2);
  if (__builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt")) here.push_back(Target::sse4);
  return here;
#elif defined(__aarch64__) && !defined(SOFTKIN_PLAIN)
  return {Target::neon};
#else
  return {Target::plain};
#endif
}

Target target() {
  static const Target chosen = choose();
  return chosen;
}

}  // namespace softkin
