#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "run_program.hpp"
#include "support/patience.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;
using testing::ProgramResult;
using testing::TemporaryFolder;

const fs::path source = SOFTKIN_SOURCE_DIR;

/// Commands of one block of a document, and their output as the document shows it.
struct CommandBlock {
  fs::path document;
  std::vector<std::pair<std::size_t, std::string>> commands;  // line, text
  std::vector<std::string> shown;
  int exit_code = 0;  // of the last command

  [[nodiscard]] std::string at(std::size_t line) const {
    return document.lexically_relative(source).string() + ":" + std::to_string(line) + ": ";
  }
};

/// Those of the Python package are run by its own tests.
std::vector<fs::path> documents() {
  std::vector<fs::path> found{source / "README.md", source / "CONTRIBUTING.md", source / "examples" / "README.md"};
  for (const auto& entry : fs::directory_iterator(source / "docs"))
    if (entry.path().extension() == ".md" && !entry.path().stem().string().starts_with("python"))
      found.push_back(entry.path());
  for (const fs::path& folder : {source / "examples", source / "examples" / "paper"})
    for (const auto& entry : fs::directory_iterator(folder))
      if (fs::exists(entry.path() / "README.md")) found.push_back(entry.path() / "README.md");
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string without_blanks(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// Is this the beginning of a command rather than the name of a program or file?
bool is_command(const std::string& text) {
  for (const char* begin : {"build/softkin ", "make ", "cmake -", "gmsh ", "scripts/"})
    if (text.starts_with(begin)) return true;
  return false;
}

/// Fenced blocks ```sh (```sh exit=N: the last command ends with that code) with the ```text that follows below the
/// same heading, lines of code by indentation, and code within a line.
class Parser {
 public:
  explicit Parser(fs::path document) : document_(std::move(document)) {}

  std::vector<CommandBlock> parse() {
    std::istringstream stream(testing::read_text(document_.string()));
    for (std::string line; std::getline(stream, line);) {
      ++line_;
      const std::string text = without_blanks(line);
      if (text.starts_with("```"))
        fence_ = fence_.empty() ? open(words_of(text.substr(3))) : "";
      else if (fence_ == "sh")
        add_line(text);
      else if (fence_ == "text" && shell_)
        blocks_[*shell_].shown.push_back(line);
      else if (fence_.empty())
        read_prose(line, text);
    }
    EXPECT_TRUE(fence_.empty()) << document_ << " ends within a block of code";
    return std::move(blocks_);
  }

 private:
  std::string open(const std::vector<std::string>& info) {
    const std::string language = info.empty() ? "none" : info[0];
    if (language != "sh") return language;
    begin_block();
    shell_ = blocks_.size() - 1;
    if (info.size() > 1 && info[1].starts_with("exit=")) blocks_.back().exit_code = std::stoi(info[1].substr(5));
    return language;
  }

  void begin_block() {
    blocks_.emplace_back();
    blocks_.back().document = document_;
  }

  void add_line(const std::string& text) {
    auto& commands = blocks_.back().commands;
    if (continued_) {
      commands.back().second += " " + text;
    } else if (text.empty() || text[0] == '#') {
      return;
    } else {
      commands.emplace_back(line_, text);
    }
    std::string& command = commands.back().second;
    continued_ = command.ends_with("\\");
    if (continued_) command.pop_back();
  }

  void read_prose(const std::string& line, const std::string& text) {
    if (text.empty()) return;
    if (line.starts_with("    ") && (continued_ || text.starts_with("build/softkin "))) {
      if (!continued_) begin_block();
      return add_line(text);
    }
    if (text[0] == '#') shell_.reset();  // a heading
    for (std::size_t from = line.find('`'); from != std::string::npos; from = line.find('`', from)) {
      const std::size_t end = line.find('`', from + 1);
      if (end == std::string::npos) return;
      const std::string code = line.substr(from + 1, end - from - 1);
      from = end + 1;
      if (!is_command(code)) continue;
      begin_block();
      blocks_.back().commands.emplace_back(line_, code);
    }
  }

  fs::path document_;
  std::size_t line_ = 0;
  std::string fence_;  // language of the block that is open; empty: none
  bool continued_ = false;
  std::optional<std::size_t> shell_;  // the last block ```sh below this heading
  std::vector<CommandBlock> blocks_;
};

ProgramResult run_line(const std::string& command) {
  return testing::run_shell("{ " + command + "\n} </dev/null 2>&1");
}

/// Options that are followed by a file that is written.
const std::set<std::string> outputs{"-o",      "--output",   "--report", "--image", "--plot",
                                    "--gcode", "--schedule", "--c",      "--numpy", "--js"};

/// Names of the Makefile's commands.
std::set<std::string> make_targets() {
  std::istringstream stream(testing::read_text(source / "Makefile"));
  std::set<std::string> targets;
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with(".PHONY:"))
      for (const std::string& name : words_of(line.substr(7))) targets.insert(name);
  return targets;
}

std::set<std::string> presets() {
  const auto file = nlohmann::json::parse(testing::read_text(source / "CMakePresets.json"));
  std::set<std::string> names;
  for (const auto& preset : file["configurePresets"]) names.insert(preset["name"].get<std::string>());
  return names;
}

/// What `make run` asks softkin to do.
std::vector<std::string> commands_of_make_run() {
  const ProgramResult dry = run_line("env -u MAKEFLAGS -u MAKELEVEL make -n -C " +
                                     testing::shell_quoted(source.string()) + " run SETUP=true");
  EXPECT_EQ(dry.exit_code, 0) << dry.output;
  std::vector<std::string> commands;
  bool continued = false;
  std::istringstream stream(dry.output);
  for (std::string line; std::getline(stream, line);) {
    if (!continued && !line.starts_with("build/softkin ")) continue;
    if (!continued) commands.emplace_back();
    continued = line.ends_with("\\");
    if (continued) line.pop_back();
    commands.back() += line;
  }
  return commands;
}

/// No command of a document takes as long: 5 minutes, more where solves take more than usual.
int longest_command_s() {
  const std::string finger = (source / "examples/pneumatic_finger/pneumatic_finger.yaml").string();
  return static_cast<int>(300 * testing::times_slower(3, [&] {
                            EXPECT_EQ(testing::run_program({"fk", finger, "--set", "air=1.4"}).exit_code, 0);
                          }));
}

/// A folder like a fresh clone in which softkin has been built.
class Clone {
 public:
  Clone() {
    fs::create_directory(folder_ / "build");
    fs::create_directory(folder_ / "out");
    fs::create_symlink(SOFTKIN_PROGRAM, folder_ / "build/softkin");
    fs::create_symlink(source / "examples", folder_ / "examples");
    fs::create_symlink(source / "docs", folder_ / "docs");
  }

  /// Each command runs once, however often it stands somewhere.
  const ProgramResult& run(const std::string& command) {
    const auto [found, added] = results_.try_emplace(command);
    if (added)
      found->second = run_line("cd " + testing::shell_quoted(folder_ / "") + " && timeout " + std::to_string(limit_s_) +
                               " " + command);
    return found->second;
  }
  [[nodiscard]] std::size_t runs() const { return results_.size(); }

 private:
  TemporaryFolder folder_;
  const int limit_s_ = longest_command_s();
  std::map<std::string, ProgramResult> results_;
};

/// A word that is a number, maybe with punctuation around, and how far another machine's may be from it.
bool number_in(const std::string& word, double& value, double& tolerance) {
  const std::size_t begin = word.find_first_of("-0123456789");
  if (begin == std::string::npos) return false;
  const std::string digits = word.substr(begin, word.find_last_of("0123456789") - begin + 1);
  const std::size_t point = digits.find('.');
  const double decimals = point == std::string::npos ? 0 : static_cast<double>(digits.size() - point - 1);
  // a solve ends some hundredths of a mm from the equilibrium, and where depends on rounding; so does what is left of
  // an error, 6e-08 or 4.6e-08
  tolerance = decimals == 0 ? 0 : std::min(0.1 + 1e-9, 100 * std::pow(10, -decimals));  // 35.6 to 35.7, too
  if (digits.find("e-") != std::string::npos) tolerance = 1e-3;
  char* end = nullptr;
  value = std::strtod(digits.c_str(), &end);
  if (decimals == 0 && tolerance == 0 && std::abs(value) > 500) tolerance = 1;  // whole steps of a motor, from a length
  return end == digits.c_str() + digits.size();
}

/// Where iterations and seconds of a row of `fk` or `follow` stand, before its status; the number of words if none do.
std::size_t place_of_effort(const std::vector<std::string>& words) {
  const bool is_row = words.size() > 3 && (words.back() == "converged" || words.back() == "reached");
  const bool counts = is_row && words[words.size() - 3].find_first_not_of("0123456789") == std::string::npos;
  return counts ? words.size() - 3 : words.size();
}

/// Are the lines equal but for rounding? Iterations and seconds, before the status or with their unit, are not
/// compared, nor what stands in the place of "..." at the end.
bool says_the_same(const std::string& shown, const std::string& printed) {
  std::vector<std::string> a = words_of(shown), b = words_of(printed);
  if (!a.empty() && a.back() == "...") {
    a.pop_back();
    b.resize(std::min(a.size(), b.size()));
  }
  if (a.size() != b.size()) return false;
  const std::size_t effort = place_of_effort(a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    double x = 0, y = 0, tolerance = 0;
    if (a[i] == b[i] || (i >= effort && i + 1 < a.size())) continue;
    if (i + 1 < a.size() && a[i + 1] == "s" && b[i + 1] == "s" && number_in(a[i], x, tolerance)) continue;
    if (!number_in(b[i], y, tolerance) || !number_in(a[i], x, tolerance) || std::abs(x - y) > tolerance) return false;
  }
  return true;
}

class Checker {
 public:
  void check(const CommandBlock& block) {
    std::string printed;
#ifndef SOFTKIN_OPENCV
    for (const auto& [line, command] : block.commands)
      if (command.starts_with("build/softkin measure ")) return;  // built without it
#endif
    for (const auto& [line, command] : block.commands) {
      const int expected = line == block.commands.back().first ? block.exit_code : 0;
      for (std::size_t from = 0; from != std::string::npos;) {
        const std::size_t next = command.find("&&", from);
        const std::string part = without_blanks(command.substr(from, next - from));
        from = next == std::string::npos ? next : next + 2;
        printed += follow(block, line, part, expected);
      }
    }
    std::istringstream stream(printed);
    std::string line;
    for (const std::string& shown : block.shown) {
      if (without_blanks(shown).empty() || without_blanks(shown) == "...") continue;
      bool found = false;
      while (!found && std::getline(stream, line)) found = says_the_same(shown, line);
      EXPECT_TRUE(found) << block.at(block.commands.back().first) << "the document shows\n  " << shown
                         << "\nbut the commands print\n"
                         << printed;
      if (!found) return;
    }
  }

  [[nodiscard]] std::size_t runs() const {
    return clone_.runs();
  }

 private:
  /// Runs or checks one command; what it prints.
  std::string follow(const CommandBlock& block, std::size_t line, const std::string& command, int expected) {
    const std::vector<std::string> words = words_of(command);
    const std::string& program = words.at(0);
    const std::string at = block.at(line) + command + ": ";
    if (program == "build/softkin" || program == "awk") return run(at, command, expected);
    if (program == "make") return make(at, words);
    if (program == "cmake") {
      check_cmake(at, words);
    } else if (program == "gmsh") {
      check_gmsh(at, block.document.parent_path(), words);
    } else if (program.starts_with("scripts/")) {
      EXPECT_TRUE(fs::exists(source / program)) << at << "no such script";
    } else if (const std::size_t tests = program.find("/tests/test_"); tests != std::string::npos) {
      EXPECT_TRUE(fs::exists(source / "tests" / program.substr(tests + 12))) << at << "no such test";
    } else if (program != "git" && program != "cd") {
      ADD_FAILURE() << at << "unknown program";
    }
    return "";
  }

  std::string run(const std::string& at, const std::string& command, int expected) {
    std::vector<std::string> words = words_of(command);
    for (std::size_t i = 0; i < words.size(); ++i) {
      const bool names_output = outputs.contains(words[i]) && i + 1 < words.size();
      const std::string file = names_output ? words[i + 1] : words[i].starts_with(">") ? words[i].substr(1) : "out/";
      EXPECT_TRUE(file.starts_with("out/")) << at << "writes outside out/";
    }
    const ProgramResult& result = clone_.run(command);
    EXPECT_EQ(result.exit_code, expected) << at << "\n" << result.output;
    return result.output;
  }

  std::string make(const std::string& at, const std::vector<std::string>& words) {
    std::string printed;
    for (std::size_t i = 1; i < words.size() && words[i] != "#"; ++i) {
      if (words[i].find('=') != std::string::npos) continue;
      EXPECT_TRUE(targets_.contains(words[i])) << at << "the Makefile has no '" << words[i] << "'";
      if (words[i] != "run") continue;
      const std::vector<std::string> commands = commands_of_make_run();
      EXPECT_FALSE(commands.empty()) << at << "runs nothing";
      for (const std::string& command : commands) printed += run(at, command, 0);
    }
    return printed;
  }

  void check_cmake(const std::string& at, const std::vector<std::string>& words) {
    for (std::size_t i = 1; i + 1 < words.size(); ++i) {
      const std::string& value = words[i + 1];
      if (words[i] == "--preset") {
        EXPECT_TRUE(presets_.contains(value)) << at << "no preset '" << value << "'";
      }
      if (words[i] == "--target") {
        EXPECT_TRUE(value == "softkin_cli" ||
                    (value.starts_with("test_") && fs::exists(source / "tests" / value.substr(5))))
            << at << "no target '" << value << "'";
      }
    }
  }

  static void check_gmsh(const std::string& at, const fs::path& folder, const std::vector<std::string>& words) {
    for (const std::string& word : words)
      if (word.ends_with(".geo")) {
        EXPECT_TRUE(fs::exists(folder / word)) << at << "no file " << word;
      }
  }

  Clone clone_;
  std::set<std::string> targets_ = make_targets(), presets_ = presets();
};

/// The part of a heading's address: lower case, blanks as hyphens, no punctuation.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '-' || c == '_' || byte > 127) anchor += static_cast<char>(std::tolower(byte));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

bool has_heading(const fs::path& document, const std::string& anchor) {
  std::istringstream stream(testing::read_text(document.string()));
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("#") && anchor_of(without_blanks(line.substr(line.find_first_not_of('#')))) == anchor)
      return true;
  return false;
}

}  // namespace

