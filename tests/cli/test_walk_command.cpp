#include <cmath>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "fk_samples.hpp"
#include "page_samples.hpp"
#include "start_program.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;
namespace fs = std::filesystem;

const std::string crawler = SOFTKIN_SOURCE_DIR "/examples/dea_crawler/";

/// The block of rubber as a crawler: its ends are its feet, the cells at them are rigid, and its tendon pulls it short.
std::string walking_scene(const std::string& feet =
                              "feet: [{marker: heel, forward: 0.02, backward: 9}, {marker: toe, forward: 0.02, "
                              "backward: 9}]\n") {
  return "softkin: 1\n"
         "mesh: {file: block.msh}\n"
         "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, shape_ratio: 1}]\n"
         "fixed: [{region: base}, {region: tip, axes: yz}]\n"
         "actuators: [{name: tendon, kind: cable, points: [[0, 6, 6], [20, 6, 6]], control: tension, range: [0, 5]}]\n"
         "markers: [{name: heel, region: base}, {name: toe, region: tip}]\n" +
         feet;
}

struct WalkFolder : BlockFolder {
  std::string gait, out;

  explicit WalkFolder(const std::string& text = walking_scene(),
                      const std::string& rows = "t_s,tendon_N\n0,0\n0.5,1\n1,2\n1.5,1\n2,0\n")
      : BlockFolder(text), gait(write("gait.csv", rows)), out(*this / "out") {}

  [[nodiscard]] ProgramResult walk(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments{"walk", scene, gait, "-o", out, "--threads", "1"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  }

  void expect_refused(const std::string& message, const std::vector<std::string>& options = {}) const {
    const std::size_t before = files();
    const ProgramResult result = walk(options);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_EQ(result.output, "") << message;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
    EXPECT_EQ(files(), before) << message;
  }
};

TEST(WalkCommand, WritesItsStepsIntoAPage) {
  SKIP_WITHOUT_PAGE();
  const WalkFolder folder;
  const std::string page = folder / "walk.html";
  const ProgramResult result = folder.walk({"--cycles", "1", "--html", page});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find(reported_of_page(page)), std::string::npos) << result.output;
  const json shown = shown_by(page), report = json::parse(read_text(folder.out + "/report.json"));
  ASSERT_EQ(shown.at("steps").size(), 5u);
  for (std::size_t s = 0; s < 5; ++s) {
    EXPECT_EQ(shown["steps"][s]["markers"][1], report["steps"][s]["markers"]["toe"]);
    EXPECT_EQ(shown["steps"][s]["time_s"], report["steps"][s]["time_s"]);
  }
}

