#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <sstream>

#include "fk_samples.hpp"
#include "start_program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;
using nlohmann::json;

TEST(FkCommand, RefusesSettings) {
  const BlockFolder folder;
  const auto refused = [&](const std::vector<std::string>& settings, const std::string& message) {
    std::vector<std::string> options{"-o", folder / "new/a.vtu", "--json"};
    for (const std::string& setting : settings) options.insert(options.end(), {"--set", setting});
    expect_refused(folder, options, message);
  };
  refused({"ait=1.2"}, "--set 'ait=1.2': no actuator 'ait'; did you mean 'air'?");
  refused({"tendon=1.2"}, "--set 'tendon=1.2': no actuator 'tendon'; known: air");
  refused({"air=2.5"}, "--set 'air=2.5': the ratio is outside its range, 1 to 2 [-]");
  refused({"air=0.9999999"}, "--set 'air=0.9999999': the ratio is outside its range, 1 to 2 [-]");
  refused({"air=1.1", "air=1.1"}, "--set 'air=1.1': actuator 'air' is set twice");
  for (const std::string text : {"1.8kPa", "", "nan", "inf", "1,5", "1 5", "0x1p0", "--5"})
    refused({"air=" + text}, "the ratio to rest must be a finite number without unit, not '" + text + "'");
  refused({"air=1,5"}, "without unit, not '1,5'; write a decimal point: 1.5");
  refused({"air=1.2,tendon=3"}, "not '1.2,tendon=3'; set each actuator on its own: --set air=1.2 --set tendon=3");
  for (const std::string text : {"air", "1.5", ""}) refused({text}, "expected ACTUATOR=VALUE");
  refused({"=1.5"}, "no actuator ''");
}

TEST(FkCommand, RefusesPaths) {
  const BlockFolder folder;
  const std::string path = folder / "path.csv";
  folder.write("path.csv", "");
  const auto refused = [&](const std::string& text, const std::string& message) {
    folder.write("path.csv", text);
    expect_refused(folder, {"--path", path, "-o", folder / "new/a.pvd"}, path + message);
  };
  refused("", ": has no header");
  refused("air\n", ":1: no row follows the header");
  refused("air,tendon\n1,1\n", ": column 'tendon': no actuator 'tendon'; known: air");
  refused("t,air\n1,1\n", ": column 't': no actuator 't'; known: air; a time is column t_s [s]");
  refused("# ratios\nair\n1.5\n\n2.5\n", ":5: column 'air': 2.5 is outside its range, 1 to 2 [-]");
  refused("air\n1\n1.2mm\n", ":3: column 'air' must hold a finite number, not '1.2mm'");
  refused("t_s\n1\n", ": no column names an actuator");
  refused("t_s,air\n0,1\n2,1\n1,1\n", ":4: t_s must increase from row to row, but 1 s follows 2 s");
  refused("t_s,air\n0,1\n0,1\n", ":3: t_s must increase");
  fs::remove(path);
  expect_refused(folder, {"--path", path}, path + ": no such file");
  folder.write("path.csv", "air\n1\n");
  expect_refused(folder, {"--path", path, "--set", "air=1.5"},
                 "'air' is set for the whole path, too; leave out one of them");
}

