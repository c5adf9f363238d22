#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <softkin/io/mesh/vtk.hpp>
#include <thread>

#include "fk_samples.hpp"
#include "start_program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;
using nlohmann::json;

constexpr int steps = 60;

std::string path_text(int rows = steps, double changed_first = 1) {
  std::string text = "t_s,air\n";
  for (int i = 0; i < rows; ++i) {
    const double ratio = i == 0 ? changed_first : 1 + 0.013 * i;
    text += std::to_string(0.5 * i) + "," + std::to_string(ratio) + "\n";
  }
  return text;
}

/// Returns the number of steps in the journal that a run keeps next to its report until it ends; 0 without one.
std::size_t journaled(const std::string& report) {
  const std::string text = read_text(report + ".run");
  const std::size_t lines = std::count(text.begin(), text.end(), '\n');
  return lines > 0 ? lines - 1 : 0;
}

/// A longer block, so that a step takes some milliseconds, and a path of many steps.
struct PathFolder : TemporaryFolder {
  std::string scene, path, report, series;

  PathFolder() {
    write("block.msh", Block(9).mesh.text());
    scene = write("block.yaml", block_scene());
    path = write("path.csv", path_text());
    report = *this / "out/report.json";
    series = *this / "out/shape.pvd";
  }
  [[nodiscard]] std::vector<std::string> arguments(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"fk", scene, "--path", path, "--report", report, "-o", series, "--threads", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] ProgramResult run(const std::vector<std::string>& more = {}) const {
    return run_program(arguments(more));
  }
  [[nodiscard]] ProgramResult resume() const { return run({"--resume"}); }
  [[nodiscard]] std::string shape(int step) const {
    char name[32];
    std::snprintf(name, sizeof name, "out/shape_%04d.vtu", step);
    return *this / name;
  }
  /// Steps that are on disk.
  [[nodiscard]] std::size_t reported() const {
    if (fs::exists(report + ".run")) return journaled(report);
    return fs::exists(report) ? json::parse(read_text(report))["steps"].size() : 0;
  }
  [[nodiscard]] json last_run() const { return json::parse(read_text(report)); }
};

/// Returns names and content of the shapes, the collection and any unexpected files; leaves out reports, which contain
/// times.
std::map<std::string, std::string> shapes_of(const PathFolder& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder / "out"))
    if (entry.path().extension() != ".json") files[entry.path().filename().string()] = read_text(entry.path().string());
  return files;
}

std::map<std::string, std::string> uninterrupted_shapes() {
  const PathFolder folder;
  const ProgramResult result = folder.run();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return shapes_of(folder);
}

/// The steps without the times that they took.
json steps_of(const PathFolder& folder) {
  json all = folder.last_run()["steps"];
  for (json& step : all) step.erase("seconds");
  return all;
}

void expect_refused(const PathFolder& folder, const std::vector<std::string>& words,
                    const std::vector<std::string>& more = {"--resume"}) {
  const auto before = shapes_of(folder);
  const ProgramResult result = folder.run(more);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.errors.rfind("softkin: ", 0), 0u) << result.errors;
  for (const std::string& word : words) EXPECT_NE(result.errors.find(word), std::string::npos) << result.errors;
  EXPECT_EQ(shapes_of(folder), before);
}

/// Interrupts a run after a number of reported steps.
ProgramResult interrupted_run(const PathFolder& folder, std::size_t after, int signal_number = SIGINT) {
  StartedProgram program(folder, folder.arguments());
  EXPECT_TRUE(program.wait_until([&] { return folder.reported() >= after; }));
  program.send(signal_number);
  return program.wait();
}

