#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "layout/cpp_members.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;
using testing::TypeDefinition;
using testing::TypeFinder;

const fs::path source_folder = SOFTKIN_SOURCE_DIR;

/// By name, the places that define it: one for each file.
using Places = std::map<std::string, std::map<std::string, std::size_t>>;

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  for (const TypeDefinition& type : TypeFinder(text).types()) names.push_back(type.name);
  return names;
}

/// visit(path, text) of every C++ file.
template <class Visit>
void each_source(const fs::path& folder, const Visit& visit) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& file = entry.path();
    if (file.extension() != ".hpp" && file.extension() != ".cpp") continue;
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    visit(file, text.str());
  }
}

Places types_below(const fs::path& folder) {
  Places places;
  each_source(folder, [&](const fs::path& file, const std::string& text) {
    try {
      for (const TypeDefinition& type : TypeFinder(text).types())
        places[type.name].try_emplace(file.lexically_relative(folder.parent_path()).string(), type.line);
    } catch (const std::runtime_error& error) {
      ADD_FAILURE() << file << ": " << error.what();
    }
  });
  return places;
}

/// One line for each type that more than one file of a program defines. A file that does so twice is the compiler's.
std::vector<std::string> defined_twice(const Places& library, const Places& program) {
  Places all = library;
  for (const auto& [name, files] : program) all[name].insert(files.begin(), files.end());
  std::vector<std::string> found;
  for (const auto& [name, files] : all) {
    if (files.size() < 2) continue;
    std::string line = name + ":";
    for (const auto& [file, number] : files) line += " " + file + ":" + std::to_string(number);
    found.push_back(line);
  }
  return found;
}

/// The library alone, with each program of `apps`, and with `bench`.
std::vector<std::string> defined_twice_in(const fs::path& root) {
  const Places library = types_below(root / "src");
  std::vector<std::string> found = defined_twice(library, {});
  std::vector<fs::path> programs;
  for (const auto& entry : fs::directory_iterator(root / "apps"))
    if (entry.is_directory()) programs.push_back(entry.path());
  if (fs::exists(root / "bench")) programs.push_back(root / "bench");
  for (const fs::path& program : programs)
    for (const std::string& line : defined_twice(library, types_below(program)))
      if (std::find(found.begin(), found.end(), line) == found.end()) found.push_back(line);
  return found;
}

/// Returns "type: members" of each type with more than `most` members.
std::vector<std::string> larger_than(std::size_t most, const std::string& text) {
  std::vector<std::string> found;
  for (const testing::MemberCount& type : testing::MemberCounter(text).types())
    if (type.members > most) found.push_back(type.name + ": " + std::to_string(type.members));
  return found;
}

using Names = std::vector<std::string>;

}  // namespace

/// What two files call the same is one type to the linker, and a program copies by the code of either.
TEST(Types, WithExternalLinkageAreDefinedOnce) {
  for (const std::string& line : defined_twice_in(source_folder)) ADD_FAILURE() << line;
  EXPECT_GT(types_below(source_folder / "src").size(), 200u);
}

TEST(Types, ThoseOfTheSampleDefinedTwiceAreFound) {
  EXPECT_EQ(defined_twice_in(source_folder / "tests/layout/twice"),
            (Names{"softkin::Pose: src/pose.hpp:7 src/statics.cpp:9",
                   "softkin::inner::Kind: src/pose.hpp:13 src/statics.cpp:15",
                   "softkin::Row: first/table.cpp:4 src/pose.hpp:18"}));
}

TEST(Types, HaveAtMostTwentyMembers) {
  for (const char* folder : {"src", "apps", "python/src", "bench"})
    each_source(source_folder / folder, [](const fs::path& file, const std::string& text) {
      for (const std::string& type : larger_than(20, text)) ADD_FAILURE() << file << ": " << type;
    });
}

