#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/runs/map_export.hpp>
#include <softkin/runs/map_file.hpp>
#include <softkin/runs/page.hpp>

#include "page_samples.hpp"
#include "run_program.hpp"
#include "runs/small_maps.hpp"
#include "support/skips.hpp"

namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;
namespace runs = softkin::runs;

struct ExportFolder : TemporaryFolder {
  softkin::MapData data = runs::testing::cable_map();
  std::string map = *this / "arm.skmap";

  ExportFolder() { runs::write_map(map, data); }

  [[nodiscard]] ProgramResult run(const std::vector<std::string>& options) const {
    std::vector<std::string> all{"map", "export", map};
    all.insert(all.end(), options.begin(), options.end());
    return run_program(all);
  }

  /// One line on standard error, exit code 2, nothing written.
  void refused(const std::vector<std::string>& options, const std::string& message) const {
    const std::size_t before = files();
    const std::string bytes = read_text(map);
    const ProgramResult result = run(options);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(result.output, "") << message;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    expect_words(result.errors, {"softkin: ", message});
    EXPECT_EQ(files(), before) << message;
    EXPECT_EQ(read_text(map), bytes);
  }
};

std::string size_text(const std::string& file) {
  return file + ": " + softkin::number(static_cast<double>(fs::file_size(file)) / 1000, 3) + " kB";
}

TEST(MapExport, WritesWhatIsAskedAndTellsItsSize) {
  const ExportFolder folder;
  const std::string c = folder / "new/arm.h", numpy = folder / "arm.npz", js = folder / "arm.mjs",
                    types = folder / "arm.d.mts";
  SKIP_WITHOUT_PAGE();
  const ProgramResult result = folder.run({"--c", c, "--numpy", numpy, "--js", js});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(read_text(c), runs::map_c_header(folder.data, runs::CNumbers::doubles));
  EXPECT_EQ(read_text(numpy), runs::map_npz(folder.data));
  EXPECT_EQ(read_text(js), runs::map_js_module(folder.data));
  EXPECT_EQ(read_text(types), runs::map_js_types(folder.data));
  const std::vector<std::string> lines = lines_of(result.output);
  ASSERT_EQ(lines.size(), 4u) << result.output;
  EXPECT_EQ(lines[0].rfind(size_text(c) + "; " + runs::c_name(folder.data) + "_fk(), ...; tables: ", 0), 0u)
      << lines[0];
  expect_words(lines[0], {" bytes of flash", "Stack: about "});
  EXPECT_EQ(lines[1], size_text(numpy));
  EXPECT_EQ(lines[2], size_text(js));
  EXPECT_EQ(lines[3], size_text(types) + "; types");
}