TEST(FkResume, InterruptKeepsWhatIsFinished) {
  for (const int signal_number : {SIGINT, SIGTERM}) {
    const PathFolder folder;
    const ProgramResult result = interrupted_run(folder, 3, signal_number);
    EXPECT_EQ(result.exit_code, 1);
    const std::size_t done = folder.reported();
    ASSERT_GE(done, 3u);
    ASSERT_LT(done, std::size_t{steps});
    const std::string described = "softkin: interrupted after " + std::to_string(done) +
                                  " of 60 steps; they are in the files that were requested, the same command with "
                                  "--resume continues";
    const auto files = shapes_of(folder);
    // in the middle of a step there is a last good shape, too
    const std::size_t stopped = files.count("shape_stopped.vtu");
    EXPECT_EQ(result.errors.substr(0, described.size()), described);
    EXPECT_EQ(result.errors.find("shape_stopped.vtu, --start continues from it\n") != std::string::npos, stopped == 1)
        << result.errors;
    EXPECT_EQ(files.size(), done + 1 + stopped) << "the shapes and the collection, nothing half";
    for (std::size_t i = 0; i < done; ++i)
      EXPECT_EQ(softkin::read_vtu_points(folder.shape(static_cast<int>(i))).rows(), 160);
    const std::string collection = files.at("shape.pvd"),
                      last = fs::path(folder.shape(static_cast<int>(done) - 1)).filename();
    EXPECT_NE(collection.find(last), std::string::npos) << collection;
    EXPECT_NE(collection.find("timestep=\"0.5\""), std::string::npos) << collection;
  }
}

TEST(FkResume, EndsAsIfNeverInterrupted) {
  const PathFolder folder, whole;
  EXPECT_EQ(interrupted_run(folder, 5).exit_code, 1);
  const std::size_t done = folder.reported();
  const ProgramResult result = folder.resume();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_NE(result.output.find(std::to_string(done) + " of 60 steps were done before: going on"), std::string::npos)
      << result.output;
  EXPECT_EQ(whole.run().exit_code, 0);
  EXPECT_EQ(shapes_of(folder), shapes_of(whole));
  EXPECT_EQ(steps_of(folder), steps_of(whole));
  EXPECT_NE(read_text(folder.shape(steps - 1)).find("type=\"Float64\" Name=\"Points\""), std::string::npos);
}

/// What a viscous material remembers comes from the shapes on disk.
TEST(FkResume, AViscousMaterialRemembersWhatWasBefore) {
  const std::string scene =
      "softkin: 1\n"
      "mesh: {file: block.msh}\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, viscosity: [{modulus: 0.8, time: 1}, {modulus: 1, time: "
      "20}]}]\n"
      "fixed: [{region: base}]\n"
      "actuators: [{name: air, kind: pneumatic, region: chamber, range: [1.0, 2.0]}]\n";
  const PathFolder folder, whole;
  folder.write("block.yaml", scene);
  whole.write("block.yaml", scene);
  EXPECT_EQ(interrupted_run(folder, 40).exit_code, 1);
  ASSERT_LT(folder.reported(), std::size_t{steps});
  const ProgramResult result = folder.resume();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(whole.run().exit_code, 0);
  EXPECT_EQ(shapes_of(folder), shapes_of(whole));
  const json done = steps_of(folder);
  EXPECT_EQ(done, steps_of(whole));
  EXPECT_EQ(done[0]["viscous_loss_mJ"], 0.0) << "at once";
  for (std::size_t i = 1; i < done.size(); ++i) EXPECT_GT(done[i]["viscous_loss_mJ"], 0.0) << i;
}

TEST(FkResume, KilledAtAnyMoment) {
  const auto expected = uninterrupted_shapes();
  const PathFolder folder;
  std::mt19937 random(20);
  std::set<std::size_t> stops;
  for (int kill = 0; kill < 20; ++kill) {
    if (folder.reported() == steps) fs::remove_all(folder / "out");
    {
      StartedProgram program(folder, folder.arguments({"--resume"}));
      const std::size_t until = std::min<std::size_t>(steps, folder.reported() + random() % 12);
      (void)program.wait_until([&] { return folder.reported() >= until; });
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 3000));
      program.send(SIGKILL);
      (void)program.wait();
    }
    const std::size_t done = folder.reported();
    stops.insert(done);
    for (std::size_t i = 0; i < done; ++i) ASSERT_TRUE(fs::exists(folder.shape(static_cast<int>(i)))) << kill;
  }
  EXPECT_GT(stops.size(), 3u);
  const ProgramResult result = folder.resume();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(shapes_of(folder), expected) << "nothing half written stays";
  EXPECT_EQ(folder.reported(), std::size_t{steps});
}

