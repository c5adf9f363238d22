#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "map_samples.hpp"
#include "page_samples.hpp"

namespace {

using namespace softkin::testing;
namespace fs = std::filesystem;

using Words = std::vector<std::string>;

const std::string mine = "softkin: 1\n# a night's work\n";

/// A command with one output: the words before its file, and the file in the folder, which may be one beside it.
struct Written {
  std::string command, option;  // "map export", "--c"
  Words words;                  // all but the option
  std::string file;             // as given
  std::string beside{};         // what is written with it; empty: the file itself

  [[nodiscard]] std::string target() const { return beside.empty() ? file : beside; }
};

/// Whatever the commands below read.
struct Workshop : BlockFolder {
  Workshop() : BlockFolder(block_scene()) {
    write("soft.yaml", scene_to_map());
    write("path.csv", "air\n1\n1.1\n");
    write("way.csv", "t_s,x_mm\n0,20.05\n1,20.1\n");
    write("walk.yaml",
          "softkin: 1\nmesh: {file: block.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3, shape_ratio: 1}]\n"
          "fixed: [{region: base}, {region: tip, axes: yz}]\n"
          "actuators: [{name: tendon, kind: cable, points: [[0, 6, 6], [20, 6, 6]], control: tension, range: [0, 5]}]\n"
          "markers: [{name: heel, region: base}, {name: toe, region: tip}]\n"
          "feet: [{marker: heel, forward: 0.02, backward: 9}, {marker: toe, forward: 0.02, backward: 9}]\n");
    write("gait.csv", "tendon_N\n0\n1\n0\n");
    write("grasp.yaml",
          "softkin: 1\nmesh: {file: block.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3, density: 1000}]\n"
          "fixed: [{region: base}]\ngravity: [0, 0, -9.81]\ncontact: {distance: 0.05, friction: 0.4}\n"
          "obstacles: [{name: floor, halfspace: {point: [0, 0, -1.06], normal: [0, 0, 1]}}]\n"
          "bodies: [{name: cube, box: [[40, 0, -1], [60, 20, 19]], density: 1000}]\n");
    write("drive.yaml", replaced(physical_scene(), "volume, range: [0.5, 3]", "pressure, range: [0, 50]"));
    write("drive.hardware.yaml",
          "softkin_hardware: 1\nboard: {approach_speed_mm_per_s: 4}\n"
          "tendons: [{actuator: tendon, axis: X, max_speed_mm_per_s: 8}]\n"
          "chambers: [{actuator: air, limits_kPa: [0, 50]}]\n");
    write("drive.csv", "t_s,tendon,air_kPa\n0,1,0\n1,0.9,5\n");
    write("syringe.csv", syringe());
    write("dea.csv", "voltage_kv,area_ratio\n0,1\n1,1.02\n2,1.09\n3,1.2\n");
    write("poses.csv", "tendon,air_kPa,tip_x_mm,tip_z_mm\n1,0,20,6\n0.95,5,19.9,6.2\n");
    write("read.csv", "tip_x_mm\n20\n");
    write("tensile.csv", "strain,stress_mpa\n0,0\n0.1,0.1\n0.2,0.19\n0.3,0.28\n0.4,0.36\n0.5,0.44\n");
    write("relaxation.csv", relaxation());
    EXPECT_EQ(run({"fk", "block.yaml", "--path", "path.csv", "--report", "new.json"}).exit_code, 0);
    fs::rename(*this / "new.json", *this / "a.json");
    EXPECT_EQ(run({"map", "soft.yaml", "-o", "new.skmap", "--accuracy", "1", "--shape-accuracy", "1", "--check", "1"})
                  .exit_code,
              0);
    fs::rename(*this / "new.skmap", *this / "arm.skmap");
  }

  static std::string syringe() {
    std::string text = "p_gauge_kpa,dv_sy_mm3\n";
    for (int p = 0; p <= 40; p += 10)
      text += std::to_string(p) + "," + std::to_string(192 * (1 + 0.01 * p) + 620 - 81200.0 / (100 + p)) + "\n";
    return text;
  }
  static std::string relaxation() {
    std::string text = "t_s,strain,stress_mpa\n";
    for (int i = 0; i <= 20; ++i)
      text += std::to_string(i) + ",0.2," + std::to_string(0.1 + 0.05 * std::exp(-0.3 * i)) + "\n";
    return text;
  }

