#include <gtest/gtest.h>

#include <softkin/runs/file_labels.hpp>

namespace softkin::runs {
namespace {

using Labels = std::vector<std::string>;

TEST(FileLabels, AreAsShortAsTellsThemApart) {
  EXPECT_EQ(file_labels({"out/path.json", "out/paper.json"}), (Labels{"path", "paper"}));
  EXPECT_EQ(file_labels({"a/path.json", "a/path.csv"}), (Labels{"path.json", "path.csv"}));
  EXPECT_EQ(file_labels({"x/out/r.json", "y/out/r.json", "s.json"}),
            (Labels{"x/out/r.json", "y/out/r.json", "s.json"}));
  EXPECT_EQ(file_labels({"r.json", "r.json"}), (Labels{"r.json (1)", "r.json (2)"}));
  EXPECT_EQ(file_labels({"r.json", "a/r.json"}), (Labels{"r.json", "a/r.json"}));
  EXPECT_EQ(file_labels({"/r.json", "/a/r.json", "/a/r.json"}), (Labels{"/r.json", "/a/r.json (1)", "/a/r.json (2)"}));
  EXPECT_EQ(file_labels({"f.csv", "f.csv"}, {"@tip", "@base"}), (Labels{"f@tip", "f@base"}));
  EXPECT_EQ(file_labels({}), Labels{});
}

}  // namespace
}  // namespace softkin::runs