TEST(FkResume, RemovesWhatAKilledRunLeaves) {
  const PathFolder folder;
  folder.write("path.csv", path_text(2));
  EXPECT_EQ(folder.run().exit_code, 0);
  const auto expected = shapes_of(folder);
  for (const std::string name : {".softkin.17", ".softkin.17.17.part", "shape_0001.vtu.17.part", "shape.pvd.17.part"})
    folder.write("out/" + name, "");
  EXPECT_EQ(folder.resume().exit_code, 0);
  EXPECT_EQ(shapes_of(folder), expected);
  folder.write("out/.softkin.notes", "not ours");
  EXPECT_EQ(folder.resume().exit_code, 0);
  EXPECT_EQ(shapes_of(folder).size(), expected.size() + 1);
}

TEST(FkResume, NothingLeftIsSaid) {
  const PathFolder folder;
  EXPECT_EQ(folder.run().exit_code, 0);
  const auto shapes = shapes_of(folder);
  const std::string report = read_text(folder.report);
  const ProgramResult result = folder.resume();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("60 of 60 steps were done before: nothing is left"), std::string::npos) << result.output;
  EXPECT_EQ(shapes_of(folder), shapes);
  EXPECT_EQ(read_text(folder.report), report);
  EXPECT_EQ(folder.run({"--resume", "--json"}).output, report);
}

TEST(FkResume, WithoutAReportItStartsFromTheBeginning) {
  const PathFolder folder;
  folder.write("path.csv", path_text(2));
  const ProgramResult result = folder.resume();
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("nothing to resume: starting with step 0"), std::string::npos) << result.output;
  EXPECT_EQ(folder.reported(), 2u);
}