  /// In the folder.
  [[nodiscard]] ProgramResult run(Words words) const {
    for (std::string& word : words)
      if (fs::exists(*this / word) || word.starts_with("new")) word = *this / word;
    return run_program(words);
  }
  [[nodiscard]] ProgramResult run(const Written& to, const Words& more = {}) const {
    Words words = to.words;
    if (to.option != "OUT") words.push_back(to.option);
    words.push_back(*this / to.file);
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
};

/// One for every option of every command that names what is written.
std::vector<Written> all_outputs() {
  const Words fk{"fk", "block.yaml", "--path", "path.csv"}, ik{"ik", "block.yaml", "--target", "tip=20.1,,"};
  const Words follow{"follow", "block.yaml", "way.csv", "--marker", "tip"}, walk{"walk", "walk.yaml", "gait.csv"};
  const Words to_follow{"follow", "block.yaml", "way.csv", "--marker", "tip", "-o", "new"};
  const Words to_walk{"walk", "walk.yaml", "gait.csv", "-o", "new"};
  const Words space{"workspace", "block.yaml", "--samples", "3"};
  const Words to_space{"workspace", "block.yaml", "--samples", "3", "-o", "new.csv"};
  const Words grasp{"grasp", "grasp.yaml", "--pull", "x"}, drive{"drive", "drive.yaml", "drive.csv"};
  const Words map{"map", "soft.yaml", "--accuracy", "1", "--shape-accuracy", "1", "--check", "1"};
  const Words to_map{"map", "soft.yaml", "--accuracy", "1", "--shape-accuracy", "1", "--check", "1", "-o", "new.skmap"};
  const Words exporting{"map", "export", "arm.skmap"}, steps{"compare", "a.json", "a.json"};
  const Words pressure{"calibrate", "pressure",         "syringe.csv", "--syringe-volume",
                       "600mm3",    "--chamber-volume", "0.192mL"};
  const Words dea{"calibrate", "dea", "dea.csv"}, tensile{"calibrate", "material", "--tensile", "tensile.csv"};
  const Words robot{"calibrate", "robot", "drive.yaml", "poses.csv"};
  const Words estimate{"estimate", "drive.yaml", "read.csv", "--unknown", "air", "--deviation", "1"};
  const Words relaxation{"calibrate", "relaxation", "relaxation.csv"}, convert{"mesh", "convert", "block.msh"};
  return {
      {"fk", "-o", fk, "a.vtu"},
      {"fk", "-o", fk, "a.pvd"},
      {"fk", "-o", fk, "a.pvd", "a_0001.vtu"},
      {"fk", "-o", fk, "a.pvd", "a_stopped.vtu"},
      {"fk", "--report", fk, "b.json"},
      {"fk", "--report", fk, "b.json", "b.json.run"},
      {"fk", "--trace", fk, "t.csv"},
      {"fk", "--image", fk, "a.png"},
      {"fk", "--plot", fk, "a.svg"},
      {"fk", "--strains", fk, "s.svg"},
      {"fk", "--html", fk, "a.html"},
      {"ik", "-o", ik, "a.vtu"},
      {"ik", "--report", ik, "b.json"},
      {"ik", "--image", ik, "a.png"},
      {"ik", "--plot", ik, "a.svg"},
      {"follow", "-o", follow, "out", "out/commands.csv"},
      {"follow", "-o", follow, "out", "out/errors.csv"},
      {"follow", "-o", follow, "out", "out/report.json"},
      {"follow", "-o", follow, "out", "out/report.json.run"},
      {"follow", "-o", follow, "out", "out/path.svg"},
      {"follow", "-o", follow, "out", "out/path.pvd"},
      {"follow", "-o", follow, "out", "out/path_0001.vtu"},
      {"follow", "--plot", to_follow, "a.svg"},
      {"follow", "--html", to_follow, "a.html"},
      {"walk", "-o", walk, "out", "out/walk.csv"},
      {"walk", "-o", walk, "out", "out/walk.svg"},
      {"walk", "-o", walk, "out", "out/walk.pvd"},
      {"walk", "-o", walk, "out", "out/walk_0000.vtu"},
      {"walk", "-o", walk, "out", "out/report.json"},
      {"walk", "--html", to_walk, "a.html"},
      {"workspace", "-o", space, "s.csv"},
      {"workspace", "--cloud", to_space, "a.vtu"},
      {"workspace", "--hull", to_space, "a.vtu"},
      {"workspace", "--plot", to_space, "a.svg"},
      {"workspace", "--html", to_space, "a.html"},
      {"grasp", "--table", grasp, "t.csv"},
      {"grasp", "-o", grasp, "a.vtu"},
      {"grasp", "--image", grasp, "a.png"},
      {"map", "-o", map, "a.skmap"},
      {"map", "--html", to_map, "a.html"},
      {"map export", "--c", exporting, "a.h"},
      {"map export", "--numpy", exporting, "a.npz"},
      {"map export", "--js", exporting, "a.mjs"},
      {"map export", "--js", exporting, "a.mjs", "a.d.mts"},
      {"drive", "--gcode", drive, "a.gcode"},
      {"drive", "--schedule", drive, "a.csv"},
      {"compare", "--plot", steps, "a.svg"},
      {"compare", "--html", steps, "a.html"},
      {"compare", "-o", {"compare", "a.json", "a.json", "--marker", "tip"}, "e.csv"},
      {"calibrate pressure", "-o", pressure, "air.yaml"},
      {"calibrate pressure", "--table", pressure, "t.csv"},
      {"calibrate pressure", "--plot", pressure, "a.svg"},
      {"calibrate dea", "-o", dea, "skin.yaml"},
      {"calibrate dea", "--plot", dea, "a.svg"},
      {"calibrate material", "-o", tensile, "m.yaml"},
      {"calibrate material", "--plot", tensile, "a.svg"},
      {"calibrate material", "--residuals", tensile, "t.csv"},
      {"calibrate robot", "--report", robot, "b.json"},
      {"calibrate robot", "--table", robot, "t.csv"},
      {"calibrate robot", "--plot", robot, "a.svg"},
      {"estimate", "--report", estimate, "b.json"},
      {"estimate", "--table", estimate, "t.csv"},
      {"calibrate relaxation", "-o", relaxation, "m.yaml"},
      {"calibrate relaxation", "--plot", relaxation, "a.svg"},
      {"calibrate relaxation", "--residuals", relaxation, "t.csv"},
      {"mesh convert", "OUT", convert, "a.msh"},
      {"mesh convert", "OUT", convert, "a.vtu"},
      {"mesh convert", "OUT", convert, "a.stl"},
#ifdef SOFTKIN_OPENCV
      {"measure board", "-o", {"measure", "board", "5x4,tag=12mm,gap=3mm"}, "a.svg"},
      {"measure board", "-o", {"measure", "board", "5x4,tag=12mm,gap=3mm", "--dpi", "30"}, "a.png"},
#endif
  };
}

const Workshop& workshop() {
  static const Workshop folder;
  return folder;
}

/// The folder as it was, but for what the commands read.
void tidy_up(const Workshop& folder, const Written& to) {
  for (const std::string& name : {to.file, to.target(), std::string("new"), std::string("new.csv"),
                                  std::string("new.skmap"), std::string("a_0000.vtu"), std::string("a_0001.vtu")})
    fs::remove_all(folder / name);
}

/// A user's file stays, a file that softkin wrote is replaced, and --force-overwrite replaces either.
TEST(Overwriting, OutputsReplaceOnlyWhatSoftkinWrote) {
  const Workshop& folder = workshop();
  for (const Written& to : all_outputs()) {
    SCOPED_TRACE(to.command + " " + to.option + " " + to.target());
    if ((to.option == "--html" || to.option == "--js") && !softkin::runs::page_is_there()) continue;
    tidy_up(folder, to);
    const std::string target = folder / to.target();
    fs::create_directories(fs::path(target).parent_path());
    folder.write(to.target(), mine);
    const std::size_t before = folder.files();
    const ProgramResult refused = folder.run(to);
    EXPECT_EQ(refused.exit_code, 2) << refused.output;
    EXPECT_EQ(refused.output, "");
    EXPECT_EQ(std::count(refused.errors.begin(), refused.errors.end(), '\n'), 1) << refused.errors;
    expect_words(refused.errors, {"is there already, and not by softkin", "--force-overwrite",
                                  fs::path(to.target()).filename().string()});
    EXPECT_EQ(read_text(target), mine);
    EXPECT_EQ(folder.files(), before);
    const ProgramResult forced = folder.run(to, {"--force-overwrite"});
    EXPECT_EQ(forced.exit_code, 0) << forced.errors;
    EXPECT_NE(read_text(target), mine);
    const ProgramResult again = folder.run(to);
    EXPECT_EQ(again.exit_code, 0) << again.errors;
    tidy_up(folder, to);
  }
}

/// Commands with their options as --help lists them: "--report F.json".
std::vector<std::pair<std::string, std::string>> file_options(const std::string& command, const std::string& help) {
  static const std::regex option(R"(\n  (?:(-\w),)?(--[\w-]+) (F(?:\.[\w.]+)?|DIR)(?=\s)|\n  (OUT) )");
  std::vector<std::pair<std::string, std::string>> all;
  for (std::sregex_iterator found(help.begin(), help.end(), option), end; found != end; ++found)
    all.emplace_back(command, (*found)[1].matched ? (*found)[1] : (*found)[4].matched ? (*found)[4] : (*found)[2]);
  return all;
}

Words all_commands() {
  Words all{"fk", "ik", "follow", "walk", "workspace", "grasp", "map", "map export", "drive", "compare", "view"};
  for (const char* kind : {"pressure", "dea", "material", "relaxation", "robot"})
    all.push_back(std::string("calibrate ") + kind);
  for (const char* kind : {"info", "check", "convert"}) all.push_back(std::string("mesh ") + kind);
  for (const char* kind : {"list", "copy"}) all.push_back(std::string("examples ") + kind);
#ifdef SOFTKIN_OPENCV
  for (const char* kind : {"measure", "measure camera", "measure board"}) all.emplace_back(kind);
#endif
  return all;
}

/// An option that names a file is read, or stands above; --pull has a direction.
TEST(Overwriting, EveryOutputOptionIsTested) {
  const std::set<std::string> read{"--path",      "--map",     "--start",    "--workspace", "--hardware",
                                   "--pressures", "--tensile", "--twist",    "--creep",     "--sum",
                                   "--pull",      "--camera",  "--outlines", "--options"};
  std::set<std::pair<std::string, std::string>> tested;
  for (const Written& each : all_outputs()) tested.emplace(each.command, each.option);
  for (const auto& [command, option] : {std::pair("drive", "--log"), {"measure", "-o"}, {"measure camera", "-o"}})
    tested.emplace(command, option);  // below
  std::size_t options = 0;
  for (const std::string& command : all_commands()) {
    Words words;
    std::istringstream all(command + " --help");
    for (std::string word; all >> word;) words.push_back(word);
    const ProgramResult help = run_program(words);
    ASSERT_EQ(help.exit_code, 0) << command;
    for (const auto& option : file_options(command, help.output)) {
      ++options;
      EXPECT_TRUE(read.contains(option.second) || tested.contains(option)) << option.first << " " << option.second;
    }
  }
  EXPECT_GT(options, 45u);
}

TEST(Overwriting, LogsOfADriveAreRefusedBeforeThePortIsOpened) {
  const Workshop& folder = workshop();
  const std::string log = folder.write("drive.log", mine);
  const ProgramResult result = folder.run({"drive", "drive.yaml", "drive.csv", "--port", "/dev/null", "--log", log});
  EXPECT_EQ(result.exit_code, 2);
  expect_words(result.errors, {"--log " + log + ": is there already, and not by softkin"});
  EXPECT_EQ(read_text(log), mine);
}

#ifdef SOFTKIN_OPENCV
TEST(Overwriting, MeasurementsAreRefusedBeforeAPictureIsRead) {
  const Workshop& folder = workshop();
  for (const Words& command : {Words{"measure", "none.png", "--tags", "--scale-board", "5x4,tag=12mm,gap=3mm", "-o"},
                               Words{"measure", "camera", "none.png", "--board", "checker,9x6,square=10mm", "-o"}}) {
    Words words = command;
    const std::string file = folder.write(words[1] == "camera" ? "camera.yaml" : "track.csv", mine);
    words.push_back(file);
    const ProgramResult result = folder.run(words);
    EXPECT_EQ(result.exit_code, 2);
    expect_words(result.errors, {"-o " + file + ": is there already, and not by softkin"});
    words.emplace_back("--force-overwrite");
    expect_words(folder.run(words).errors, {"none.png"});
    EXPECT_EQ(read_text(file), mine);
    fs::remove(file);
  }
}
#endif

/// Inputs are never overwritten, whatever the options, also under another name of the same file.
TEST(Overwriting, InputsAreNeverReplaced) {
  const Workshop& folder = workshop();
  fs::create_hard_link(folder / "path.csv", folder / "linked.csv");
  fs::create_symlink(folder / "path.csv", folder / "pointed.csv");
  const std::string path = read_text(folder / "path.csv"), mesh = read_text(folder / "block.msh");
  for (const char* name : {"path.csv", "linked.csv", "pointed.csv"}) {
    const ProgramResult result =
        folder.run({"fk", "block.yaml", "--path", "path.csv", "--trace", folder / name, "--force-overwrite"});
    EXPECT_EQ(result.exit_code, 2);
    expect_words(result.errors, {"--trace " + folder / name + ": would replace a file that is read"});
  }
  const ProgramResult converted =
      folder.run({"mesh", "convert", "block.msh", folder / "block.msh", "--force-overwrite"});
  EXPECT_EQ(converted.exit_code, 2);
  expect_words(converted.errors, {"OUT " + folder / "block.msh" + ": would replace a file that is read"});
  EXPECT_EQ(read_text(folder / "path.csv"), path);
  EXPECT_EQ(read_text(folder / "block.msh"), mesh);
}

/// Commands that were changed by hand are the user's.
TEST(Overwriting, CommandsThatWereEditedStay) {
  const Workshop& folder = workshop();
  const Words follow{"follow", "block.yaml", "way.csv", "--marker", "tip", "-o", "new"};
  ASSERT_EQ(folder.run(follow).exit_code, 0);
  const std::string commands = "new/commands.csv", text = read_text(folder / commands);
  folder.write(commands, text + "2,1.5\n");
  const ProgramResult refused = folder.run(follow);
  EXPECT_EQ(refused.exit_code, 2);
  expect_words(refused.errors, {"commands.csv: is there already, and not by softkin"});
  folder.write(commands, text);
  EXPECT_EQ(folder.run(follow).exit_code, 0);
  fs::remove_all(folder / "new");
}

TEST(Overwriting, ReportsAreJson) {
  const Workshop& folder = workshop();
  for (const Words& command : {Words{"fk", "block.yaml"}, Words{"ik", "block.yaml", "--target", "tip=20,6,6"}}) {
    Words words = command;
    words.insert(words.end(), {"--report", folder / "block.yaml"});
    const ProgramResult result = folder.run(words);
    EXPECT_EQ(result.exit_code, 2);
    expect_words(result.errors, {"--report", "block.yaml: must end in .json"});
  }
  for (const auto& [option, ending] : {std::pair{"--gcode", ".gcode"}, std::pair{"--schedule", ".csv"}}) {
    const ProgramResult result = folder.run({"drive", "drive.yaml", "drive.csv", option, folder / "new.txt"});
    EXPECT_EQ(result.exit_code, 2);
    expect_words(result.errors, {std::string(option), "must end in ", ending});
  }
}

}  // namespace
