#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/own_file.hpp>
#include <softkin/io/stream_log.hpp>

namespace softkin {
namespace {

namespace fs = std::filesystem;

TEST(OwnFile, KnowsWhatSoftkinWrites) {
  for (const std::string content :
       {"", "{\n \"softkin\": \"0.1.0\",\n \"scene\": \"a\"}\n", "{\"softkin\":\"0.1.0\"}", "{\"softkin_map\":1,",
        "# softkin workspace: format 2\n", "# made by softkin measure\n# tags\nt_s,x_mm\n",
        "softkin_curve: 1\n# made by softkin calibrate pressure\n",
        "waypoint,tip_x_mm,error_mm,reached,inserted,equilibria\n0,",
        "pose,line,column,measured,computed,difference,kept\n",
        "pose,line,column,measured,computed,difference,kept,outline_off_mm,counts\n1,",
        "<?xml version=\"1.0\"?>\n<!-- made by softkin -->\n<VTKFile",
        "$Comments\nmade by softkin\n$EndComments\n$MeshFormat\n",
        "<!doctype html><html><script type=\"application/json\" id=\"softkin-page\">",
        "materials:   # softkin calibrate material a.csv\n  - {region: body}\n  # c\n"})
    EXPECT_TRUE(is_own_content(content)) << content;
}

/// Among them what looks like softkin's and is the user's: scenes, as JSON too, materials that were made a scene,
/// tables with commands.
TEST(OwnFile, LeavesAllElseToTheUser) {
  for (const std::string content :
       {"softkin: 1\nmesh: {file: a.msh}\n", "{\"softkin\": 1, \"mesh\": {}}", "{\"a\": \"softkin\"}", "t_s,air\n0,1\n",
        "x_mm,y_mm,z_mm\n", "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">", "<svg>made by hand</svg>",
        "# softkin\n", "materials:   # softkin calibrate material a.csv\n  - {region: body}\nmesh: {file: a.msh}\n",
        "$MeshFormat\n4.1 0 8\n", "softkin is what I use\n", "\x89PNG\r\n\x1a\n and so on", "solid softkin\n", " ",
        "<!doctype html><p>softkin</p>", "2026-01-31 10:00:00 drive\n", "error_mm,reached,inserted,equilibria\n"})
    EXPECT_FALSE(is_own_content(content)) << content;
}

class OwnFileOnDisk : public ::testing::Test {
 protected:
  OwnFileOnDisk() {
    std::string name = (fs::temp_directory_path() / "softkin_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = name;
  }
  ~OwnFileOnDisk() override { fs::remove_all(folder_); }
  fs::path write(const char* name, const std::string& content) const {
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
  }

  fs::path folder_;
};

TEST_F(OwnFileOnDisk, LogsAreKnown) {
  const fs::path file = folder_ / "drive.log";
  {
    StreamLog log(file.string(), {});
    log.add('>', "G1 X3");
  }
  EXPECT_TRUE(is_own_file(file)) << read_file(file);
}

/// The place of a page's document is behind its program, which is long.
TEST_F(OwnFileOnDisk, PagesAreKnownByWhatStandsFarIn) {
  const std::string program(1 << 18, 'x');
  EXPECT_TRUE(is_own_file(write("a.html", "<!doctype html>" + program + "<script id=\"softkin-page\">")));
  EXPECT_FALSE(is_own_file(write("b.html", "<!doctype html>" + program)));
}

TEST_F(OwnFileOnDisk, OutputsAreRefusedWhereTheyWouldReplaceOthers) {
  const fs::path mine = write("mine.json", "{}"), own = write("own.json", "{\"softkin\": \"0.1.0\"}");
  const auto refusal = [](const Output& output, const std::vector<fs::path>& inputs, bool may_replace) {
    try {
      check_outputs({output}, inputs, may_replace);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal({"--report", mine}, {}, false).find("--report " + mine.string() + ": is there already"),
            std::string::npos);
  EXPECT_EQ(refusal({"--report", mine}, {}, true), "");
  EXPECT_EQ(refusal({"--report", own}, {}, false), "");
  EXPECT_NE(refusal({"--report", own}, {own}, true).find("would replace a file that is read"), std::string::npos);
  EXPECT_EQ(refusal({.option = "-o", .file = mine, .is_own = [](const fs::path&) { return true; }}, {}, false), "");
  EXPECT_THROW(check_outputs({{"--cloud", folder_ / "a.vtu"}, {"--hull", folder_ / "./a.vtu"}}, {}, true),
               InvalidInput);
  write("a_0002.vtu", "mine");
  EXPECT_EQ(refusal({"-o", folder_ / "a.pvd", 2}, {}, false), "");
  EXPECT_NE(refusal({"-o", folder_ / "a.pvd", 3}, {}, false).find("its a_0002.vtu is there already"),
            std::string::npos);
  write("b.json.run", "mine");
  EXPECT_NE(refusal({"--report", folder_ / "b.json"}, {}, false).find("its b.json.run is there already"),
            std::string::npos);
}

}  // namespace
}  // namespace softkin
