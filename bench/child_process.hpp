#pragma once

#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace softkin::bench {

/// How a process ended.
struct ProcessEnd {
  int exit_code = -1;  // 128 + N where signal N ended it
  bool timed_out = false;
  double seconds = 0;   // from start to end
  double peak_mib = 0;  // largest resident set [MiB]: of the work itself, as the parent stays small

  [[nodiscard]] bool good() const { return exit_code == 0 && !timed_out; }
  /// Returns why the process failed, such as "ended by signal 9"; "" after a success.
  [[nodiscard]] std::string complaint() const;
};

/// Runs work in a process of its own, which is ended after limit seconds. What work returns comes back as bytes; what
/// it throws goes to standard error, and the exit code is 1. The caller must have no threads.
[[nodiscard]] ProcessEnd run_in_child(const std::function<std::vector<char>()>& work, double limit,
                                      std::vector<char>& bytes);

template <class Result>
struct Measured {
  std::optional<Result> result;
  ProcessEnd end;
};

/// The same for a plain struct.
template <class Result>
[[nodiscard]] Measured<Result> measure(const std::function<Result()>& work, double limit) {
  static_assert(std::is_trivially_copyable_v<Result>);
  Measured<Result> measured;
  std::vector<char> bytes;
  measured.end = run_in_child(
      [&] {
        const Result result = work();
        std::vector<char> sent(sizeof(Result));
        std::memcpy(sent.data(), &result, sizeof(Result));
        return sent;
      },
      limit, bytes);
  if (measured.end.good() && bytes.size() == sizeof(Result)) {
    measured.result.emplace();
    std::memcpy(&*measured.result, bytes.data(), sizeof(Result));
  }
  return measured;
}

/// Runs a program, found on the PATH, in a folder; its output goes to a file there ("": where this one's goes).
///
/// environment  "NAME=value", beside what this process has
[[nodiscard]] ProcessEnd run_program(const std::vector<std::string>& command, const std::string& folder,
                                     const std::string& output_file, const std::vector<std::string>& environment,
                                     double limit);

/// Is there such a program on the PATH?
[[nodiscard]] bool on_path(const std::string& program);

}  // namespace softkin::bench
