#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <softkin/core/text.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <sstream>
#include <thread>

#include "fk_samples.hpp"
#include "page_samples.hpp"
#include "start_program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;
using nlohmann::json;

std::string narrow_scene() {
  return replaced(replaced(physical_scene(), "range: [0.5, 3]", "range: [1, 1.6]"), "range: [0.5, 1.2]",
                  "range: [0.85, 1]");
}

struct ReachFolder : BlockFolder {
  std::string output = *this / "reach.csv";

  explicit ReachFolder(const std::string& text = narrow_scene()) : BlockFolder(text) {}

  [[nodiscard]] std::vector<std::string> arguments(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"workspace", scene, "-o", output};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] ProgramResult run(const std::vector<std::string>& more) const { return run_program(arguments(more)); }
  [[nodiscard]] std::string text() const { return read_text(output); }
};

std::size_t row_count(const std::string& text) {
  const auto lines = lines_of(text);
  const auto rows = std::count_if(lines.begin(), lines.end(),
                                  [](const std::string& line) { return !line.empty() && line[0] != '#'; });
  return std::max<std::ptrdiff_t>(rows - 1, 0);  // the header may not be there yet
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

const std::vector<std::string> small{"--samples", "120", "--sampling", "sobol", "--threads", "1"};

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void expect_refusal(const ReachFolder& folder, const std::vector<std::string>& options, const std::string& message) {
  const std::size_t before = folder.files();
  const std::string content = folder.text();
  const ProgramResult result = folder.run(options);
  EXPECT_EQ(result.exit_code, 2) << message;
  EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
  EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
  EXPECT_EQ(folder.files(), before) << message;
  EXPECT_EQ(folder.text(), content) << message;
}

TEST(WorkspaceCommand, WritesItsReachIntoAPage) {
  SKIP_WITHOUT_PAGE();
  const ReachFolder folder;
  const std::string page = folder / "reach.html";
  const ProgramResult result = folder.run({"--samples", "4", "--threads", "1", "--html", page});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(reported_of_page(page)), std::string::npos) << result.output;
  const json reach = shown_by(page).at("workspace");
  EXPECT_EQ(reach.at("marker"), 0);
  EXPECT_EQ(reach.at("points").at("f32").get<std::string>().size(), 4u * 3 * sizeof(float) * 4 / 3);
}

TEST(WorkspaceCommand, WritesARowPerSampleThatForwardKinematicsConfirms) {
  const ReachFolder folder;
  const ProgramResult result = folder.run({"--samples", "16"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("16 of 16 samples converged"), std::string::npos) << result.output;
  const std::vector<std::string> lines = lines_of(folder.text());
  ASSERT_EQ(lines.size(), 7u + 1 + 16);
  EXPECT_EQ(lines[5], "# sampling: grid of 4 x 4");
  EXPECT_EQ(lines[7],
            "sample,air,tendon,tip_x_mm,tip_y_mm,tip_z_mm,corner_x_mm,corner_y_mm,corner_z_mm,air_pressure_kPa,"
            "tendon_tension_N,status,reached,iterations");
  for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(cells_of(lines[8 + i])[0], std::to_string(i));
  const std::vector<std::string> row = cells_of(lines[8 + 9]);
  const std::string report = folder / "fk.json";
  ASSERT_EQ(run_fk(folder.scene, {"--set", "air=" + row[1], "--set", "tendon=" + row[2], "--report", report}).exit_code,
            0);
  const json step = json::parse(read_text(report))["steps"][0];
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::stod(row[3 + axis]), step["markers"]["tip"][axis].get<double>(), 1e-5);
  EXPECT_NEAR(std::stod(row[9]), step["actuators"]["air"]["pressure_kPa"].get<double>(), 1e-4);
  EXPECT_NEAR(std::stod(row[10]), step["actuators"]["tendon"]["tension_N"].get<double>(), 1e-5);
  EXPECT_EQ(row[11], "converged");
}