TEST(FkResume, GoesByContentAndNotByName) {
  const PathFolder folder;
  folder.write("path.csv", path_text(4));
  EXPECT_EQ(folder.run().exit_code, 0);
  folder.write("longer.csv", path_text(6));
  fs::create_directory(folder / "other");
  fs::rename(folder / "block.msh", folder / "renamed.msh");
  std::string scene = block_scene("# a comment\n");
  scene.replace(scene.find("block.msh"), 9, "../renamed.msh");
  folder.write("other/scene.yaml", scene);
  const ProgramResult result =
      run_program({"fk", folder / "other/../other/scene.yaml", "--path", folder / "longer.csv", "--report",
                   folder.report, "-o", folder.series, "--threads", "1", "--resume"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("4 of 6 steps were done before: going on"), std::string::npos) << result.output;
}

TEST(FkResume, RefusesAnotherTask) {
  const PathFolder folder;
  folder.write("path.csv", path_text(3));
  EXPECT_EQ(folder.run().exit_code, 0);

  folder.write("path.csv", path_text(3, 1.001));
  expect_refused(folder,
                 {"report.json: cannot go on", "step 0 was solved for air = 1, but ", "path.csv:2 asks for 1.001"});
  folder.write("path.csv", path_text(2));
  expect_refused(folder, {"it has step 2, but ", "path has changed"});
  folder.write("path.csv", "t_s,air\n0,1\n0.6,1.013\n1,1.026\n");
  expect_refused(folder, {"step 1 has another time than ", "path.csv:3"});
  folder.write("path.csv", path_text(3));
  expect_refused(folder, {"other solver options", "max_iterations"}, {"--resume", "--max-iterations", "7"});

  std::string scene = block_scene();
  scene.replace(scene.find("shape_ratio: 1.0"), 16, "shape_ratio: 0.9");
  folder.write("block.yaml", scene);
  expect_refused(folder, {"another robot, or the scene or its mesh has changed"});
  folder.write("block.yaml", block_scene());
  Block moved(9);
  moved.mesh.vertices[7][1] += 1e-9;
  folder.write("block.msh", moved.mesh.text());
  expect_refused(folder, {"another robot, or the scene or its mesh has changed"});
}

TEST(FkResume, RefusesAnotherStart) {
  const PathFolder folder;
  folder.write("path.csv", "air\n1\n1.01\n1.02\n");  // without times, which begin at rest
  EXPECT_EQ(folder.run().exit_code, 0);
  const std::string text = shapes_of(folder).at("shape_0002.vtu");
  const std::string start = folder.write("start.vtu", text), moved = folder.write("moved.vtu", text);
  const std::string why = "it began at another shape";
  expect_refused(folder, {why}, {"--resume", "--start", start});
  EXPECT_EQ(folder.run({"--start", start}).exit_code, 0);
  EXPECT_EQ(folder.last_run()["start"]["file"], start);
  expect_refused(folder, {why});
  EXPECT_EQ(folder.run({"--resume", "--start", moved}).exit_code, 0) << "the same shape";
}

TEST(FkResume, RefusesAReportThatItDidNotWrite) {
  const PathFolder folder;
  folder.write("path.csv", path_text(3));
  EXPECT_EQ(folder.run().exit_code, 0);
  const json good = folder.last_run();
  const auto refused = [&](const std::string& text, const std::string& why) {
    folder.write("out/report.json", text);
    expect_refused(folder, {"report.json: cannot go on from this report: " + why});
  };
  for (const std::string text : {"", "{", "[]", "3", "null", "{}", "{\"softkin\": 1}"})
    refused(text, "it is not a report");
  for (const std::string key : {"robot_fingerprint", "solver", "steps"}) {
    json bad = good;
    bad.erase(key);
    refused(bad.dump(), "it is not a report");
    bad[key] = key == "steps" ? json(17) : json();
    refused(bad.dump(), "");
  }
  for (const std::string key : {"actuation", "status", "seconds", "shape_fingerprint"}) {
    json bad = good;
    bad["steps"][1].erase(key);
    refused(bad.dump(), "it is not a report");
    bad["steps"][1][key] = json::array({json()});
    refused(bad.dump(), "");
  }
  json newer = good;
  newer["softkin"] = "99.0";
  refused(newer.dump(), "softkin 99.0 wrote it");
  json more = good;
  more["steps"][1]["actuation"]["oil"] = 1.0;
  refused(more.dump(), "step 1 has other actuators");
}

TEST(FkResume, SolvesAgainWhatIsMissingOrDamaged) {
  const PathFolder folder;
  folder.write("path.csv", path_text(4));
  EXPECT_EQ(folder.run().exit_code, 0);
  const auto expected = shapes_of(folder);
  const auto expect_solved_from = [&](const std::string& step) {
    const ProgramResult result = folder.resume();
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("is missing or not the shape of the report\n" + step), std::string::npos)
        << result.output;
    EXPECT_EQ(shapes_of(folder), expected);
  };
  fs::remove(folder.shape(2));
  expect_solved_from("2 of 4 steps were done before: going on");
  fs::resize_file(folder.shape(3), 1000);
  expect_solved_from("3 of 4 steps were done before: going on");
  fs::copy_file(folder.shape(2), folder.shape(0), fs::copy_options::overwrite_existing);
  expect_solved_from("nothing to resume: starting with step 0");
}

TEST(FkResume, NeedsAllFilesOfTheRun) {
  const PathFolder folder;
  for (const auto& files : {std::vector<std::string>{"--path", folder.path, "-o", folder.series},
                            {"--path", folder.path, "--report", folder.report},
                            {"-o", folder.series, "--report", folder.report},
                            {"--path", folder.path, "--report", folder.report, "-o", folder / "out/a.vtu"}}) {
    std::vector<std::string> arguments{"fk", folder.scene, "--resume"};
    arguments.insert(arguments.end(), files.begin(), files.end());
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.errors.rfind("softkin: --resume needs ", 0), 0u) << result.errors;
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(FkInterrupt, OfASingleSolveLeavesItsLastShape) {
  const TemporaryFolder folder;
  folder.write("block.msh", Block(40).mesh.text());
  const std::string scene = folder.write("block.yaml", block_scene());
  const std::string shape = folder / "new/shape.vtu", report = folder / "new/report.json";
  StartedProgram program(
      folder, {"fk", scene, "--set", "air=1.9", "--solver-tolerance", "1e-300", "--max-iterations", "1000000000", "-o",
               shape, "--report", report, "--threads", "1", "--solver", "local-global"});
  ASSERT_TRUE(program.wait_until([&] { return read_text(folder / "stdout.txt").find("status") != std::string::npos; }));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors,
            "softkin: interrupted; the last good shape is in " + shape + ", --start continues from it\n");
  const json described = json::parse(read_text(report));
  EXPECT_TRUE(described["steps"].empty());
  EXPECT_EQ(described["stopped"]["status"], "interrupted");
  const ProgramResult on = run_program({"fk", scene, "--set", "air=1.9", "--start", shape, "-o", folder / "on.vtu"});
  EXPECT_EQ(on.exit_code, 0) << on.errors;
}

