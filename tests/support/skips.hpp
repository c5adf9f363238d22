#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

/// A test that needs what a machine may lack begins with one of the macros below, or with GTEST_SKIP. `make test` lists
/// every skipped test with its reason, and `.ci/run` lets it fail (tests/support/main.cpp), but for tests of data that
/// are not in the repository.

namespace softkin::testing {

inline constexpr std::string_view absent_reference = "reference data absent (SOFTKIN_REFERENCE names their folder): ";
inline constexpr std::string_view absent_measurements = "measurements absent (SOFTKIN_REAL names their folder): ";

/// May a test be skipped for this reason even where SOFTKIN_NO_SKIP is set?
inline bool may_be_skipped(std::string_view reason) {
  return reason.starts_with(absent_reference) || reason.starts_with(absent_measurements);
}

/// The Python interpreter of the tests, which has the packages of tests/requirements.txt; never the system's.
inline std::string test_python() {
  const char* named = std::getenv("SOFTKIN_TEST_PYTHON");
  return named != nullptr ? named : SOFTKIN_TEST_PYTHON;
}

/// Does a shell command end well?
inline bool succeeds(const std::string& command) {
  return std::system(("{ " + command + "; } > /dev/null 2>&1").c_str()) == 0;
}

inline bool has_program(const std::string& name) {
  return succeeds("command -v " + name);
}

/// package: "sys" for one that every Python has
inline bool has_python_package(const std::string& package) {
  return succeeds("'" + test_python() + "' -c 'import " + package + "'");
}

}  // namespace softkin::testing

#define SKIP_WITHOUT_PROGRAM(name) \
  if (!softkin::testing::has_program(name)) GTEST_SKIP() << "the program " << (name) << " is not installed"

#define SKIP_WITHOUT_PYTHON(package)                  \
  if (!softkin::testing::has_python_package(package)) \
  GTEST_SKIP() << softkin::testing::test_python() << " has no package " << (package)

#define SKIP_WITHOUT_REFERENCE(file) \
  if (!std::filesystem::exists(file)) GTEST_SKIP() << softkin::testing::absent_reference << (file)
