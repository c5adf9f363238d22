#include "command_line.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>

#include "machine.hpp"

namespace softkin::bench {

void print_machine() {
  std::printf("%s\n", machine_text().c_str());
  std::fflush(stdout);
}

Option& Option::check(const Check& check) {
  switch (check.kind) {
    case Check::Kind::positive:
      option_->check(CLI::PositiveNumber);
      break;
    case Check::Kind::not_negative:
      option_->check(CLI::NonNegativeNumber);
      break;
    case Check::Kind::integers:
      option_->check(CLI::Range(static_cast<int>(check.least), static_cast<int>(check.most)));
      break;
    case Check::Kind::numbers:
      option_->check(CLI::Range(check.least, check.most));
      break;
    case Check::Kind::words:
      option_->check(CLI::IsMember(check.words));
      break;
    case Check::Kind::file:
      option_->check(CLI::ExistingFile);
  }
  return *this;
}

Option& Option::split_at_commas() {
  option_->delimiter(',');
  return *this;
}

void Option::hide() {
  option_->group("");
}

CommandLine::CommandLine(const std::string& about, const std::string& name)
    : app_(std::make_unique<CLI::App>(about, name)) {
  app_->option_defaults()->always_capture_default();
}

CommandLine::~CommandLine() = default;

template <class T>
Option CommandLine::add_option(const std::string& name, T& value, const std::string& about) {
  return Option(app_->add_option(name, value, about));
}

template Option CommandLine::add_option(const std::string&, double&, const std::string&);
template Option CommandLine::add_option(const std::string&, int&, const std::string&);
template Option CommandLine::add_option(const std::string&, unsigned&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::string&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<int>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<std::string>&, const std::string&);

void CommandLine::add_flag(const std::string& name, bool& value, const std::string& about) {
  app_->add_flag(name, value, about);
}

int run_benchmark(CommandLine& line, int argc, char** argv, const std::function<int()>& body) {
  try {
    line.app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return line.app_->exit(error) == 0 ? 0 : 2;
  }
  try {
    return body();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", line.app_->get_name().c_str(), error.what());
    return 2;
  }
}

}  // namespace softkin::bench
