#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>

namespace softkin {

/// A file of what is sent and received: every line with the time of day (UTC) and the seconds since the beginning;
/// written at once.
class StreamLog {
 public:
  /// failed  called once with the reason why a line was not written: a full disk does not stop motors that move
  /// throws  InvalidInput naming the option where the file cannot be opened
  StreamLog(const std::string& path, std::function<void(const std::string&)> failed);

  void add(char kind, std::string text);

 private:
  std::unique_ptr<FILE, int (*)(FILE*)> file_;
  std::function<void(const std::string&)> failed_;  // empty: was called
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace softkin