TEST(WorkspaceCommand, TakesTheNearestGridAndSaysSo) {
  const ReachFolder folder;
  const ProgramResult result = folder.run({"--samples", "17"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("16 samples, grid of 4 x 4; the full grid nearest to 17"), std::string::npos)
      << result.output;
  EXPECT_EQ(row_count(folder.text()), 16u);
}

TEST(WorkspaceCommand, LoadsHaveTheirUnitsInTheirColumns) {
  const ReachFolder folder(replaced(replaced(loaded_scene(), "[-100, 3000]", "[0, 30]"), "[0, 100]", "[0, 2]"));
  ASSERT_EQ(folder.run({"--samples", "4"}).exit_code, 0);
  EXPECT_TRUE(lines_of(folder.text())[7].starts_with("sample,air_kPa,tendon_N,tip_x_mm,"));
}

TEST(WorkspaceCommand, IsTheSameFileOnAnyNumberOfThreads) {
  const ReachFolder one, two;
  ASSERT_EQ(one.run(small).exit_code, 0);
  std::vector<std::string> options = small;
  options.back() = "2";
  ASSERT_EQ(two.run(options).exit_code, 0);
  EXPECT_EQ(row_count(one.text()), 120u);
  EXPECT_EQ(one.text(), two.text());
}

TEST(WorkspaceCommand, SeedsTellRandomSamplesApart) {
  const ReachFolder folder;
  std::vector<std::string> texts;
  for (const char* seed : {"1", "1", "2"}) {
    ASSERT_EQ(folder.run({"--samples", "8", "--sampling", "random", "--seed", seed}).exit_code, 0);
    texts.push_back(folder.text());
  }
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_NE(texts[0], texts[2]);
}

/// SIGKILL at random instants, and each time another number of threads: nothing is lost and nothing stands twice.
TEST(WorkspaceCommand, KilledAndResumedGivesTheUndisturbedFile) {
  const std::vector<std::string> many{"--samples", "400", "--sampling", "sobol", "--threads", "1"};
  const ReachFolder undisturbed, folder;
  ASSERT_EQ(undisturbed.run(many).exit_code, 0);
  std::mt19937 generator(7);
  std::uniform_int_distribution<std::size_t> more_rows(1, 25);
  std::uniform_int_distribution<int> wait_us(0, 3000);
  int kills = 0;
  for (std::size_t before = 0; kills < 12 && before < 330;) {
    std::vector<std::string> options = joined(many, {"--resume"});
    options[5] = kills % 2 == 0 ? "1" : "2";
    const std::size_t until = before + more_rows(generator);
    StartedProgram program(folder, folder.arguments(options));
    ASSERT_TRUE(program.wait_until([&] { return fs::exists(folder.output) && row_count(folder.text()) >= until; }));
    std::this_thread::sleep_for(std::chrono::microseconds(wait_us(generator)));
    program.send(SIGKILL);
    ASSERT_EQ(program.wait().exit_code, 128 + SIGKILL);
    ++kills;
    EXPECT_GE(row_count(folder.text()), until);
    before = row_count(folder.text());
  }
  EXPECT_GE(kills, 4);
  const ProgramResult last = folder.run(joined(many, {"--resume"}));
  EXPECT_EQ(last.exit_code, 0) << last.errors;
  EXPECT_EQ(row_count(folder.text()), 400u);
  EXPECT_EQ(folder.text(), undisturbed.text());
}

TEST(WorkspaceCommand, TornLastLineIsCutOffAndSolvedAgain) {
  const ReachFolder folder;
  ASSERT_EQ(folder.run(small).exit_code, 0);
  const std::string whole = folder.text();
  for (std::size_t missing : {1u, 30u, 4000u}) {
    missing += whole[whole.size() - missing - 1] == '\n';  // within a row
    folder.write("reach.csv", whole.substr(0, whole.size() - missing));
    const ProgramResult result = folder.run(joined(small, {"--resume"}));
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("the last row was torn"), std::string::npos) << result.output;
    EXPECT_EQ(folder.text(), whole) << missing;
  }
}

TEST(WorkspaceCommand, RowsAreKeptInWhateverOrderTheyStand) {
  const ReachFolder folder;
  ASSERT_EQ(folder.run(small).exit_code, 0);
  const std::string whole = folder.text();
  std::vector<std::string> lines = lines_of(whole);
  std::mt19937 generator(1);
  std::shuffle(lines.begin() + 8, lines.end(), generator);
  lines.resize(70);
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  folder.write("reach.csv", text);
  const ProgramResult result = folder.run(joined(small, {"--resume"}));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("62 of 120 samples were done before: going on"), std::string::npos) << result.output;
  EXPECT_EQ(folder.text(), whole);
}