TEST(FkCommand, RefusesFiles) {
  const BlockFolder folder;
  folder.write("plain", "");
  const std::string plain = folder / "plain", mesh = folder / "block.msh";
  expect_refused(folder, {"-o", folder / "a.stl"}, "a.stl: must end in .vtu (the last shape) or .pvd (every step)");
  expect_refused(folder, {"-o", folder / "new/"}, "new/: must end in .vtu");
  expect_refused(folder, {"--image", folder / "a.jpg"}, "a.jpg: must end in .png");
  expect_refused(folder, {"-o", plain + "/a.vtu", "--report", folder / "new/b.json"},
                 "--output " + plain + "/a.vtu: its folder cannot be made: Not a directory");
  expect_refused(folder, {"-o", folder / "new/deep/a.vtu", "--report", plain + "/a/b.json"},
                 "--report " + plain + "/a/b.json: its folder cannot be made: Not a directory");
  fs::create_directory(folder / "folder.json");
  fs::create_symlink("/dev/null", folder / "device.json");
  expect_refused(folder, {"--report", folder / "folder.json"}, "is a folder, not a file");
  expect_refused(folder, {"--report", folder / "device.json"},
                 "device.json: is no plain file and will not be replaced");
  for (const std::string& input : {folder.scene, mesh, folder / "./block.msh"})
    expect_refused(folder, {"--report", input}, "--report " + input + ": must end in .json");
  const std::string path = folder.write("path.csv", "air\n1\n");
  expect_refused(folder, {"--path", path, "--trace", folder / "./path.csv"},
                 "--trace " + folder / "./path.csv" + ": would replace a file that is read");
  EXPECT_EQ(read_text(mesh), folder.block.mesh.text());
}

TEST(FkCommand, RefusesToReplaceTheMeshByAStep) {
  const BlockFolder folder;
  EXPECT_EQ(run_program({"mesh", "convert", folder / "block.msh", folder / "a_0001.vtu"}).exit_code, 0);
  std::string scene = block_scene();
  scene.replace(scene.find("block.msh"), 9, "a_0001.vtu");
  scene.replace(scene.find("region: base"), 12, "box: [[-1, -1, -1], [0.1, 13, 13]]");
  scene.replace(scene.find("region: tip"), 11, "point: [20, 6, 6]");
  folder.write("block.yaml", scene);
  const std::string path = folder.write("path.csv", "air\n1\n1.1\n");
  EXPECT_EQ(run_fk(folder.scene, {"--set", "air=1.1"}).exit_code, 0);
  expect_refused(folder, {"--path", path, "-o", folder / "a.pvd"}, "its a_0001.vtu would replace a file that is read");
}

TEST(FkCommand, RefusesOptions) {
  const BlockFolder folder;
  const std::string image = folder / "a.png";
  const auto refused = [&](const std::vector<std::string>& options, const std::string& message) {
    expect_refused(folder, options, message);
  };
  refused({"--image", image, "--view", "0", "0", "0"}, "--view 0 0 0: must be a direction");
  refused({"--image", image, "--view", "nan", "0", "1"}, "--view: must be a finite number, not nan");
  refused({"--image", image, "--view", "1", "2"}, "--view: At least 3 required");
  refused({"--view", "1", "2", "3"}, "--view is the view of the picture: it needs --image");
  refused({"--solver-tolerance", "nan"}, "--solver-tolerance: must be a finite number, 0 or more, not nan");
  refused({"--solver-tolerance", "-1"}, "--solver-tolerance: must be a finite number, 0 or more, not -1");
  refused({"--solver-tolerance", "inf"}, "--solver-tolerance: must be a finite number");
  refused({"--max-iterations", "0"}, "--max-iterations: must be an integer from 1 to 1000000000, not 0");
  refused({"--max-iterations", "1e5"}, "--max-iterations: must be an integer");
  refused({"--anderson", "21"}, "--anderson: must be an integer from 0 to 20, not 21");
  refused({"--anderson", "6"}, "--anderson accelerates Algorithm 1: it needs --solver local-global");
  refused({"--as-published"}, "--as-published stops Algorithm 1: it needs --solver local-global");
  const auto published_too = [&](const std::vector<std::string>& more, const std::string& message) {
    std::vector<std::string> options{"--solver", "local-global", "--as-published"};
    options.insert(options.end(), more.begin(), more.end());
    refused(options, message);
  };
  published_too({"--anderson", "2"}, "--as-published is Algorithm 1 without acceleration: leave --anderson out");
  published_too({"--solver-tolerance", "0.1"},
                "--as-published has a tolerance of its own: leave --solver-tolerance out");
  published_too({"--map", "a.skmap"}, "--as-published is for the solver, not for a map: leave --map out");
  refused({"--solver", "gauss"}, "--solver: gauss not in {newton,local-global}");
  refused({"--formulation", "elastic"}, "--formulation: elastic not in {physical,target-shape}");
  refused({"--formulation", "physical"}, "the material of region 'body' needs elastic constants");
  refused({"--resume"}, "--resume needs the --path, --report and --output F.pvd");
  refused({"--frobnicate"}, "there is no option --frobnicate (softkin fk --help shows more)");
  refused({"--reprot=a.json"}, "there is no option --reprot; did you mean --report? (softkin fk --help shows more)");
  refused({"other.yaml"}, "other.yaml");
  for (const std::string threads : {"-1", "1.5", "513", "two"}) {
    const ProgramResult result = run_program({"fk", folder.scene, "--threads", threads});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.errors.rfind("softkin: --threads: must be an integer from 0 to 512, not " + threads, 0), 0u)
        << result.errors;
  }
}

