#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace softkin::bench {

void print_machine();

/// What values an option takes.
struct Check {
  enum class Kind { positive, not_negative, integers, numbers, words, file } kind;
  double least = 0, most = 0;
  std::vector<std::string> words;
};
inline Check positive() {
  return {Check::Kind::positive, 0, 0, {}};
}
inline Check not_negative() {
  return {Check::Kind::not_negative, 0, 0, {}};
}
inline Check within(int least, int most) {
  return {Check::Kind::integers, double(least), double(most), {}};
}
inline Check within(double least, double most) {
  return {Check::Kind::numbers, least, most, {}};
}
inline Check one_of(std::vector<std::string> words) {
  return {Check::Kind::words, 0, 0, std::move(words)};
}
inline Check existing_file() {
  return {Check::Kind::file, 0, 0, {}};
}

class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option& check(const Check& check);
  Option& split_at_commas();
  /// Leaves the option out of the output of `--help`.
  void hide();

 private:
  CLI::Option* option_;
};

/// The arguments of a benchmark. CLI11's header takes the compiler nine seconds: command_line.cpp alone reads it, not
/// each of the benchmarks.
class CommandLine {
 public:
  explicit CommandLine(const std::string& about, const std::string& name = "");
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  ~CommandLine();

  /// Numbers and words, and lists of them; what the value is now is the default.
  template <class T>
  Option add_option(const std::string& name, T& value, const std::string& about = "");
  void add_flag(const std::string& name, bool& value, const std::string& about);

 private:
  friend int run_benchmark(CommandLine& line, int argc, char** argv, const std::function<int()>& body);

  std::unique_ptr<CLI::App> app_;
};

/// Parses the arguments and runs a benchmark. Exit codes: what body returns, 2 on bad usage or
/// input.
int run_benchmark(CommandLine& line, int argc, char** argv, const std::function<int()>& body);

}  // namespace softkin::bench