/// From the shape of another command, as from its own path.
TEST(FkStart, GoesOnFromAShape) {
  const BlockFolder folder(physical_scene());
  const std::string half = folder / "half.vtu", path = folder.write("path.csv", "air\n1.1\n1.2\n");
  ASSERT_EQ(run_fk(folder.scene, {"--set", "air=1.1", "-o", half}).exit_code, 0);
  const auto reported = [&](const std::vector<std::string>& options, const std::string& name) {
    std::vector<std::string> all = options;
    all.insert(all.end(), {"--report", folder / name});
    EXPECT_EQ(run_fk(folder.scene, all).exit_code, 0);
    return json::parse(read_text(folder / name))["steps"].back();
  };
  const json on = reported({"--set", "air=1.2", "--start", half}, "on.json");
  const json whole = reported({"--path", path}, "whole.json");
  EXPECT_EQ(on["iterations"], whole["iterations"]);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(on["markers"]["corner"][axis], whole["markers"]["corner"][axis], 1e-9);
}

TEST(FkStart, RefusesWhatIsNoShapeOfTheRobot) {
  const BlockFolder folder(physical_scene());
  const std::string shape = folder / "a.vtu";
  ASSERT_EQ(run_fk(folder.scene, {"--set", "air=1.1", "-o", shape}).exit_code, 0);
  const auto refused = [&](const std::vector<std::string>& options, const std::string& why) {
    const ProgramResult result = run_fk(folder.scene, options);
    EXPECT_EQ(result.exit_code, 2) << why;
    EXPECT_NE(result.errors.find(why), std::string::npos) << result.errors;
  };
  refused({"--start", folder / "none.vtu"}, "none.vtu");
  refused({"--start", folder.scene}, "must end in .vtu");
  refused({"--start", shape, "-o", shape}, "a.vtu");
  refused({"--start", shape, "--path", folder.write("times.csv", "t_s,air\n0,1\n1,1.1\n")},
          "--start: a path with times");
  folder.write("block.yaml", replaced(physical_scene(), "name: air", "name: gas"));
  refused({"--start", shape}, "it has no actuator 'gas'");
  folder.write("block.yaml", replaced(physical_scene(), "block.msh", "block.msh, order: 2"));
  refused({"--start", shape}, "vertices, the robot");
}

TEST(FkBudget, StopsInTimeAndSaysHowFarItCame) {
  const TemporaryFolder folder;
  folder.write("block.msh", Block(40).mesh.text());
  const std::string scene = folder.write("block.yaml", block_scene());
  const auto begin = std::chrono::steady_clock::now();
  const ProgramResult result =
      run_program({"fk", scene, "--set", "air=1.9", "--solver-tolerance", "1e-300", "--max-iterations", "1000000000",
                   "--solver", "local-global", "--budget", "0.3", "--report", folder / "r.json"});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(15));  // of a busy machine
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors, "softkin: the budget of 0.3 s was spent\n");
  const json described = json::parse(read_text(folder / "r.json"));
  EXPECT_EQ(described["stopped"]["status"], "not converged");
  EXPECT_EQ(described["stopped"]["remark"], "the budget of 0.3 s was spent");
  EXPECT_EQ(run_program({"fk", scene, "--budget", "0"}).exit_code, 2);
}