TEST(FkCommand, RefusesScenes) {
  const BlockFolder folder;
  const ProgramResult none = run_program({"fk"}), absent = run_program({"fk", folder / "absent.yaml"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_EQ(none.errors, "softkin: SCENE is required (softkin fk --help shows more)\n");
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_EQ(absent.errors, "softkin: " + (folder / "absent.yaml") + ": no such file\n");
  folder.write("block.yaml", block_scene("colour: red\n"));
  expect_refused(folder, {"-o", folder / "new/a.vtu"}, "block.yaml:7: unknown key 'colour'");
  std::string scene = block_scene();
  folder.write("block.yaml", scene.replace(scene.find("fixed: [{region: base}]"), 23, "fixed: []"));
  expect_refused(folder, {"-o", folder / "new/a.vtu"}, "block.yaml");
}

TEST(FkCommand, ActuatorsThatAreNotSetRest) {
  const BlockFolder folder;
  const json step = json::parse(run_fk(folder.scene, {"--json"}).output)["steps"][0];
  EXPECT_EQ(step["actuation"], json({{"air", 1.0}}));
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(step["markers"]["corner"][axis], axis == 0 ? 20 : 12, 1e-9);
}

TEST(FkCommand, WritesWhatIsAskedForAndMakesFolders) {
  const BlockFolder folder;
  const ProgramResult result =
      run_fk(folder.scene, {"--set", "air=1.5", "-o", folder / "a/b/shape.VTU", "--report", folder / "a/c/report.json",
                            "--image", folder / "d/picture.png", "--view", "-0.5", "-1", "0.45"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "") << "no progress where there is no terminal";
  EXPECT_EQ(softkin::read_vtu_points(folder / "a/b/shape.VTU").rows(), 96);
  EXPECT_EQ(json::parse(read_text(folder / "a/c/report.json"))["steps"].size(), 1u);
  EXPECT_EQ(read_text(folder / "d/picture.png").substr(1, 3), "PNG");
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "a")) files += entry.is_regular_file();
  EXPECT_EQ(files, 2u) << "nothing beside them";
}

TEST(FkCommand, LooksFromAnywhere) {
  const BlockFolder folder;
  std::vector<std::string> pictures;
  for (const std::vector<std::string>& view :
       {std::vector<std::string>{"0", "0", "1"}, {"0", "0", "-3"}, {"1", "0", "0"}, {"-1e-9", "-1", "0"}}) {
    std::vector<std::string> options{"--image", folder / "a.png", "--view"};
    options.insert(options.end(), view.begin(), view.end());
    EXPECT_EQ(run_fk(folder.scene, options).exit_code, 0);
    pictures.push_back(read_text(folder / "a.png"));
  }
  std::sort(pictures.begin(), pictures.end());
  EXPECT_EQ(std::unique(pictures.begin(), pictures.end()), pictures.end());
}

TEST(FkCommand, JsonIsAllThatIsPrinted) {
  const BlockFolder folder;
  const ProgramResult result =
      run_fk(folder.scene, {"--set", "air=1.5", "--json", "--report", folder / "a.json", "-o", folder / "a.pvd"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.errors, "");
  EXPECT_EQ(result.output, read_text(folder / "a.json"));
  EXPECT_EQ(json::parse(result.output)["steps"][0]["shape"], "a_0000.vtu");
}

TEST(FkCommand, ResultsDoNotDependOnThreads) {
  const BlockFolder folder;
  std::vector<std::string> shapes;
  for (const std::string threads : {"0", "1", "2", "3"}) {
    const std::string file = folder / ("a" + threads + ".vtu");
    EXPECT_EQ(run_program({"fk", folder.scene, "--set", "air=1.2", "--solver-tolerance", "1e-3", "--threads", threads,
                           "-o", file})
                  .exit_code,
              0);
    shapes.push_back(read_text(file));
  }
  EXPECT_EQ(std::count(shapes.begin(), shapes.end(), shapes[0]), 4);
}

TEST(FkCommand, AndersonChangesTheWayNotTheShape) {
  const BlockFolder folder;
  const auto solve = [&](const std::string& window) {
    return json::parse(
        run_fk(folder.scene, {"--set", "air=1.5", "--solver", "local-global", "--anderson", window, "--json"})
            .output)["steps"][0];
  };
  const json printed = solve("0"), fast = solve("6");
  EXPECT_GT(printed["iterations"], 5 * fast["iterations"].get<int>());
  const json newton = json::parse(run_fk(folder.scene, {"--set", "air=1.5", "--json"}).output)["steps"][0];
  EXPECT_LT(newton["iterations"].get<int>(), fast["iterations"]);
  EXPECT_GT(newton["factorisations"], 0);
  for (int axis = 0; axis < 3; ++axis)
    for (const json& other : {printed, fast})
      EXPECT_NEAR(other["markers"]["tip"][axis], newton["markers"]["tip"][axis], 1e-3);
}

TEST(FkCommand, NotConvergingIsMarkedEverywhere) {
  const BlockFolder folder;
  const std::string shape = folder / "a.vtu", picture = folder / "a.png";
  const auto run = [&](const std::string& iterations) {
    return run_fk(folder.scene, {"--set", "air=1.5", "--max-iterations", iterations, "-o", shape, "--image", picture,
                                 "--report", folder / "a.json"});
  };
  const ProgramResult good = run("1000");
  EXPECT_EQ(good.exit_code, 0) << good.errors;
  const std::string good_shape = read_text(shape), good_picture = read_text(picture);
  const ProgramResult result = run("1");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(
      result.errors,
      "softkin: not converged: the limit of 1 iteration (max_iterations) was reached, and the shape is that after 1 "
      "iteration, not an equilibrium\n");
  EXPECT_NE(result.output.find("  not converged\n"), std::string::npos) << result.output;
  const json step = json::parse(read_text(folder / "a.json"))["steps"][0];
  EXPECT_EQ(step["status"], "not converged");
  EXPECT_EQ(step["iterations"], 1);
  EXPECT_NE(read_text(shape).find("Name=\"converged\""), std::string::npos);
  EXPECT_NE(read_text(shape), good_shape);
  EXPECT_NE(read_text(picture), good_picture);
}

TEST(FkCommand, APathGoesOnAfterAStepThatDidNotConverge) {
  const BlockFolder folder;
  const std::string path = folder.write("path.csv", "air\n1\n2\n1.9\n1\n1\n1\n");
  const std::vector<std::string> options{"--path",       path,       "--max-iterations", "2",  "--solver",
                                         "local-global", "--report", folder / "a.json",  "-o", folder / "a.pvd"};
  const ProgramResult result = run_fk(folder.scene, options);
  EXPECT_EQ(result.exit_code, 1);
  std::string unconverged;
  const json steps = json::parse(read_text(folder / "a.json"))["steps"];
  ASSERT_EQ(steps.size(), 6u);
  EXPECT_EQ(steps[0]["status"], "converged");
  for (const int i : {1, 2, 3}) EXPECT_EQ(steps[i]["status"], "not converged");
  EXPECT_EQ(result.errors.rfind("softkin: not converged in steps 1 to ", 0), 0u) << result.errors;
  std::vector<std::string> again = options;
  again.emplace_back("--resume");
  const ProgramResult resumed = run_fk(folder.scene, again);
  EXPECT_EQ(resumed.exit_code, 1) << "nothing is left, but not all is well";
  EXPECT_EQ(resumed.errors, result.errors);
}

/// Where the cells of a header end, two blanks apart.
std::vector<std::size_t> ends_of(const std::string& header) {
  std::vector<std::size_t> ends;
  for (std::size_t i = 0; i + 1 < header.size(); ++i)
    if (header[i] != ' ' && header.compare(i + 1, 2, "  ") == 0) ends.push_back(i);
  return ends;
}

/// Characters beyond ASCII count as one.
std::string one_column_each(const std::string& text) {
  std::string columns;
  for (const char c : text)
    if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) columns += static_cast<signed char>(c) < 0 ? '?' : c;
  return columns;
}

void expect_aligned(const std::string& output, std::size_t columns) {
  const std::vector<std::string> lines = lines_of(one_column_each(output));
  const auto header =
      std::find_if(lines.begin(), lines.end(), [](const std::string& line) { return line.rfind("step", 0) == 0; });
  ASSERT_NE(header, lines.end()) << output;
  const std::vector<std::size_t> ends = ends_of(*header);
  EXPECT_EQ(ends.size(), columns) << *header;
  for (auto row = header + 1; row != header + 3; ++row) {
    ASSERT_EQ(row->compare(row->size() - 9, 9, "converged"), 0) << *row;
    for (const std::size_t end : ends) {
      ASSERT_LT(end + 2, row->size());
      EXPECT_NE((*row)[end], ' ') << *header << "\n" << *row;
      EXPECT_EQ(row->substr(end + 1, 2), "  ") << *header << "\n" << *row;
    }
    EXPECT_EQ(row->substr(ends.back() + 3), "converged");
    EXPECT_EQ(header->substr(ends.back() + 3), "status");
  }
}

TEST(FkTable, ColumnsStandUnderTheirHeaders) {
  const BlockFolder folder;
  const std::string path = folder.write("path.csv", "air\n1\n1.1\n");
  const std::string plain = run_fk(folder.scene, {"--path", path}).output;
  expect_aligned(plain, 8);
  EXPECT_NE(plain.find("step  air [-]  achieved [-]  "), std::string::npos) << plain;
  EXPECT_NE(plain.find("tip x, y, z [mm]"), std::string::npos) << plain;
  EXPECT_NE(plain.find("time [s]  status"), std::string::npos) << plain;
  EXPECT_NE(plain.find("192 mm^3 at rest, ratio 1 to 2 [-]"), std::string::npos) << plain;
  EXPECT_NE(plain.find("96 vertices, 270 tetrahedra of order 1; target-shape formulation, solver newton\n"),
            std::string::npos)
      << plain;

  const std::string long_name = "a_very_long_actuator_name_that_goes_on_and_on_chamber_17";
  std::string scene = block_scene();
  scene.replace(scene.find("name: air"), 9, "name: " + long_name);
  scene.replace(scene.find("name: corner"), 12, "name: \xC3\x84rmel\xC3\xBCmschlag_mit_sehr_langem_Namen_\xC3\xBC");
  folder.write("block.yaml", scene);
  folder.write("path.csv", long_name + "\n1\n1.1\n");
  const std::string named = run_fk(folder.scene, {"--path", path}).output;
  expect_aligned(named, 8);
  EXPECT_NE(named.find("actuator " + long_name + ": "), std::string::npos);
  EXPECT_NE(named.find("chamber_17 [-]"), std::string::npos) << named;

  scene.replace(scene.find("markers: ["), 10, "markers: []\n# ");
  folder.write("block.yaml", scene);
  expect_aligned(run_fk(folder.scene, {"--path", path}).output, 5);
}

TEST(FkTable, ARobotWithoutActuatorsOrMarkers) {
  const BlockFolder folder;
  folder.write("block.yaml",
               "softkin: 1\nmesh: {file: block.msh}\nmaterials: [{shape_ratio: 1.0}]\n"
               "fixed: [{region: base}, {region: tip, displacement: [1, 0, 0]}]\n");
  const ProgramResult result = run_fk(folder.scene, {"--image", folder / "a.png"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("step  iterations  time [s]  status\n"), std::string::npos) << result.output;
  expect_refused(folder, {"--set", "air=1"}, "no actuator 'air'; the scene has none");
}

TEST(FkTable, TellsLargeAndTinyRobotsApart) {
  for (const double edge : {1e-4, 1e4}) {  // [mm]
    const BlockFolder folder;
    folder.write("block.msh", Block(5, edge).mesh.text());
    std::string scene = block_scene();
    folder.write("block.yaml", scene.replace(scene.find(", {name: corner"), 40, "]"));
    const std::string path = folder.write("path.csv", "air\n1\n1.1\n");
    const std::string output = run_fk(folder.scene, {"--path", path}).output;
    expect_aligned(output, 7);
    EXPECT_NE(output.find(edge < 1 ? " 0.000500000 " : " 50000.0 "), std::string::npos) << output;
  }
}

TEST(FkProgress, IsShownOnATerminalOnly) {
  const TemporaryFolder folder;
  folder.write("block.msh", Block(30).mesh.text());
  const std::string scene = folder.write("block.yaml", block_scene());
  std::string rows = "air\n";
  for (int i = 0; i < 8; ++i) rows += std::to_string(1.2 + 0.1 * i) + "\n";
  const std::vector<std::string> arguments{"fk",
                                           scene,
                                           "--path",
                                           folder.write("path.csv", rows),
                                           "--threads",
                                           "1",
                                           "--max-iterations",
                                           "2500",
                                           "--json",
                                           "--solver-tolerance",
                                           "1e-300",
                                           "--solver",
                                           "local-global"};
  StartedProgram program(folder, arguments, true);
  const std::string shown = program.wait().errors;
  EXPECT_NE(shown.find("[##"), std::string::npos) << shown;
  EXPECT_NE(shown.find("/8 steps, "), std::string::npos) << shown;
  EXPECT_NE(shown.find(" s left, iteration "), std::string::npos) << shown;
  EXPECT_NE(shown.find("\r\x1B[K"), std::string::npos);
  std::istringstream parts(shown);
  for (std::string part; std::getline(parts, part, '\r');)
    if (part.find("steps, ") != std::string::npos) {
      EXPECT_LT(part.size(), 80u + 3) << part;
    }
  const ProgramResult quiet = run_program(arguments);
  EXPECT_EQ(quiet.errors.rfind("softkin: not converged in steps 0 to 7", 0), 0u) << quiet.errors;
}

TEST(FkTable, IsTurnedOnItsSideWhereTheTerminalIsTooNarrow) {
  const TemporaryFolder folder;
  folder.write("block.msh", Block(5).mesh.text());
  const std::string scene = folder.write("block.yaml", block_scene());
  const auto shown_on = [&](int columns) {
    StartedProgram program(folder, {"fk", scene, "--set", "air=1.1"}, true, columns);
    return program.wait().errors;
  };
  const std::string narrow = shown_on(40), wide = shown_on(200);
  EXPECT_NE(narrow.find("\nair [-]              1.1000\r\n"), std::string::npos) << narrow;
  EXPECT_NE(narrow.find("\nstatus               converged\r\n"), std::string::npos) << narrow;
  EXPECT_NE(wide.find("step  "), std::string::npos) << wide;
  EXPECT_EQ(wide.find("\nair [-]"), std::string::npos) << wide;
}

TEST(FkHelp, NamesEveryOptionInALine) {
  const ProgramResult help = run_program({"fk", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.errors, "");
  for (const char* option : {"SCENE", "--set", "--path", "-o,--output", "--report", "--image", "--view", "--solver",
                             "--formulation", "--force", "--solver-tolerance", "--max-iterations", "--anderson",
                             "--options", "--threads", "--resume", "--json"})
    EXPECT_NE(help.output.find(std::string("\n  ") + option), std::string::npos) << option;
  for (const std::string& line : lines_of(help.output)) EXPECT_LE(line.size(), 100u) << line;
  EXPECT_NE(help.output.find("Exit code: 0 done, 1 not converged, a\nlimit or interrupted, 2 bad usage or bad input."),
            std::string::npos);
}

TEST(FkHelp, WithoutACommandOneLineHelps) {
  EXPECT_EQ(
      run_program({}).errors,
      "softkin: a command (fk, ik, follow, workspace, map, walk, grasp, compare, calibrate, estimate, measure, drive, "
      "mesh, view, examples) is "
      "required "
      "(softkin --help shows more)\n");
  EXPECT_EQ(run_program({}).exit_code, 2);
}

/// A misspelt name is reported before missing or unreadable arguments of the command.
TEST(FkHelp, NamesAreCorrectedFirst) {
  const auto reported = [](const std::vector<std::string>& arguments) {
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.output, "");
    return result.errors;
  };
  EXPECT_EQ(reported({"fkk", "nowhere.yaml"}),
            "softkin: there is no command 'fkk'; did you mean 'fk'? (softkin --help shows more)\n");
  EXPECT_EQ(reported({"mesh", "chekc"}),
            "softkin: there is no command 'chekc'; did you mean 'check'? (softkin mesh --help shows more)\n");
  EXPECT_EQ(reported({"ik", "--traget", "tip=1,2,3"}),
            "softkin: there is no option --traget; did you mean --target? (softkin ik --help shows more)\n");
  EXPECT_EQ(reported({"fk", "nowhere.yaml", "--out", "a.vtu"}),
            "softkin: there is no option --out; did you mean --output? (softkin fk --help shows more)\n");
}

TEST(Help, OfEveryCommandFitsAPage) {
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{{},
                                                                                       {"fk"},
                                                                                       {"ik"},
                                                                                       {"follow"},
                                                                                       {"workspace"},
                                                                                       {"map"},
                                                                                       {"map", "export"},
                                                                                       {"walk"},
                                                                                       {"grasp"},
                                                                                       {"compare"},
                                                                                       {"calibrate"},
                                                                                       {"calibrate", "material"},
                                                                                       {"calibrate", "pressure"},
                                                                                       {"calibrate", "dea"},
                                                                                       {"calibrate", "relaxation"},
                                                                                       {"drive"},
                                                                                       {"mesh"},
                                                                                       {"mesh", "info"},
                                                                                       {"mesh", "check"},
                                                                                       {"mesh", "convert"},
                                                                                       {"examples"},
                                                                                       {"examples", "list"},
                                                                                       {"examples", "copy"}}) {
    std::vector<std::string> arguments = command;
    arguments.emplace_back("--help");
    const ProgramResult help = run_program(arguments);
    EXPECT_EQ(help.exit_code, 0);
    for (const std::string& line : lines_of(help.output)) EXPECT_LE(line.size(), 100u) << line;
  }
}

}  // namespace
