#include <cmath>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>
#include <tuple>

#include "fk_samples.hpp"
#include "start_program.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;
namespace fs = std::filesystem;

using Rows = std::vector<std::vector<std::string>>;

/// Rows of a .csv, the header first.
Rows read_rows(const std::string& file) {
  Rows rows;
  std::istringstream text(read_text(file));
  for (std::string line; std::getline(text, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

double cell(const Rows& rows, std::size_t row, const std::string& column) {
  const auto& header = rows.at(0);
  const auto found = std::find(header.begin(), header.end(), column);
  EXPECT_NE(found, header.end()) << "no column " << column;
  return std::stod(rows.at(row + 1).at(found - header.begin()));
}

/// The block with a chamber and a tendon, and a path of its tip that actuation made, so that it can be reached.
struct FollowFolder : BlockFolder {
  std::string path, out;
  std::vector<std::array<double, 2>> targets;  // x, z [mm]

  explicit FollowFolder(const std::string& text = physical_scene()) : BlockFolder(text), out(*this / "out") {
    const std::string commands = write("made.csv", "air,tendon\n1.1,0.97\n1.2,0.95\n1.3,0.94\n1.35,0.92\n1.4,0.9\n");
    EXPECT_EQ(run_fk(scene, {"--path", commands, "--report", *this / "made.json"}).exit_code, 0);
    const json made = json::parse(read_text(*this / "made.json"));
    std::string csv = "t_s,tip_x_mm,tip_z_mm\n";
    for (const json& step : made["steps"]) {
      targets.push_back({step["markers"]["tip"][0], step["markers"]["tip"][2]});
      char row[120];
      std::snprintf(row, sizeof row, "%.1f,%.12f,%.12f\n", 0.5 * double(targets.size()), targets.back()[0],
                    targets.back()[1]);
      csv += row;
    }
    path = write("path.csv", csv);
  }

  [[nodiscard]] ProgramResult follow(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments{"follow", scene, path, "-o", out, "--threads", "1"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  }

  /// Checks for exit code 2 and one line on standard error with the message; nothing else is printed or written.
  void expect_refused(const std::vector<std::string>& options, const std::string& message) const {
    const std::size_t before = files();
    const ProgramResult result = follow(options);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(result.output, "") << message;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
    EXPECT_EQ(files(), before) << message;
  }
};

TEST(Follow, WritesCommandsThatForwardKinematicsConfirms) {
  const FollowFolder folder;
  const ProgramResult result = folder.follow();
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("5 waypoints, 5 reached to 0.001 mm"), std::string::npos) << result.output;
  ASSERT_EQ(run_fk(folder.scene, {"--path", folder.out + "/commands.csv", "--report", folder / "fk.json"}).exit_code,
            0);
  const json fk = json::parse(read_text(folder / "fk.json")),
             report = json::parse(read_text(folder.out + "/report.json"));
  const Rows errors = read_rows(folder.out + "/errors.csv");
  ASSERT_EQ(fk["steps"].size(), 5u);
  ASSERT_EQ(report["steps"].size(), 5u);
  ASSERT_EQ(errors.size(), 6u);
  for (std::size_t i = 0; i < 5; ++i) {
    const json &tip = fk["steps"][i]["markers"]["tip"], &step = report["steps"][i];
    const double error =
        std::hypot(tip[0].get<double>() - folder.targets[i][0], tip[2].get<double>() - folder.targets[i][1]);
    EXPECT_LE(error, 1e-3 + 1e-5);
    EXPECT_NEAR(cell(errors, i, "error_mm"), error, 1e-5);
    EXPECT_NEAR(cell(errors, i, "tip_x_mm"), tip[0].get<double>(), 1e-5);
    EXPECT_NEAR(cell(errors, i, "tip_target_z_mm"), folder.targets[i][1], 1e-9);
    EXPECT_EQ(cell(errors, i, "reached"), 1);
    EXPECT_EQ(cell(errors, i, "inserted"), 0);
    EXPECT_NEAR(fk["steps"][i]["time_s"].get<double>(), 0.5 * double(i + 1), 1e-12);
    EXPECT_EQ(step["waypoint"]["status"], "reached");
    EXPECT_TRUE(step["waypoint"]["targets"]["tip"][1].is_null());  // y has no column
    EXPECT_GE(step["waypoint"]["equilibria"].get<int>(), 1);
    EXPECT_TRUE(fs::exists(folder.out + "/" + step["shape"].get<std::string>()));
  }
  EXPECT_EQ(report["follow"]["method"], "newton");
  EXPECT_NE(read_text(folder.out + "/path.pvd").find("path_0004.vtu"), std::string::npos);
  pugi::xml_document plot;
  EXPECT_TRUE(plot.load_string(read_text(folder.out + "/path.svg").c_str()));
  for (const char* text : {"error [mm]", "x [mm]", "z [mm]", "target", "reached", "command [-]", "time [s]"})
    EXPECT_NE(read_text(folder.out + "/path.svg").find(">" + std::string(text) + "<"), std::string::npos) << text;
}

/// The commands are the same with samples made during the run and with those of a workspace; errors and jumps are in
/// the columns that inverse kinematics writes, too.
TEST(Follow, TakesTheNearestSamplesInstead) {
  const FollowFolder folder;
  const ProgramResult made = folder.follow({"--method", "nearest", "--samples", "30"});  // 5 x 5 of them
  EXPECT_EQ(made.exit_code, 1);
  expect_words(made.output, {"5 waypoints, 5 at their nearest samples: error at most ", "6.00 equilibria per waypoint",
                             "from waypoint to waypoint commands change by at most ", " % of a range"});
  expect_words(made.errors, {"waypoints 0 to 4 were not reached: the commands are those of the nearest sample"});
  const json report = json::parse(read_text(folder.out + "/report.json"));
  EXPECT_EQ(report["follow"]["method"], "nearest");
  const Rows errors = read_rows(folder.out + "/errors.csv"), commands = read_rows(folder.out + "/commands.csv");
  EXPECT_EQ(cell(errors, 0, "equilibria"), 26);
  EXPECT_EQ(cell(errors, 0, "command_change"), 0);
  for (std::size_t i = 0; i < 5; ++i) {
    for (const auto& [name, low, high] : {std::tuple("air", 0.5, 3.0), std::tuple("tendon", 0.5, 1.2)}) {
      const double fraction = 4 * (cell(commands, i, name) - low) / (high - low);
      EXPECT_NEAR(fraction, std::round(fraction), 1e-9) << name;
    }
    EXPECT_GT(cell(errors, i, "error_mm"), 0.01);
    if (i == 0) continue;
    const double change = std::max(std::abs(cell(commands, i, "air") - cell(commands, i - 1, "air")) / 2.5,
                                   std::abs(cell(commands, i, "tendon") - cell(commands, i - 1, "tendon")) / 0.7);
    double square = 0;
    for (const char* axis : {"tip_x_mm", "tip_y_mm", "tip_z_mm"})
      square += std::pow(cell(errors, i, axis) - cell(errors, i - 1, axis), 2);
    EXPECT_NEAR(cell(errors, i, "command_change"), change, 1e-9);
    EXPECT_NEAR(cell(errors, i, "step_mm"), std::sqrt(square), 1e-9);
    EXPECT_EQ(report["steps"][i]["waypoint"]["command_change"], cell(errors, i, "command_change"));
  }
  const std::string samples = folder / "samples.csv", by_samples = read_text(folder.out + "/commands.csv");
  ASSERT_EQ(run_program({"workspace", folder.scene, "--samples", "25", "-o", samples}).exit_code, 0);
  const ProgramResult known = folder.follow({"--method", "nearest", "--workspace", samples});
  EXPECT_EQ(known.exit_code, 1) << known.errors;
  EXPECT_EQ(read_text(folder.out + "/commands.csv"), by_samples);
  EXPECT_EQ(cell(read_rows(folder.out + "/errors.csv"), 0, "equilibria"), 1);
}

TEST(Follow, NeedsSamplesForTheNearestOnes) {
  const FollowFolder folder;
  folder.expect_refused({"--samples", "25"}, "--samples are those of --method nearest");
  folder.expect_refused({"--method", "nearest"}, "takes the samples of one of --workspace F.csv and --samples N");
  folder.expect_refused({"--method", "nearest", "--workspace", "w.csv", "--samples", "8"},
                        "takes the samples of one of --workspace F.csv and --samples N");
  folder.expect_refused({"--method", "nearest", "--workspace", folder / "none.csv"}, "none.csv");
  folder.expect_refused({"--method", "nearest", "--samples", "8", "--descents", "3"}, "--descents");
}

TEST(Follow, TellsWhatIsOutOfReach) {
  const FollowFolder folder;
  folder.write("path.csv", read_text(folder.path) + "4,60,6\n5,20.5,6\n");
  const ProgramResult result = folder.follow();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("waypoint 5 was not reached"), std::string::npos) << result.errors;
  const Rows errors = read_rows(folder.out + "/errors.csv"), commands = read_rows(folder.out + "/commands.csv");
  EXPECT_EQ(cell(errors, 5, "reached"), 0);
  EXPECT_GT(cell(errors, 5, "error_mm"), 10);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_GE(cell(commands, i, "air"), 0.5);
    EXPECT_LE(cell(commands, i, "air"), 3);
    EXPECT_GE(cell(commands, i, "tendon"), 0.5);
    EXPECT_LE(cell(commands, i, "tendon"), 1.2);
  }
  EXPECT_NE(read_text(folder.out + "/path.svg").find(">not reached<"), std::string::npos);
}

TEST(Follow, InsertsWaypointsAndWritesThePlotElsewhere) {
  const FollowFolder folder;
  ASSERT_EQ(folder.follow({"--max-step", "0.4", "--plot", folder / "p.svg"}).exit_code, 0);
  const Rows errors = read_rows(folder.out + "/errors.csv");
  ASSERT_GT(errors.size(), 6u);
  int inserted = 0;
  for (std::size_t i = 0; i + 1 < errors.size(); ++i) {
    inserted += static_cast<int>(cell(errors, i, "inserted"));
    if (i == 0) continue;
    EXPECT_LE(std::hypot(cell(errors, i, "tip_target_x_mm") - cell(errors, i - 1, "tip_target_x_mm"),
                         cell(errors, i, "tip_target_z_mm") - cell(errors, i - 1, "tip_target_z_mm")),
              0.4 + 1e-9);
    EXPECT_GT(cell(errors, i, "t_s"), cell(errors, i - 1, "t_s"));
  }
  EXPECT_EQ(inserted + 6, static_cast<int>(errors.size()));
  EXPECT_TRUE(fs::exists(folder / "p.svg"));
  EXPECT_FALSE(fs::exists(folder.out + "/path.svg"));
}

TEST(Follow, LeadsSeveralMarkers) {
  const FollowFolder folder;
  const json made = json::parse(read_text(folder / "made.json"));
  std::string csv = "corner_z_mm,tip_x_mm\n";
  for (const json& step : made["steps"])
    csv += std::to_string(step["markers"]["corner"][2].get<double>()) + "," +
           std::to_string(step["markers"]["tip"][0].get<double>()) + "\n";
  folder.write("path.csv", csv);
  const ProgramResult result = folder.follow();
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Rows errors = read_rows(folder.out + "/errors.csv"), commands = read_rows(folder.out + "/commands.csv");
  EXPECT_EQ(commands[0], (std::vector<std::string>{"air", "tendon"}));  // no times
  for (std::size_t i = 0; i < 5; ++i) {
    const double corner = std::abs(cell(errors, i, "corner_z_mm") - cell(errors, i, "corner_target_z_mm"));
    const double tip = std::abs(cell(errors, i, "tip_x_mm") - cell(errors, i, "tip_target_x_mm"));
    EXPECT_NEAR(cell(errors, i, "error_mm"), std::max(corner, tip), 1e-9);
    EXPECT_LE(cell(errors, i, "error_mm"), 1e-3);
    EXPECT_NEAR(cell(commands, i, "air"), made["steps"][i]["actuation"]["air"].get<double>(), 0.01);
  }
  EXPECT_NE(read_text(folder.out + "/path.svg").find(">tip: reached<"), std::string::npos);
}

TEST(Follow, LoadsHaveTheirUnitsInTheCommands) {
  FollowFolder folder;
  ASSERT_EQ(folder.follow().exit_code, 0);
  const std::string scene = folder.write("loaded.yaml", loaded_scene());
  const ProgramResult result =
      run_program({"follow", scene, folder.path, "-o", folder / "loads", "--json", "--threads", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, read_text(folder / "loads/report.json"));
  const Rows commands = read_rows(folder / "loads/commands.csv");
  EXPECT_EQ(commands[0], (std::vector<std::string>{"t_s", "air_kPa", "tendon_N"}));
  EXPECT_EQ(run_fk(scene, {"--path", folder / "loads/commands.csv"}).exit_code, 0);
}

TEST(Follow, AlgorithmTwoIsAsAccurateAsItIsAsked) {
  const FollowFolder folder;
  ASSERT_EQ(folder.follow({"--method", "gradient"}).exit_code, 0);
  const Rows errors = read_rows(folder.out + "/errors.csv");
  for (std::size_t i = 0; i < 5; ++i) EXPECT_LE(cell(errors, i, "error_mm"), 0.2);
}

TEST(Follow, StartsFromTheNearestSampleOfAWorkspace) {
  const FollowFolder folder;
  const std::string workspace = folder / "workspace.csv";
  const ProgramResult sampled =
      run_program({"workspace", folder.scene, "--samples", "121", "-o", workspace, "--threads", "1"});
  ASSERT_EQ(sampled.exit_code, 0) << sampled.errors;
  ASSERT_EQ(folder.follow().exit_code, 0);
  const double from_rest = cell(read_rows(folder.out + "/errors.csv"), 0, "equilibria");
  ASSERT_EQ(folder.follow({"--workspace", workspace}).exit_code, 0);
  EXPECT_LE(cell(read_rows(folder.out + "/errors.csv"), 0, "equilibria"), from_rest);
  folder.write("block.yaml", replaced(physical_scene(), "youngs_modulus: 1,", "youngs_modulus: 2,"));
  fs::remove_all(folder.out);
  folder.expect_refused({"--workspace", workspace}, "is of another robot");
  folder.expect_refused({"--workspace", folder / "absent.csv"}, "no such file");
}

TEST(Follow, RefusesBadPathsWithLineAndColumn) {
  const FollowFolder folder;
  const auto refuse = [&](const std::string& csv, const std::string& message) {
    folder.write("path.csv", csv);
    folder.expect_refused({}, message);
  };
  refuse("tip_x_mm,tip_z_mm\n20,6\n20,nan\n", "path.csv:3: column 'tip_z_mm'");
  refuse("tip_x_m,tip_z_m\n0.02,0.006\n", "path.csv:1: column 'tip_x_m': lengths are in mm");
  refuse("tpi_x_mm\n20\n", "did you mean 'tip'?");
  refuse("x_mm\n20\n", "say whose all are");
  refuse("", "has no header");
  refuse("tip_x_mm\n", "no row");
  folder.write("path.csv", "x_mm\n20\n");
  folder.expect_refused({"--marker", "edge"}, "no marker 'edge'");
  folder.expect_refused({"--marker", "tip", "--max-step", "0"}, "--max-step");
  folder.expect_refused({"--marker", "tip", "--max-step", "1e-9", "--tolerance", "-1"}, "--tolerance");
  folder.expect_refused({"--marker", "tip", "--plot", "a.png"}, "must end in .svg");
  folder.expect_refused({"--marker", "tip", "--solver", "local-global"}, "target-shape");
  folder.expect_refused({"--marker", "tip", "--descents", "9"}, "--method gradient");
  folder.write("out", "a file");
  folder.expect_refused({"--marker", "tip"}, "its folder cannot be made");
}

TEST(Follow, WarnsOfAPathInMetres) {
  const FollowFolder folder;
  folder.write("path.csv", "tip_x_mm,tip_y_mm,tip_z_mm\n0.0205,0.006,0.0062\n");
  const ProgramResult result = folder.follow();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("warning: "), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("in metres"), std::string::npos) << result.errors;
}

TEST(Follow, ResumesWhereItEnded) {
  const FollowFolder folder;
  ASSERT_EQ(folder.follow().exit_code, 0);
  const Rows whole = read_rows(folder.out + "/commands.csv");
  const std::string report = folder.out + "/report.json";
  json cut = json::parse(read_text(report));
  cut["steps"].erase(cut["steps"].begin() + 2, cut["steps"].end());
  std::ofstream(report) << cut.dump();
  const ProgramResult result = folder.follow({"--resume"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("2 of 5 waypoints were done before: going on"), std::string::npos) << result.output;
  const Rows again = read_rows(folder.out + "/commands.csv");
  ASSERT_EQ(again.size(), whole.size());
  for (std::size_t i = 0; i < 5; ++i)
    for (const char* column : {"t_s", "air", "tendon"})
      EXPECT_NEAR(cell(again, i, column), cell(whole, i, column), 1e-3) << i;
  EXPECT_EQ(json::parse(read_text(report))["steps"].size(), 5u);
  EXPECT_NE(folder.follow({"--resume"}).output.find("nothing is left"), std::string::npos);

  const auto refuse = [&](const std::vector<std::string>& options, const std::string& message) {
    const ProgramResult refused = folder.follow(options);
    EXPECT_EQ(refused.exit_code, 2) << message;
    EXPECT_NE(refused.errors.find(message), std::string::npos) << refused.errors;
  };
  refuse({"--resume", "--tolerance", "0.01"}, "other options");
  const std::string before = read_text(folder.path);
  folder.write("path.csv", replaced(before, "0.5,", "0.25,"));
  refuse({"--resume"}, "waypoint 0 is another one");
  folder.write("path.csv", before.substr(0, before.rfind('\n', before.size() - 2) + 1));
  refuse({"--resume"}, "the path ends before");
}

TEST(Follow, InterruptedItKeepsWhatIsDone) {
  const FollowFolder folder;
  std::string csv = "tip_x_mm,tip_z_mm\n";
  for (int i = 0; i < 400; ++i)
    for (const auto& target : folder.targets) csv += std::to_string(target[0]) + "," + std::to_string(target[1]) + "\n";
  folder.write("path.csv", csv);
  StartedProgram program(folder, {"follow", folder.scene, folder.path, "-o", folder.out, "--threads", "1"});
  ASSERT_TRUE(program.wait_until([&] { return fs::exists(folder.out + "/path_0002.vtu"); }));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("softkin: interrupted after "), std::string::npos) << result.errors;
  const json report = json::parse(read_text(folder.out + "/report.json"));
  EXPECT_EQ(read_rows(folder.out + "/commands.csv").size(), report["steps"].size() + 1);
  EXPECT_EQ(read_rows(folder.out + "/errors.csv").size(), report["steps"].size() + 1);
  EXPECT_TRUE(fs::exists(folder.out + "/path.svg"));
}

}  // namespace