TEST(FkTrace, IsATableOfSteps) {
  const BlockFolder folder(physical_scene());
  const std::string file = folder / "trace.csv", path = folder.write("path.csv", "air\n1.1\n1.2\n");
  const ProgramResult result = run_fk(folder.scene, {"--path", path, "--trace", file, "--report", folder / "r.json"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::string quiet = folder / "quiet.csv";
  EXPECT_EQ(run_fk(folder.scene, {"--path", path, "--trace", quiet, "--json"}).exit_code, 0);
  EXPECT_EQ(read_text(quiet), read_text(file));
  std::istringstream lines(read_text(file));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "shape,along,from,to,length,predicted_mm,corrected_mm,iterations,factorisations,in_double,projections,"
            "shifts,taken,why");
  std::size_t rows = 0, taken = 0;
  for (; std::getline(lines, line); ++rows) EXPECT_TRUE(line.rfind("0,", 0) == 0 || line.rfind("1,", 0) == 0) << line;
  const json described = json::parse(read_text(folder / "r.json"));
  for (const json& step : described["steps"]) taken += step["continuation_steps"].get<std::size_t>();
  EXPECT_EQ(rows, taken);
}

TEST(FkInterrupt, OfAPathWritesTheLastShape) {
  const PathFolder folder;
  const std::string shape = folder / "last.vtu", report = folder / "report.json";
  StartedProgram program(
      folder, {"fk", folder.scene, "--path", folder.path, "-o", shape, "--json", "--report", report, "--threads", "1"});
  ASSERT_TRUE(program.wait_until([&] { return journaled(report) > 0; }));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.errors.rfind("softkin: interrupted after ", 0), 0u) << result.errors;
  EXPECT_EQ(result.output, read_text(report));
  const json described = json::parse(result.output), last = described.value("stopped", described["steps"].back());
  const softkin::Points points = softkin::read_vtu_points(shape);
  const int corner = 5 + 10 * (3 + 4 * 3);  // (20, 12, 12)
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(points(corner, axis), last["markers"]["corner"][axis], 1e-9);
}

TEST(FkPhysical, ResumeRefusesAnotherRobot) {
  const BlockFolder folder(physical_scene());
  folder.write("path.csv", "air\n1\n1.1\n");
  const std::vector<std::string> options{"--path", folder / "path.csv", "--report", folder / "out/a.json",
                                         "-o",     folder / "out/a.pvd"};
  EXPECT_EQ(run_fk(folder.scene, options).exit_code, 0);
  const auto refused = [&](const std::string& scene, const std::vector<std::string>& more, const std::string& why) {
    folder.write("block.yaml", scene);
    std::vector<std::string> again = options;
    again.emplace_back("--resume");
    again.insert(again.end(), more.begin(), more.end());
    const ProgramResult result = run_fk(folder.scene, again);
    EXPECT_EQ(result.exit_code, 2) << why;
    EXPECT_NE(result.errors.find(why), std::string::npos) << result.errors;
  };
  const std::string scene = physical_scene(), other = "it is of another robot";
  refused(replaced(scene, "youngs_modulus: 1,", "youngs_modulus: 1.1,"), {}, other);
  refused(replaced(scene, "poisson_ratio: 0.3", "poisson_ratio: 0.31"), {}, other);
  refused(replaced(scene, "poisson_ratio: 0.3", "poisson_ratio: 0.3, law: corotational"), {}, other);
  refused(replaced(scene, "poisson_ratio: 0.3", "poisson_ratio: 0.3, density: 1000"), {}, other);
  refused(replaced(scene, "block.msh", "block.msh, order: 2"), {}, other);
  refused(replaced(scene, "length, range: [0.5, 1.2]", "tension, range: [0, 1]"), {}, other);
  refused(replaced(scene, "force: [0, 0, 0]", "force: [0, 0, 1e-6]"), {}, other);
  refused(scene, {"--force", "payload=0,0,1e-6"}, other);
  refused(scene, {"--max-iterations", "40"}, "other solver options");
  folder.write("block.yaml", scene);
  std::vector<std::string> again = options;
  again.emplace_back("--resume");
  EXPECT_EQ(run_fk(folder.scene, again).exit_code, 0);

  const std::string pulled = replaced(scene, "length, range: [0.5, 1.2]", "tension, range: [0, 1]");
  folder.write("block.yaml", pulled);
  EXPECT_EQ(run_fk(folder.scene, options).exit_code, 0);
  refused(pulled, {"--beyond", "0.9"}, "other solver options");
}

}  // namespace