namespace {

/// Two halves, which take as long, beside each other: each of them a clone of its own, where a command that stands in
/// several documents runs once.
bool is_of_first_half(const fs::path& document) {
  return document <= source / "docs/troubleshooting.md";
}

void expect_commands_do_what_documents_say(bool first_half) {
  Checker checker;
  std::size_t shown = 0;
  for (const fs::path& document : documents()) {
    if (is_of_first_half(document) != first_half) continue;
    for (const CommandBlock& block : Parser(document).parse()) {
      const auto begin = std::chrono::steady_clock::now();
      checker.check(block);
      shown += block.shown.size();
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
      if (seconds.count() > 5) std::printf("%.1f s: %s\n", seconds.count(), block.commands.front().second.c_str());
    }
  }
  EXPECT_GE(checker.runs(), 15u);
  EXPECT_GE(shown, 3u);
}

}  // namespace

TEST(Docs, EveryCommandDoesWhatTheDocumentSays) {
  expect_commands_do_what_documents_say(true);
}

TEST(Docs, EveryCommandDoesWhatTheDocumentSaysInTheSecondHalf) {
  expect_commands_do_what_documents_say(false);
}

namespace {

/// A C++ lambda in a block of code looks like a link.
std::string without_code(const std::string& text) {
  std::string left;
  bool code = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) code = !code;
    if (!code) left += line + "\n";
  }
  return left;
}

}  // namespace

TEST(Docs, LinksLeadSomewhere) {
  std::size_t count = 0;
  for (const fs::path& document : documents()) {
    const std::string text = without_code(testing::read_text(document.string()));
    for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 2)) {
      const std::string link = text.substr(at + 2, text.find(')', at) - at - 2);
      if (link.find("://") != std::string::npos) continue;
      const std::size_t hash = link.find('#');
      const fs::path file = hash == 0 ? document : document.parent_path() / link.substr(0, hash);
      EXPECT_TRUE(fs::exists(file)) << document << " links to " << link;
      if (hash != std::string::npos) {
        EXPECT_TRUE(has_heading(file, link.substr(hash + 1))) << document << " links to " << link;
      }
      ++count;
    }
  }
  EXPECT_GE(count, 10u);
}

}  // namespace softkin