TEST(MapExport, FloatsAreSmaller) {
  const ExportFolder folder;
  const std::string c = folder / "arm.h";
  const ProgramResult result = folder.run({"--c", c, "--float"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(folder.files(), 2u);
  EXPECT_EQ(read_text(c), runs::map_c_header(folder.data, runs::CNumbers::floats));
}

TEST(MapExport, RefusesWhatDoesNotFit) {
  const ExportFolder folder;
  folder.refused({}, "give --c F.h, --numpy F.npz or --js F.mjs");
  folder.refused({"--numpy", folder / "a.npz", "--float"}, "it needs --c F.h");
  folder.refused({"--c", folder / "a.npz"}, "--c");
  folder.refused({"--numpy", folder / "a.npz", "--js", folder / "a.js"}, "must end in .mjs");
  folder.refused({"--c", folder.map}, "must end in .h");
  folder.refused({"--c", folder / "a.h", "--output", folder / "b.skmap"}, "--output");
  fs::create_directory(folder / "taken.d.mts");
  folder.refused({"--js", folder / "taken.mjs"}, "taken.d.mts");
  fs::create_symlink(folder.map, folder / "same.npz");
  folder.refused({"--c", folder / "a.h", "--numpy", folder / "same.npz"}, "same.npz");
}

TEST(MapExport, RefusesFilesThatAreNoMaps) {
  const ExportFolder folder;
  const std::string whole = read_text(folder.map);
  for (const std::string& bytes : {std::string("a,b\n1,2\n"), std::string(), whole.substr(0, whole.size() - 100),
                                   whole.substr(0, whole.find('\n') - 3)}) {
    folder.write("arm.skmap", bytes);
    folder.refused({"--c", folder / "a.h"}, folder.map + ": is ");
  }
  fs::remove(folder.map);
  const ProgramResult none = folder.run({"--numpy", folder / "a.npz"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_EQ(none.errors, "softkin: " + folder.map + ": no such file\n");
}

/// "map" works as before.
TEST(MapExport, IsACommandBesideMakingMaps) {
  const ExportFolder folder;
  const auto reported = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2);
    return result.errors;
  };
  EXPECT_EQ(reported({"map", "-o", "a.skmap"}), "softkin: SCENE is required (softkin map --help shows more)\n");
  EXPECT_EQ(reported({"map", "a.yaml"}), "softkin: --output is required (softkin map --help shows more)\n");
  EXPECT_EQ(reported({"map", "export"}), "softkin: MAP is required (softkin map export --help shows more)\n");
  expect_words(reported({"map", "a.yaml", "export", folder.map, "--c", folder / "a.h"}), {"export excludes SCENE"});
  expect_words(reported({"map", "--seed", "3", "export", folder.map, "--c", folder / "a.h"}),
               {"export excludes --seed"});
  EXPECT_EQ(folder.files(), 1u);
}

/// The block of code in docs/maps.md of this language that has these words; there must be one.
std::string block_of(const std::string& language, const std::string& words) {
  const std::string text = read_text(SOFTKIN_SOURCE_DIR "/docs/maps.md"), begin = "\n```" + language + "\n";
  std::vector<std::string> found;
  for (std::size_t from = text.find(begin); from != std::string::npos; from = text.find(begin, from)) {
    from += begin.size();
    const std::string block = text.substr(from, text.find("```", from) - from);
    if (block.find(words) != std::string::npos) found.push_back(block);
  }
  EXPECT_EQ(found.size(), 1u) << "blocks in " << language << " with '" << words << "' in docs/maps.md";
  return found.empty() ? "" : found[0];
}

/// The robot of docs/maps.md and its map, which is less accurate, in the forms for other programs; made once.
class MapExportPrograms : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const std::string robot = SOFTKIN_SOURCE_DIR "/examples/three_chamber_actuator/three_chamber_actuator.yaml";
    const std::string file = *folder_ / "out/actuator.skmap";
    const ProgramResult made = run_program({"map", robot, "-o", file, "--accuracy", "0.5", "--load-accuracy", "1",
                                            "--shape-accuracy", "1", "--check", "1"});
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    std::vector<std::string> words{
        "map", "export", file, "--c", *folder_ / "out/actuator.h", "--float", "--numpy", *folder_ / "out/actuator.npz"};
    if (runs::page_is_there()) words.insert(words.end(), {"--js", *folder_ / "out/actuator.mjs"});
    const ProgramResult all = run_program(words);
    ASSERT_EQ(all.exit_code, 0) << all.errors;
    map_ = std::make_unique<softkin::KinematicMap>(runs::read_map(file));
  }
  static void TearDownTestSuite() {
    map_.reset();
    folder_.reset();
  }

  /// What a command prints in the folder of the exported files.
  [[nodiscard]] static std::string printed(const std::string& command) {
    const ProgramResult result = run_shell("cd " + shell_quoted(*folder_ / "out") + " && { " + command + "\n} 2>&1");
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return result.output;
  }
  [[nodiscard]] static Eigen::VectorXd outputs_at(const double* commands) {
    Eigen::VectorXd outputs(map_->outputs());
    EXPECT_TRUE(map_->evaluate(commands, outputs.data()));
    return outputs;
  }

  static constexpr double commands_[] = {1.2, 1.0, 1.1};  // those of the document
  static std::unique_ptr<TemporaryFolder> folder_;
  static std::unique_ptr<softkin::KinematicMap> map_;
};

std::unique_ptr<TemporaryFolder> MapExportPrograms::folder_;
std::unique_ptr<softkin::KinematicMap> MapExportPrograms::map_;

TEST_F(MapExportPrograms, CProgramOfTheDocumentGivesTheOutputsOfTheMap) {
  SKIP_WITHOUT_PROGRAM("cc");
  folder_->write("out/main.c", block_of("c", "actuator.h"));
  const std::vector<std::string> lines =
      lines_of(printed("cc -std=c99 -Wall -Wextra -Werror main.c -o main && ./main"));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NEAR(std::stod(lines[0]), outputs_at(commands_)[3], 1e-3);
  std::istringstream words(lines[1]);
  Eigen::Vector3d found;
  for (double& value : found) words >> value;
  EXPECT_LT((outputs_at(found.data()).head<3>() - Eigen::Vector3d(10, -5, 140)).norm(), 0.05);  // of 4 decimals
}

TEST_F(MapExportPrograms, PythonProgramOfTheDocumentGivesTheOutputsOfTheMap) {
  SKIP_WITHOUT_PYTHON("numpy");
  folder_->write("out/main.py", "import os\nos.chdir('..')\n" + block_of("python", "NumpyMap(") +
                                    "assert shape.shape[0] == 1 and shape.size > 3\nprint(outputs[0, 0])\n");
  const std::string text = printed("PYTHONPATH=" + shell_quoted(SOFTKIN_SOURCE_DIR "/examples/python") + " " +
                                   shell_quoted(test_python()) + " main.py");
  EXPECT_NEAR(number_after(text, ""), outputs_at(commands_)[0], 1e-9);
}

TEST_F(MapExportPrograms, JavaScriptProgramOfTheDocumentGivesTheOutputsOfTheMap) {
  SKIP_WITHOUT_PAGE();
  SKIP_WITHOUT_PROGRAM("node");
  folder_->write("out/main.mjs", block_of("js", "actuator.mjs") +
                                     "if (!reached || vertices.length < 3 || jacobian.length !== outputs.length) throw "
                                     "new Error('no shape');\nconsole.log(outputs[0]);\n");
  EXPECT_NEAR(number_after(printed("node main.mjs"), ""), outputs_at(commands_)[0], 1e-9);
}

}  // namespace