TEST(Types, MembersAreCounted) {
  EXPECT_EQ(larger_than(0, "struct A { int i; double a = 0, b{1}, c[3]; std::map<int, int> m{{1, 2}}; };"),
            Names{"A: 5"});
  EXPECT_EQ(larger_than(0,
                        "class B : public A { public: B() : a_(1), b_{2} {} ~B(); int f(int, int) const { return 1; }"
                        " static int s; using T = int; friend struct C; private: const int a_ = f(1, 2), b_; };"),
            Names{"B: 2"});
  EXPECT_EQ(larger_than(0,
                        "template <class T> struct C { struct D { int i, j; }; D d; enum class E { x, y }; E e;"
                        " template <class U> void g(U u) { struct F { int k; }; } std::function<void(int)> h; };"),
            (Names{"C: 3", "D: 2"}));
  EXPECT_EQ(larger_than(0, "void f() { struct G { int i; } g; struct H* h(struct I& i); bool operator==(const J&); }"),
            Names{"G: 1"});
}

TEST(Types, NamespacesAndNestingMakeTheName) {
  EXPECT_EQ(names_in("struct A {}; namespace b { class C final : public A { struct D {}; enum E { e }; }; }"),
            (Names{"A", "b::C", "b::C::D", "b::C::E"}));
  EXPECT_EQ(names_in("namespace a::b { inline namespace c { union U { int i; }; } } struct a::b::V {};"),
            (Names{"a::b::c::U", "a::b::V"}));
  EXPECT_EQ(
      names_in("namespace a { enum class K : int { x }; struct [[nodiscard]] alignas(16) S {}; class API T {}; }"),
      (Names{"a::K", "a::S", "a::T"}));
  EXPECT_EQ(names_in("extern \"C\" { struct A {}; } namespace fs = std; using namespace std; struct B {};"),
            (Names{"A", "B"}));
}

TEST(Types, WhatOtherFilesCannotSeeIsLeftOut) {
  EXPECT_EQ(names_in("namespace { struct A { struct B {}; }; namespace c { struct D {}; } } namespace e { struct F; }"),
            Names{});
  EXPECT_EQ(names_in("void f() { struct A {}; } struct { int i; } g; auto h = [] { enum B { b }; return 1; };"),
            Names{});
  EXPECT_EQ(names_in("struct A { A() : i{0} { struct B {}; } int i{1}; void f() const noexcept { class C {}; } };"),
            Names{"A"});
}

TEST(Types, DeclarationsAreNoDefinitions) {
  EXPECT_EQ(names_in("class A; enum class B : int; friend struct C; struct D* d(struct E& e); union Fork g{};"),
            Names{});
  EXPECT_EQ(names_in("template <class T, class U = int, template <class> class V> void f(T t) { struct A {}; }"),
            Names{});
  EXPECT_EQ(names_in("struct stat f() { return {}; } enum A g() { return x; }"), Names{});
}

TEST(Types, ASpecialisationIsATypeOfItsOwn) {
  EXPECT_EQ(names_in("template <class T> struct A {}; template <> struct A<unsigned int> {}; template <> struct "
                     "A<std::vector<int>>::B : C<1> {};"),
            (Names{"A", "A<unsigned int>", "A<std::vector<int>>::B"}));
}

TEST(Types, CommentsLiteralsAndThePreprocessorAreNotRead) {
  EXPECT_EQ(names_in("// struct A {};\n/* struct B {}; */ const char* c = \"struct C { \\\" {\"; char d = '{';\n"
                     "const char* e = R\"x(struct E {\" )y\" )x\"; int f = 1'000'000;\n"
                     "#define G struct G { \\\n };\n#if 1\nstruct H {};\n#else\nstruct I {};\n#endif\n"),
            (Names{"H", "I"}));
}

TEST(Types, TextThatCannotBeReadIsRefused) {
  EXPECT_THROW(names_in("struct A {"), std::runtime_error);
  EXPECT_THROW(names_in("struct A {}; }"), std::runtime_error);
}

}  // namespace softkin
