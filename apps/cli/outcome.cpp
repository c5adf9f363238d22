#include "outcome.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <softkin/core/error.hpp>

namespace softkin::cli {

int answer_usage(const CLI::App& app, const CLI::ParseError& error, const std::string& command) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fprintf(stderr, "softkin: %s (%s --help tells more)\n", message.c_str(), command.c_str());
  return bad_input;
}

int outcome_of(const Run& run) {
  try {
    return run();
  } catch (const InvalidInput& error) {
    std::fprintf(stderr, "softkin: %s\n", error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    std::fprintf(stderr, "softkin: %s: %s\n", error.path1().c_str(), error.code().message().c_str());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "softkin: out of memory\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "softkin: internal error, please report it: %s\n", error.what());
  }
  return bad_input;
}

}  // namespace softkin::cli