TEST(WalkCommand, WritesItsFiles) {
  const WalkFolder folder;
  const ProgramResult result = folder.walk({"--cycles", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_NE(result.output.find("stride: "), std::string::npos) << result.output;

  const json report = json::parse(read_text(folder.out + "/report.json"));
  ASSERT_EQ(report["steps"].size(), 9u);  // the first row, and four of each cycle
  EXPECT_EQ(report["walk"]["cycles"], 2);
  ASSERT_EQ(report["stride_mm"].size(), 2u);
  const json& last = report["steps"][8];
  EXPECT_EQ(last["time_s"], 4.0);
  EXPECT_EQ(last["walk"]["cycle"], 2);
  EXPECT_NEAR(last["walk"]["travel_mm"].get<double>(),
              report["stride_mm"][0].get<double>() + report["stride_mm"][1].get<double>(), 1e-12);
  EXPECT_GT(report["stride_mm"][1].get<double>(), 0.1);
  EXPECT_NEAR(last["markers"]["heel"][0].get<double>(), last["walk"]["feet_mm"]["heel"].get<double>(), 1e-9);

  const std::string csv = read_text(folder.out + "/walk.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "cycle,t_s,tendon_N,heel_mm,toe_mm,travel_mm,friction_N,sliding");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 10);
  pugi::xml_document collection, plot;
  ASSERT_TRUE(collection.load_file((folder.out + "/walk.pvd").c_str()));
  for (const auto& set : collection.child("VTKFile").child("Collection").children("DataSet"))
    EXPECT_TRUE(fs::exists(folder.out + "/" + set.attribute("file").value()));
  EXPECT_TRUE(plot.load_file((folder.out + "/walk.svg").c_str()));
}

TEST(WalkCommand, JsonIsTheReport) {
  const WalkFolder folder;
  const ProgramResult result = folder.walk({"--cycles", "1", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output), json::parse(read_text(folder.out + "/report.json")));
}

/// A foot slides under the friction that it has: the distances of the feet are those of fk under that force.
TEST(WalkCommand, CrawlerHasTheShapesOfForwardKinematics) {
  TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_EQ(
      run_program({"walk", crawler + "dea_crawler.yaml", crawler + "gait.csv", "--cycles", "2", "-o", out}).exit_code,
      0);
  const json walk = json::parse(read_text(out + "/report.json"));

  std::string scene = read_text(crawler + "dea_crawler.yaml");
  scene = replaced(scene, "dea_crawler.msh", crawler + "dea_crawler.msh") +
          "forces: [{name: floor, region: foot2, force: [0, 0, 0]}]\n";
  const std::string with_force = folder.write("crawler.yaml", scene), report = folder / "report.json";
  const auto distance = [&](const std::string& skin, const std::string& force) {
    const ProgramResult fk =
        run_program({"fk", with_force, "--set", "skin=" + skin, "--force", "floor=" + force, "--report", report});
    EXPECT_EQ(fk.exit_code, 0) << fk.errors;
    const json markers = json::parse(read_text(report))["steps"][0]["markers"];
    return markers["foot2"][0].get<double>() - markers["foot1"][0].get<double>();
  };
  const double stride = distance("1", "-0.01,0,0") - distance("0.7", "0.01,0,0");
  EXPECT_GT(stride, 2);
  EXPECT_NEAR(walk["stride_mm"][1].get<double>(), stride, 1e-4);
  for (const json& step : walk["steps"]) {
    const double friction = step["walk"]["friction_N"];
    EXPECT_LE(std::abs(friction), 0.01);
    EXPECT_TRUE(step["walk"]["sliding"] == "none" || std::abs(friction) == 0.01);
  }
}

TEST(WalkCommand, Voltage) {
  TemporaryFolder folder;
  const ProgramResult result = run_program({"walk", crawler + "measured/crawler.yaml", crawler + "measured/gait.csv",
                                            "--cycles", "1", "--formulation", "target-shape", "-o", folder / "out"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(read_text(folder / "out/report.json"));
  EXPECT_GT(report["stride_mm"][0].get<double>(), 1);
  EXPECT_FALSE(report["steps"][1]["walk"].contains("friction_N"));  // target shapes know no forces
}

/// Killed or interrupted, then resumed, a walk ends where an undisturbed one ends.
TEST(WalkCommand, ResumesWhereItWasStopped) {
  const WalkFolder folder;
  ASSERT_EQ(folder.walk({"--cycles", "40"}).exit_code, 0);
  const json whole = json::parse(read_text(folder.out + "/report.json"));
  const std::string out = folder / "stopped";
  const std::vector<std::string> command{"walk",      folder.scene, folder.gait, "-o", out,
                                         "--threads", "1",          "--cycles",  "40"};
  for (const int signal : {SIGINT, SIGKILL}) {
    fs::remove_all(out);
    StartedProgram program(folder, command);
    ASSERT_TRUE(program.wait_until([&] { return fs::exists(out + "/walk_0006.vtu"); }));
    program.send(signal);
    const ProgramResult stopped = program.wait();
    if (signal == SIGINT) {
      EXPECT_EQ(stopped.exit_code, 1);
      EXPECT_NE(stopped.errors.find("softkin: interrupted after "), std::string::npos) << stopped.errors;
      EXPECT_TRUE(fs::exists(out + "/walk.svg"));
    }
    std::vector<std::string> again = command;
    again.emplace_back("--resume");
    const ProgramResult resumed = run_program(again);
    ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
    EXPECT_NE(resumed.output.find("steps were done before: going on"), std::string::npos) << resumed.output;
    const json report = json::parse(read_text(out + "/report.json"));
    ASSERT_EQ(report["steps"].size(), whole["steps"].size());
    for (std::size_t i = 0; i < report["steps"].size(); ++i)
      EXPECT_EQ(report["steps"][i]["walk"], whole["steps"][i]["walk"]);
  }
}

TEST(WalkCommand, ResumeGoesOnWithMoreCycles) {
  const WalkFolder folder;
  EXPECT_NE(folder.walk({"--cycles", "1", "--resume"}).output.find("nothing to resume"), std::string::npos);
  const ProgramResult more = folder.walk({"--cycles", "2", "--resume"});
  ASSERT_EQ(more.exit_code, 0) << more.errors;
  EXPECT_NE(more.output.find("5 of 9 steps were done before"), std::string::npos) << more.output;
  folder.write("gait.csv", "t_s,tendon_N\n0,0\n0.5,1\n1,2.5\n1.5,1\n2,0\n");
  const ProgramResult other = folder.walk({"--cycles", "2", "--resume"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.errors.find("step 2 is another one than in "), std::string::npos) << other.errors;
  folder.write("gait.csv", "t_s,tendon_N\n0,0\n0.5,1\n1,2\n1.5,1\n2,0\n");
  folder.write("block.yaml", walking_scene("feet: [{marker: heel, forward: 0.02, backward: 9}, {marker: toe, forward: "
                                           "0.03, backward: 9}]\n"));
  EXPECT_NE(folder.walk({"--resume"}).errors.find("cannot go on from this report"), std::string::npos);
}

TEST(WalkCommand, Refusals) {
  const std::string good = "t_s,tendon_N\n0,0\n1,2\n2,0\n";
  const std::string feet = "feet: [{marker: heel, forward: 1, backward: 1}, {marker: toe, forward: 1, backward: 1}]\n";
  WalkFolder(walking_scene(""), good).expect_refused("the robot has no feet to walk on: the scene needs key 'feet'");
  WalkFolder(walking_scene("feet: [{marker: heel, forward: 1, backward: 1}]\n"), good).expect_refused("'feet'");
  WalkFolder(replaced(walking_scene(feet), "axes: yz", "axes: xyz"), good)
      .expect_refused("the feet cannot slide: the robot is held along x on both sides");
  const std::string scene = walking_scene(feet);
  WalkFolder(scene, "t_s,tendon_N\n0,0\n1,2\n").expect_refused("gait.csv:3: a gait ends where it begins");
  WalkFolder(scene, "t_s,tendon_N\n0,0\n").expect_refused("a gait needs two rows or more, not 1");
  WalkFolder(scene, "t_s,tendon_N\n0,0\n1,9\n2,0\n").expect_refused("gait.csv:3: ");
  WalkFolder(scene, "t_s,air\n0,0\n1,1\n2,0\n").expect_refused("no actuator 'air'");
  WalkFolder(scene, "t_s,tendon_N\n0,0\n1,two\n2,0\n").expect_refused("gait.csv:3");
  WalkFolder(scene, good).expect_refused("cycles", {"--cycles", "0"});
  WalkFolder(scene, good).expect_refused("local-global", {"--solver", "local-global"});
}

}  // namespace
