#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>

#include "layout/cpp_docstrings.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;
using testing::DocstringFinder;

const fs::path project_folder = SOFTKIN_SOURCE_DIR;

using Headers = std::vector<std::string>;

std::string text_of_source(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// A list of cmake/public_headers.cmake.
Headers headers_of(const std::string& list) {
  const std::string text = text_of_source(project_folder / "cmake/public_headers.cmake");
  const std::size_t begin = text.find("set(" + list);
  if (begin == std::string::npos) return {};
  std::istringstream words(text.substr(begin, text.find(')', begin) - begin));
  Headers headers;
  std::string word;
  for (words >> word; words >> word;) headers.push_back(word);
  return headers;
}
Headers public_headers() {
  return headers_of("softkin_public_headers");
}
Headers included_headers() {
  return headers_of("softkin_included_headers");
}

/// What a source includes of softkin, below its folder.
Headers includes_of(const fs::path& file) {
  static const std::regex line(R"(#include ["<]softkin/([^">]+)[">])");
  const std::string text = text_of_source(file);
  Headers found;
  for (std::sregex_iterator match(text.begin(), text.end(), line), end; match != end; ++match)
    found.push_back((*match)[1].str());
  return found;
}

bool is_in(const Headers& headers, const std::string& header) {
  return std::find(headers.begin(), headers.end(), header) != headers.end();
}

/// "name:line" of each name without a docstring.
Headers bare_names(const std::string& text) {
  Headers found;
  const DocstringFinder docstrings(text);
  for (const DocstringFinder::Name& name : docstrings.bare())
    found.push_back(name.name + ":" + std::to_string(name.line));
  return found;
}

}  // namespace

TEST(Headers, ThatAreInstalledAreThereAndListedOnce) {
  std::set<std::string> seen;
  for (const Headers& list : {public_headers(), included_headers()})
    for (const std::string& header : list) {
      EXPECT_TRUE(fs::is_regular_file(project_folder / "src/softkin" / header)) << header;
      EXPECT_TRUE(seen.insert(header).second) << header << " is listed twice";
    }
  EXPECT_GT(public_headers().size(), 45u);
}

TEST(Headers, ThatAreInstalledIncludeEachOtherAlone) {
  Headers all = public_headers();
  const Headers included = included_headers();
  all.insert(all.end(), included.begin(), included.end());
  for (const std::string& header : all)
    for (const std::string& other : includes_of(project_folder / "src/softkin" / header))
      EXPECT_TRUE(is_in(all, other)) << header << " includes " << other << ", which is not installed";
}

TEST(Headers, ThatAreThereForTheCompilerAreIncludedByPublicOnes) {
  std::set<std::string> reached;
  Headers open = public_headers();
  while (!open.empty()) {
    const std::string header = open.back();
    open.pop_back();
    for (const std::string& other : includes_of(project_folder / "src/softkin" / header))
      if (reached.insert(other).second) open.push_back(other);
  }
  for (const std::string& header : included_headers()) EXPECT_TRUE(reached.contains(header)) << header;
}

TEST(Headers, ThatArePublicHaveADocstringForEveryName) {
  std::size_t names = 0;
  for (const std::string& header : public_headers()) {
    const DocstringFinder found(text_of_source(project_folder / "src/softkin" / header));
    names += found.names();
    for (const DocstringFinder::Name& name : found.bare())
      ADD_FAILURE() << "src/softkin/" << header << ":" << name.line << ": " << name.name << " has no docstring";
  }
  EXPECT_GT(names, 1500u);
}

/// cpp.md has a row for each of them and none for another.
TEST(Headers, ThatArePublicAreInTheTableOfTheDocument) {
  static const std::regex row(R"(\n\| `([\w/]+\.hpp)` \|)");
  const std::string text = text_of_source(project_folder / "docs/cpp.md");
  Headers reported;
  for (std::sregex_iterator match(text.begin(), text.end(), row), end; match != end; ++match)
    reported.push_back((*match)[1].str());
  EXPECT_EQ(reported, public_headers());
}

TEST(Headers, OfTheExamplesArePublic) {
  const Headers listed = public_headers();
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(project_folder / "examples/cpp"))
    for (const std::string& header : includes_of(entry.path())) {
      EXPECT_TRUE(is_in(listed, header)) << entry.path() << " includes " << header;
      ++count;
    }
  EXPECT_GE(count, 6u);
}

TEST(Docstrings, StandAboveOrBehind) {
  EXPECT_EQ(bare_names("/// A.\nstruct A {\n  int a = 0;  // [mm]\n  int b = 0, c = 0;\n\n  /// D.\n  int d() const;\n"
                       "  int e() const { return 1; }  // E\n};\n"),
            (Headers{"A::b:4"}));
  EXPECT_EQ(
      bare_names("struct B {  // of wire\n  std::function<bool(int)> c{};\n};\n\nint f(int a,\n      int b);  // F\n"
                 "enum class G { g };\nusing H = int;\n"),
      (Headers{"B::c:2", "G:7", "H:8"}));
}

TEST(Docstrings, AreOfAWholeRunWithoutEmptyLines) {
  EXPECT_EQ(bare_names("/// All of them.\nint a();\nint b();\nint c();\n\nint d();\n"), (Headers{"d:6"}));
  EXPECT_EQ(bare_names("/// A.\nstruct A {};\nint b();\n"), (Headers{"b:3"}));
  EXPECT_EQ(bare_names("int a();  // one\nint b();\n"), (Headers{"b:2"}));
  EXPECT_EQ(bare_names("struct A {  // a\n  int a = 0;  // long,\n              // and so on\n  int b = 0;\n};\n"),
            (Headers{"A::b:4"}));
}

TEST(Docstrings, AreNotAskedOfWhatIsInsideOrSaysNothingNew) {
  EXPECT_EQ(bare_names("struct A;\n/// B.\nclass B {\n public:\n  B();  // empty\n  ~B();\n  B(const B&) = delete;\n"
                       "  B(B&&) noexcept;\n  B& operator=(B&&) noexcept;\n  void f() override;\n  using C::g;\n\n"
                       " private:\n  struct Parts;\n  int i_ = 0;\n};\nvoid B::f() {\n  int j = 0;\n}\n"
                       "namespace fs = std::filesystem;\n"),
            Headers{});
}

TEST(Docstrings, AreLookedForInEveryScope) {
  EXPECT_EQ(
      bare_names("namespace a::b {\n// C.\nstruct C {\n  struct D {\n    int e;\n  };\n  C() : f{1}, g(2) {}\n"
                 "  int f{0}, g = 0;\n};\ntemplate <class T>\nvoid h(T t = {}) {\n  t();\n}\n}  // namespace a::b\n"
                 "int k = 0;\n"),
      (Headers{"C::D::e:5", "C::D:4", "C::C:7", "C::f:8", "h:10", "k:15"}));
}

}  // namespace softkin
