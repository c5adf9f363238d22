#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace softkin {
namespace {

namespace fs = std::filesystem;

const fs::path source = SOFTKIN_SOURCE_DIR;

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Numbers of the paper's equations that a comment names: "Eq. (4)", "Eqs. (2)-(5), (9)", over line breaks too, but not
/// "Smith et al. 2018, Eq. (13)".
std::set<int> equations_in(const std::string& comment) {
  static const std::regex citation(R"((\w+ et al\. \d{4}, )?Eqs?\. (\(\d+\)(-\(\d+\))?(, (?=\())?)+)");
  static const std::regex part(R"(\((\d+)\)(-\((\d+)\))?)");
  std::set<int> numbers;
  for (std::sregex_iterator at(comment.begin(), comment.end(), citation), end; at != end; ++at) {
    if ((*at)[1].matched && !at->str(1).starts_with("Fang ")) continue;
    const std::string text = at->str();
    for (std::sregex_iterator one(text.begin(), text.end(), part); one != end; ++one)
      for (int n = std::stoi(one->str(1)); n <= std::stoi((*one)[3].matched ? one->str(3) : one->str(1)); ++n)
        numbers.insert(n);
  }
  return numbers;
}

/// Comments of whole lines, and the declaration that follows each.
struct Docstring {
  std::string place, comment, declaration;
};

std::vector<Docstring> docstrings_in(const std::vector<std::string>& lines, const std::string& file) {
  static const std::regex whole_line(R"(\s*///?\s*(.*))");
  std::vector<Docstring> found;
  std::smatch match;
  bool inside = false, declared = true;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (std::regex_match(lines[i], match, whole_line)) {
      if (!inside) found.push_back({file + ":" + std::to_string(i + 1), "", ""});
      found.back().comment += match.str(1) + " ";
      inside = true;
      declared = false;
    } else {
      inside = false;
      if (!declared) found.back().declaration += lines[i] + " ";
      declared = declared || lines[i].find_first_of(";{") != std::string::npos || lines[i].empty();
    }
  }
  return found;
}

std::vector<Docstring> docstrings() {
  std::vector<Docstring> all;
  for (const auto& entry : fs::recursive_directory_iterator(source / "src"))
    if (entry.path().extension() == ".hpp" || entry.path().extension() == ".cpp")
      for (Docstring& one : docstrings_in(lines_of(entry.path()), entry.path().lexically_relative(source).string()))
        all.push_back(std::move(one));
  return all;
}

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::istringstream stream(row.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(cell);
  return cells;
}

/// Of each equation that docs/paper.md places in the code, the functions and types named there.
std::map<int, std::vector<std::string>> placed_equations() {
  static const std::regex number(R"( \((\d+)\) )"), name(R"(`(?:\w+::)*([A-Za-z]\w*)`)");
  std::map<int, std::vector<std::string>> placed;
  bool inside = false;
  for (const std::string& line : lines_of(source / "docs/paper.md")) {
    if (line.starts_with("#")) inside = line == "## Equations";
    std::smatch match;
    if (!inside || !line.starts_with("|")) continue;
    const std::vector<std::string> cells = cells_of(line);
    if (!std::regex_match(cells[0], match, number)) continue;
    auto& names = placed[std::stoi(match.str(1))];
    for (std::sregex_iterator at(cells.back().begin(), cells.back().end(), name), end; at != end; ++at)
      names.push_back(at->str(1));
  }
  return placed;
}

bool names(const std::string& declaration, const std::string& name) {
  return std::regex_search(declaration, std::regex("\\b" + name + "\\b"));
}

using Numbers = std::set<int>;

}  // namespace

/// If docs/paper.md names a function's equation, its docstring names it, too.
TEST(Equations, StandBesideWhatThePaperPageNames) {
  const std::vector<Docstring> all = docstrings();
  const auto placed = placed_equations();
  EXPECT_EQ(placed.size(), 19u);
  for (const auto& [number, where] : placed) {
    EXPECT_FALSE(where.empty()) << "docs/paper.md names nothing that is Eq. (" << number << ")";
    for (const std::string& name : where)
      EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                              [&, n = number](const Docstring& one) {
                                return names(one.declaration, name) && equations_in(one.comment).contains(n);
                              }))
          << "no docstring of " << name << " names Eq. (" << number << ")";
  }
}

TEST(Equations, ThatTheCodeNamesAreOnThePaperPage) {
  const auto placed = placed_equations();
  std::size_t count = 0;
  for (const Docstring& one : docstrings())
    for (const int number : equations_in(one.comment)) {
      EXPECT_TRUE(placed.contains(number)) << one.place << " names Eq. (" << number << "), which docs/paper.md lacks";
      ++count;
    }
  EXPECT_GT(count, 20u);
}

TEST(Equations, EveryRowOfThePaperPageHasTheCellsOfItsTable) {
  std::size_t cells = 0, rows = 0;
  for (const std::string& line : lines_of(source / "docs/paper.md")) {
    const std::size_t here = line.starts_with("|") ? cells_of(line).size() : 0;
    if (here > 0 && cells > 0) {
      EXPECT_EQ(here, cells) << line;
    }
    cells = here;
    rows += here > 0;
  }
  EXPECT_GT(rows, 60u);
}

TEST(Equations, AreReadOutOfComments) {
  EXPECT_EQ(equations_in("source  Fang et al. 2020, Eqs. (2)-(5), (9); r is (7)"), (Numbers{2, 3, 4, 5, 9}));
  EXPECT_EQ(equations_in("Smith et al. 2018, Eq. (13); Eq. (16), right-hand side"), Numbers{16});
  EXPECT_EQ(equations_in("the equation (3), Eq 4"), Numbers{});
}

TEST(Equations, ADocstringBelongsToWhatFollows) {
  const auto found =
      docstrings_in({"/// Eq.", "/// (4)", "template <int K>", "int f(", "    int k);", "int g();"}, "a");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(equations_in(found[0].comment), Numbers{4});
  EXPECT_TRUE(names(found[0].declaration, "f"));
  EXPECT_FALSE(names(found[0].declaration, "g"));
}

}  // namespace softkin