TEST(WorkspaceCommand, InterruptedItTellsHowToGoOn) {
  const ReachFolder folder;
  std::vector<std::string> options{"--samples", "3000", "--sampling", "sobol", "--threads", "1"};
  {
    StartedProgram program(folder, folder.arguments(options));
    ASSERT_TRUE(program.wait_until([&] { return fs::exists(folder.output) && row_count(folder.text()) > 3; }));
    program.send(SIGINT);
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.errors.find("of 3000 samples; they are in " + folder.output +
                                 ", the same command with --resume continues"),
              std::string::npos)
        << result.errors;
  }
  expect_refusal(folder, options, "is an unfinished workspace");
  options[1] = "2999";
  expect_refusal(folder, joined(options, {"--resume"}), "its samples is '3000', not '2999'");
  options[1] = "3000";
  options[3] = "random";
  expect_refusal(folder, joined(options, {"--resume"}), "its sampling is 'sobol', not 'random, seed 0'");
  folder.write("block.yaml", replaced(narrow_scene(), "youngs_modulus: 1,", "youngs_modulus: 2,"));
  options[3] = "sobol";
  expect_refusal(folder, joined(options, {"--resume"}), "it is of another robot");
  folder.write("block.yaml", replaced(narrow_scene(), "name: tendon", "name: cable"));
  expect_refusal(folder, joined(options, {"--resume"}), "the columns are those of another robot");
  folder.write("block.yaml", replaced(narrow_scene(), "[0.85, 1]", "[0.8, 1]"));
  expect_refusal(folder, joined(options, {"--resume"}), "its ranges is");
}

TEST(WorkspaceCommand, GoesOnOnlyWithTheSameSolverOptions) {
  const ReachFolder folder;
  const std::vector<std::string> few{"--samples", "4", "--resume"};
  ASSERT_EQ(folder.run({"--samples", "4"}).exit_code, 0);
  EXPECT_EQ(lines_of(folder.text())[3], "# solver: newton");
  expect_refusal(folder, joined(few, {"--solver-tolerance", "1e-7"}),
                 "its solver is 'newton', not 'newton, tolerance 1e-07 mm'");
  expect_refusal(folder, joined(few, {"--max-iterations", "70"}), "not 'newton, at most 70 iterations'");
  const std::vector<std::string> other{"--solver-tolerance", "1e-07", "--max-iterations", "70"};
  ASSERT_EQ(folder.run(joined({"--samples", "4"}, other)).exit_code, 0);
  EXPECT_EQ(lines_of(folder.text())[3], "# solver: newton, tolerance 1e-07 mm, at most 70 iterations");
  EXPECT_EQ(folder.run(joined(few, other)).exit_code, 0);
  expect_refusal(folder, few, "its solver is 'newton, tolerance 1e-07 mm, at most 70 iterations', not 'newton'");
  expect_refusal(folder, {"--samples", "4", "--anderson", "3"}, "it needs --solver local-global");

  const ReachFolder target(block_scene());
  const std::vector<std::string> local{"--samples", "3", "--solver", "local-global"};
  ASSERT_EQ(target.run(joined(local, {"--anderson", "3"})).exit_code, 0);
  EXPECT_EQ(lines_of(target.text())[3], "# solver: local-global, anderson 3");
  expect_refusal(target, joined(local, {"--resume"}), "its solver is 'local-global, anderson 3', not 'local-global'");
}

TEST(WorkspaceCommand, TwoAtOnceOnOneFileAreRefused) {
  const ReachFolder folder;
  const std::vector<std::string> options{"--samples", "3000", "--sampling", "sobol", "--threads", "1", "--resume"};
  StartedProgram program(folder, folder.arguments(options));
  ASSERT_TRUE(program.wait_until([&] { return fs::exists(folder.output) && row_count(folder.text()) > 1; }));
  const ProgramResult second = folder.run(options);
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_NE(second.errors.find("another softkin is at work on it"), std::string::npos) << second.errors;
}

