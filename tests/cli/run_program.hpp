#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temporary_folder.hpp"

namespace softkin::testing {

struct ProgramResult {
  int exit_code = -1;  // 128 + N where signal N ended it
  std::string output, errors;
};

inline std::string read_text(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << "no '" << word << "' in:\n" << text;
}

/// The number that stands after some words; a failure where they or it are missing.
inline double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  double number = 0;
  if (at == std::string::npos || !(std::istringstream(text.substr(at + words.size())) >> number))
    ADD_FAILURE() << "no number after '" << words << "' in:\n" << text;
  return number;
}

inline std::string shell_quoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Runs a shell's command line; the result's errors stay empty.
inline ProgramResult run_shell(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
  ProgramResult result;
  std::array<char, 4096> bytes;
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), pipe))
    result.output.append(bytes.data(), count);
  const int status = ::pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

/// Runs softkin with these arguments, without input and without a terminal.
inline ProgramResult run_program(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const std::string errors = folder / "stderr";
  std::string command = shell_quoted(SOFTKIN_PROGRAM);
  for (const std::string& argument : arguments) command += " " + shell_quoted(argument);
  ProgramResult result = run_shell(command + " </dev/null 2>" + shell_quoted(errors));
  result.errors = read_text(errors);
  return result;
}

}  // namespace softkin::testing