TEST(WorkspaceCommand, SamplesWithoutAnEquilibriumAreRowsAndTold) {
  const ReachFolder folder(replaced(loaded_scene(), "[-100, 3000]", "[0, 3000]"));
  const ProgramResult result = folder.run({"--samples", "9", "--cloud", folder / "c.vtu"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("have no equilibrium that could be followed to (status limit)"), std::string::npos)
      << result.errors;
  const std::string text = folder.text();
  EXPECT_EQ(row_count(text), 9u);
  EXPECT_NE(result.errors.find("their rows hold the last good shape\n"), std::string::npos) << result.errors;
  // the last good shape is that of the fraction of the actuation that was reached
  std::size_t limits = 0;
  for (const std::string& line : lines_of(text)) {
    const std::vector<std::string> row = cells_of(line);
    const auto status = std::find(row.begin(), row.end(), "limit");
    if (status == row.end()) continue;
    ++limits;
    const double reached = std::stod(status[1]);
    EXPECT_GT(reached, 0);
    EXPECT_LT(reached, 1);
    const ProgramResult there =
        run_fk(folder.scene, {"--set", "air=" + softkin::exact(reached * std::stod(row[1])), "--set",
                              "tendon=" + softkin::exact(reached * std::stod(row[2])), "--json"});
    ASSERT_EQ(there.exit_code, 0) << there.errors;
    const json tip = json::parse(there.output)["steps"][0]["markers"]["tip"];
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(tip[axis].get<double>(), std::stod(row[3 + axis]), 0.01) << line;
  }
  EXPECT_GT(limits, 0u) << text;
  EXPECT_LT(softkin::read_vtu_points(folder / "c.vtu").rows(), 9);
}

TEST(WorkspaceCommand, CloudHullAndPlotAreOfTheMarker) {
  const ReachFolder folder;
  const ProgramResult result = folder.run({"--samples", "36", "--marker", "corner", "--cloud", folder / "c.vtu",
                                           "--hull", folder / "h.stl", "--plot", folder / "p.svg", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json summary = json::parse(result.output);
  EXPECT_EQ(summary["marker"], "corner");
  EXPECT_EQ(summary["converged"], 36);
  const softkin::Points cloud = softkin::read_vtu_points(folder / "c.vtu");
  ASSERT_EQ(cloud.rows(), 36);
  const std::vector<std::string> lines = lines_of(folder.text());
  for (softkin::Index i = 0; i < 36; ++i)
    for (softkin::Index axis = 0; axis < 3; ++axis)
      EXPECT_EQ(cloud(i, axis), std::stod(cells_of(lines[8 + i])[6 + axis]));
  EXPECT_EQ(summary["reach_mm"]["x"][1].get<double>(), cloud.col(0).maxCoeff());
  EXPECT_NE(read_text(folder / "c.vtu").find("Name=\"tendon_tension_N\""), std::string::npos);
  const softkin::TriangleSurface hull = softkin::read_stl(folder / "h.stl");
  EXPECT_GE(hull.triangles.size(), 4u);
  EXPECT_EQ(summary["hull"]["shape"], "solid");
  EXPECT_GT(summary["hull"]["volume_mm3"].get<double>(), 0);
  EXPECT_NE(read_text(folder / "p.svg").find("Reach of corner: 36 samples"), std::string::npos);

  // again, of the finished file: nothing is solved
  const ProgramResult again = folder.run({"--samples", "36", "--resume", "--hull", folder / "h.vtu"});
  EXPECT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_NE(again.output.find("36 of 36 samples were done before: nothing is left"), std::string::npos) << again.output;
  EXPECT_NE(again.output.find(" mm^3, "), std::string::npos) << again.output;
  EXPECT_TRUE(fs::exists(folder / "h.vtu"));
}

TEST(WorkspaceCommand, OfTargetShapesHasNoLoads) {
  const ReachFolder folder(block_scene());
  for (const char* solver : {"newton", "local-global"}) {
    const ProgramResult result = folder.run({"--samples", "5", "--solver", solver});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(lines_of(folder.text())[7].ends_with(",corner_z_mm,status,reached,iterations"));
  }
}

TEST(WorkspaceCommand, RefusesBadInputBeforeAnythingIsWritten) {
  const ReachFolder folder;
  expect_refusal(folder, {"--samples", "0"}, "--samples: must be an integer from 1 to 100000000, not 0");
  expect_refusal(folder, {"--samples", "many"}, "not many");
  expect_refusal(folder, {}, "--samples is required");
  expect_refusal(folder, {"--samples", "4", "--sampling", "halton"}, "halton");
  expect_refusal(folder, {"--samples", "4", "--seed", "3"}, "--seed is the seed of random samples");
  expect_refusal(folder, {"--samples", "4", "--marker", "tpi"}, "did you mean 'tip'?");
  expect_refusal(folder, {"--samples", "4", "--cloud", folder / "c.csv"}, "must end in .vtu");
  expect_refusal(folder, {"--samples", "4", "--hull", folder / "h.obj"}, "must end in .vtu or .stl");
  expect_refusal(folder, {"--samples", "4", "--plot", folder / "p.png"}, "must end in .svg");
  expect_refusal(folder, {"--samples", "4", "--cloud", folder / "a.vtu", "--hull", folder / "a.vtu"},
                 "is the file of --cloud");
  expect_refusal(folder, {"--samples", "4", "--solver", "local-global"}, "is for the target-shape formulation");
  folder.write("block.yaml", replaced(narrow_scene(),
                                      "markers: [{name: tip, region: tip}, {name: corner, point: [20, 12, 12]}]", ""));
  expect_refusal(folder, {"--samples", "4"}, "the robot has no marker");
}

#ifndef SOFTKIN_MPI  // with it tests/options/test_ranks.cpp
TEST(WorkspaceCommand, WithoutMpiSeveralCopiesAreRefused) {
  const ReachFolder folder;
  ASSERT_EQ(::setenv("OMPI_COMM_WORLD_SIZE", "2", 1), 0);
  expect_refusal(folder, {"--samples", "4"}, "this softkin was built without MPI");
  ::unsetenv("OMPI_COMM_WORLD_SIZE");
}
#endif

}  // namespace
