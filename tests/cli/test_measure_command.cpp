#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/io/table/csv.hpp>
#include <vision/rendering.hpp>

#include "run_program.hpp"

namespace {

using namespace softkin;
using namespace softkin::testing;
using namespace softkin::vision;
using nlohmann::json;

constexpr double scale = 5;  // pixels in a mm

std::vector<Disc> three() {
  return {{{10, 30}, 2, green}, {{60, 30}, 2, blue}, {{30.4, 12.2}, 2.5, red}};
}

Photograph photograph() {
  return {.width = 360, .height = 200, .to_picture = straight(scale, {0, 199}), .blur = 0.9, .noise = 3};
}

/// Runs softkin measure on pictures that it writes into a folder of its own.
class Measure : public ::testing::Test {
 protected:
  void SetUp() override {
#ifndef SOFTKIN_OPENCV
    GTEST_SKIP() << "built without OpenCV";
#endif
  }

  std::string shoot(const std::string& name, const Paint& paint, const Photograph& photo = photograph()) const {
    return folder_.write(name, encode_png(render(photo, paint)));
  }

  static ProgramResult measure(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "measure");
    return run_program(arguments);
  }

  /// Checks for exit code 2 and one line with these words; nothing else is printed or written.
  void expect_refused(const std::vector<std::string>& arguments, const std::vector<std::string>& words) const {
    const std::size_t files = folder_.files();
    const ProgramResult result = measure(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_EQ(result.output, "");
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    for (const std::string& word : words)
      EXPECT_NE(result.errors.find(word), std::string::npos) << "no '" << word << "' in: " << result.errors;
    EXPECT_EQ(folder_.files(), files) << "something was written";
  }

  const TemporaryFolder folder_;
};

TEST_F(Measure, DotsInMillimetresFromTwoOfThem) {
  const std::string picture = shoot("a.png", discs_on(three())), table = folder_ / "a.csv";
  const ProgramResult result = measure(
      {picture, "--dots", "green,blue,tip=red", "--scale", "green,blue=5cm", "--angle", "green,tip", "-o", table});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* part : {"tip", "x [mm]", "error [mm]", "mm per pixel in the middle", "no camera given",
                           "origin at the first point of the scale"})
    EXPECT_NE(result.output.find(part), std::string::npos) << "no '" << part << "' in:\n" << result.output;
  const CsvTable read = read_csv(table);
  const auto value = [&](const std::string& column) {
    const auto found = std::find(read.columns.begin(), read.columns.end(), column);
    EXPECT_NE(found, read.columns.end()) << column;
    return found == read.columns.end() ? 0.0 : read.rows.at(0)[std::size_t(found - read.columns.begin())];
  };
  const double tenth = 0.1 / scale;
  EXPECT_NEAR(value("tip_x_mm"), 20.4, tenth);
  EXPECT_NEAR(value("tip_y_mm"), -17.8, tenth);
  EXPECT_NEAR(value("blue_x_mm"), 50, 1e-3);
  EXPECT_NEAR(value("angle_green_tip_deg"), std::atan2(-17.8, 20.4) * 180 / M_PI, 0.1);
  EXPECT_LT(value("tip_error_mm"), tenth);
}

TEST_F(Measure, FrameFollowsOriginAndAxis) {
  const std::string picture = shoot("a.png", discs_on(three()));
  const ProgramResult result = measure({picture, "--dots", "green,blue,red", "--scale", "50,49,300,49=50mm", "--origin",
                                        "blue", "--x-axis", "blue,green", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json marker = json::parse(result.output)["pictures"][0]["markers"]["red"];
  EXPECT_NEAR(marker["x_mm"].get<double>(), 60 - 30.4, 0.03);  // x now goes to the left, so y goes down
  EXPECT_NEAR(marker["y_mm"].get<double>(), 30 - 12.2, 0.03);
  EXPECT_NEAR(marker["x_px"].get<double>(), 152, 0.1);
}

TEST_F(Measure, SpecimenGivesTheElasticityRatio) {
  const BarPaint rest{{6, 20}, 0.02, 20, 50, 9};
  BarPaint pulled = rest;
  pulled.interface = 21.5;
  pulled.length = 60.5;
  const auto with_dots = [](const BarPaint& bar) {
    return discs_on({{{10, 35}, 2, green}, {{60, 35}, 2, {240, 195, 35}}}, bar);
  };
  const std::string a = shoot("rest.png", with_dots(rest)), b = shoot("pulled.png", with_dots(pulled));
  const std::string table = folder_ / "s.csv";
  const std::vector<std::string> arguments{
      a, b, "--interface", "red,blue", "--dots", "green,yellow", "--scale", "green,yellow=50mm"};
  std::vector<std::string> to_file = arguments, to_json = arguments;
  to_file.insert(to_file.end(), {"-o", table});
  to_json.emplace_back("--json");
  const ProgramResult result = measure(to_file);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("E_A / E_B by Eq. (16)"), std::string::npos) << result.output;
  const CsvTable read = read_csv(table);
  EXPECT_EQ(read.columns, (std::vector<std::string>{"l_mm", "l1_mm", "dl_mm", "dl1_mm"}));
  const std::array<double, 4> truth{50, 20, 10.5, 1.5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(read.rows.at(0)[i], truth[i], 0.15 / scale) << read.columns[i];
  const json ratio = json::parse(measure(to_json).output)["stretches"][0];
  EXPECT_NEAR(ratio["E_A_by_E_B"].get<double>(), (9.0 / 30) / (1.5 / 20), 0.1);
  EXPECT_LT(ratio["E_A_by_E_B_error"].get<double>(), 0.1);
}

TEST_F(Measure, TrackOfAFolderSaysWhatItLeftOut) {
  std::filesystem::create_directory(folder_ / "film");
  const auto at = [](int i) { return Vec2(20 + 4 * i, 10 + 0.5 * i * i); };
  for (int i = 0; i < 6; ++i) {
    std::vector<Disc> discs{three()[0], three()[1], {at(i), 2, red}};
    if (i == 3) discs.pop_back();
    shoot("film/f" + std::to_string(8 + i) + ".png", discs_on(discs));
  }
  const std::string table = folder_ / "track.csv";
  const ProgramResult result =
      measure({folder_ / "film", "--fps", "20", "--dots", "red,green,blue", "--scale", "green,blue=50mm", "-o", table});
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_NE(result.output.find("5 frames of 6"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("f11.png: no dot 'red' found"), std::string::npos) << result.output;
  const CsvTable read = read_csv(table);
  EXPECT_EQ(read.columns[1], "red_x_mm");
  ASSERT_EQ(read.rows.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    const int i = static_cast<int>(k < 3 ? k : k + 1);
    EXPECT_NEAR(read.rows[k][0], i / 20.0, 1e-9);
    EXPECT_NEAR(read.rows[k][1], at(i).x() - 10, 0.1 / scale);
    EXPECT_NEAR(read.rows[k][2], at(i).y() - 30, 0.1 / scale);
  }
}

TEST_F(Measure, SingleMarkerOfAFilmIsAPath) {
  std::vector<std::string> arguments;
  for (int i = 0; i < 3; ++i)
    arguments.push_back(shoot("p" + std::to_string(i) + ".png", discs_on({{Vec2(20 + 4 * i, 10), 2, red}})));
  const std::string table = folder_ / "path.csv";
  arguments.insert(arguments.end(), {"--fps", "10", "--dots", "red", "--scale", "0,199,100,199=20mm", "-o", table});
  const ProgramResult result = measure(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const CsvTable read = read_csv(table);
  EXPECT_EQ(read.columns, (std::vector<std::string>{"t_s", "x_mm", "y_mm"}));
  EXPECT_NEAR(read.rows[2][1], 28, 0.03);
  EXPECT_NEAR(read.rows[2][2], 10, 0.03);
}

TEST_F(Measure, BoardThatWasWrittenIsRead) {
  const std::string board = folder_ / "board.png", spec = "5x4,tag=12mm,gap=3mm";
  ASSERT_EQ(measure({"board", spec, "-o", board, "--dpi", "254"}).exit_code, 0);
  const ProgramResult result = measure({board, "--scale-board", "5x3,tag=12mm,gap=3mm", "--tags=17", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const json marker = json::parse(result.output)["pictures"][0]["markers"]["tag17"];
  EXPECT_NEAR(marker["x_mm"].get<double>(), 36, 0.03);  // below the third of the upper rows
  EXPECT_NEAR(marker["y_mm"].get<double>(), -9, 0.03);
  ASSERT_EQ(measure({"board", spec, "-o", folder_ / "board.svg"}).exit_code, 0);
  EXPECT_NE(read_text(folder_ / "board.svg").find("width=\"78mm\""), std::string::npos);
}

TEST_F(Measure, CameraFromCheckerBoards) {
  const auto checker = [](const Vec2& p) {
    if (p.x() < 0 || p.y() < 0 || p.x() > 80 || p.y() > 56) return paper;
    return (int(p.x() / 8) + int(p.y() / 8)) % 2 == 0 ? ink : paper;
  };
  const Camera lens{.width = 480, .height = 360, .fx = 500, .fy = 500, .cx = 242, .cy = 177, .k1 = -0.2, .k2 = 0.05};
  std::vector<std::string> arguments{"camera"};
  for (unsigned i = 0; i < 5; ++i) {
    Photograph photo{.width = 480, .height = 360, .camera = lens, .blur = 0.8, .noise = 3, .seed = i + 1};
    photo.to_picture = tilted(500, {242, 177}, {0.5 * std::sin(1.3 * i), 0.5 * std::cos(1.3 * i), 0}, {-40, 28, 125});
    arguments.push_back(shoot("c" + std::to_string(i) + ".png", checker, photo));
  }
  const std::string camera = folder_ / "camera.yaml";
  std::vector<std::string> whole = arguments;
  whole.insert(whole.end(), {"--board", "checker,10x7,square=8mm", "-o", camera});
  const ProgramResult result = measure(whole);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("reprojection error: 0."), std::string::npos) << result.output;
  const std::string written = read_text(camera);
  EXPECT_NEAR(std::stod(written.substr(written.find("fx: ") + 4)), 500, 5);
  // a picture of another size does not fit the camera
  expect_refused({shoot("a.png", discs_on(three())), "--dots", "red", "--scale", "0,0,9,0=9mm", "--camera", camera},
                 {"a.png", "360 x 200", "camera.yaml", "480 x 360"});
  const std::string other = folder_ / "other.yaml";
  std::vector<std::string> missing = arguments;
  missing.insert(missing.begin() + 3, shoot("empty.png", discs_on({}), {.width = 480, .height = 360}));
  missing.insert(missing.end(), {"--board", "checker,10x7,square=8mm", "-o", other});
  expect_refused(missing, {"empty.png", "board is not found"});
  expect_refused({"camera", arguments[1], arguments[2], "--board", "checker,10x7,square=8mm", "-o", other},
                 {"4 pictures"});
}

TEST_F(Measure, RefusesPicturesByName) {
  const std::string good = shoot("good.png", discs_on(three())), table = folder_ / "t.csv";
  const auto dots = [&](const std::string& file) {
    return std::vector<std::string>{file, "--dots", "red", "--scale", "0,0,100,0=20mm", "-o", table};
  };
  expect_refused(dots(folder_ / "none.png"), {"none.png"});
  expect_refused(dots(folder_.write("text.png", "text")), {"text.png", "not a picture"});
  expect_refused(dots(shoot("no.png", discs_on({three()[0]}))), {"no.png", "no dot 'red' found"});
  expect_refused(dots(shoot("two.png", discs_on({three()[2], {{50, 12}, 2.5, red}}))), {"two.png", "two candidates"});
  expect_refused(dots(shoot("cut.png", discs_on({{{71, 12}, 2.5, red}}))), {"cut.png", "outside the frame"});
  Photograph bright = photograph();
  bright.exposure = 9;
  expect_refused(dots(shoot("bright.png", discs_on(three()), bright)), {"bright.png", "over-exposed"});
  expect_refused({good, "--dots", "red", "--scale-board", "5x4,tag=12mm,gap=3mm", "-o", table},
                 {"good.png", "board is not found"});
  expect_refused({good, "--tags", "--scale", "0,0,100,0=20mm", "-o", table}, {"good.png", "no tag"});
  expect_refused({good, "--tags=3", "--scale", "0,0,100,0=20mm", "-o", table}, {"good.png", "tag 3 not found"});
  expect_refused({good, "--interface", "red,magenta", "--scale", "0,0,100,0=20mm", "-o", table},
                 {"good.png", "magenta"});
  // the second picture fails: nothing of the first is kept
  expect_refused({good, folder_ / "two.png", "--dots", "red", "--scale", "0,0,100,0=20mm", "-o", table},
                 {"two.png", "two candidates"});
}

TEST_F(Measure, OutlinesGoIntoATable) {
  const Paint disc = discs_on({{{40, 20}, 15, ink}});
  const std::string a = shoot("a.png", disc), b = shoot("b.png", discs_on({{{66, 20}, 15, ink}})),
                    table = folder_ / "o.csv";
  const std::vector<std::string> requested{a, b, "--outline", "dark", "--scale", "0,199,100,199=20mm", "-o", table};
  const ProgramResult result = measure(requested);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* part : {"outline [mm]", "area [mm^2]", "reaches the frame", "wrote "})
    EXPECT_NE(result.output.find(part), std::string::npos) << "no '" << part << "' in:\n" << result.output;
  const CsvTable read = read_csv(table);
  EXPECT_EQ(read.columns, (std::vector<std::string>{"picture", "x_mm", "y_mm"}));
  std::size_t whole = 0;
  for (const auto& row : read.rows) {
    EXPECT_NEAR(std::hypot(row[1] - (row[0] == 1 ? 40 : 66), row[2] - 20), 15, 0.1);
    whole += row[0] == 1;
  }
  EXPECT_GT(whole, 150u);
  EXPECT_LE(whole, 400u);
  const ProgramResult reported = measure({a, "--outline", "dark", "--scale", "0,199,100,199=20mm", "--json"});
  ASSERT_EQ(reported.exit_code, 0) << reported.errors;
  const json outline = json::parse(reported.output)["pictures"][0]["outline"];
  EXPECT_EQ(outline["points"], whole);
  EXPECT_EQ(outline["x_mm"].size(), whole);
  EXPECT_NEAR(outline["area_mm2"].get<double>(), M_PI * 225, 0.01 * M_PI * 225);
  EXPECT_NEAR(outline["length_mm"].get<double>(), M_PI * 30, 0.01 * M_PI * 30);
  EXPECT_EQ(outline["cut"], false);
  EXPECT_EQ(measure(requested).exit_code, 0) << "what it wrote it replaces";
  const std::string other = folder_ / "other.csv";
  const auto refused = [&](const std::vector<std::string>& options, const std::vector<std::string>& words) {
    std::vector<std::string> all{a, "--scale", "0,199,100,199=20mm", "-o", other};
    all.insert(all.end(), options.begin(), options.end());
    expect_refused(all, words);
  };
  refused({"--outline", "red"}, {"a.png", "no outline found", "nothing that is red"});
  refused({"--outline", "bright"}, {"a.png", "it is the ground"});
  refused({"--outline", "drak"}, {"outline: no colour 'drak'", "dark or bright"});
  refused({"--outline", "dark", "--interface", "red,blue"}, {"an interface and an outline"});
  refused({"--outline", "dark", "--fps", "5"}, {"--outline", "not in a film"});
}

TEST_F(Measure, RefusesOptionsByName) {
  const std::string good = shoot("good.png", discs_on(three())), table = folder_ / "t.csv";
  const auto refused = [&](std::vector<std::string> options, const std::vector<std::string>& words) {
    options.insert(options.begin(), good);
    options.insert(options.end(), {"-o", table});
    expect_refused(options, words);
  };
  refused({"--dots", "red"}, {"scale"});
  refused({"--scale", "0,0,100,0=20mm"}, {"nothing to measure"});
  refused({"--dots", "red", "--scale", "0,0,100,0=20"}, {"scale", "no unit"});
  refused({"--dots", "red", "--scale", "0,0,100,0=20kPa"}, {"scale", "20kPa"});
  refused({"--dots", "red", "--scale", "0,0,1=20mm"}, {"scale"});
  refused({"--dots", "red", "--scale", "a,b=20mm"}, {"scale", "no marker 'a'"});
  refused({"--dots", "rde", "--scale", "0,0,100,0=20mm"}, {"dots", "did you mean 'red'"});
  refused({"--dots", "red,red", "--scale", "0,0,100,0=20mm"}, {"dots", "'red'"});
  refused({"--dots", "red", "--scale", "0,0,100,0=20mm", "--angle", "red,blue"}, {"angle", "'blue'"});
  refused({"--dots", "red", "--scale", "0,0,100,0=20mm", "--origin", "tip"}, {"origin", "'tip'"});
  refused({"--dots", "red", "--scale-board", "5x4,tag=12,gap=3mm"}, {"tag", "no unit"});
  refused({"--dots", "red", "--scale-board", "checker,9x6,square=10mm"}, {"upside down"});
  refused({"--tags=99", "--scale", "0,0,100,0=20mm"}, {"tags", "no tag 99"});
  refused({"--tags=250", "--scale-board", "5x4,tag=12mm,gap=3mm,dictionary=6x6_250"},
          {"tags", "dictionary 6x6_250 has no tag 250"});
  refused({"--tags", "--dictionary", "4x4", "--scale", "0,0,100,0=20mm"}, {"dictionary", "4x4"});
  refused({"--dots", "red", "--scale", "0,0,100,0=20mm", "--fps", "-1"}, {"--fps"});
  refused({"--interface", "red", "--scale", "0,0,100,0=20mm"}, {"interface"});
  refused({"--interface", "red,blue", "--scale", "0,0,100,0=20mm", "--fps", "5"}, {"--interface"});
  expect_refused({good, "--dots", "red", "--scale", "0,0,100,0=20mm", "-o", good}, {"-o", ".csv"});
  expect_refused({}, {"PICTURES"});
  expect_refused({good, "--dotts", "red"},
                 {"there is no option --dotts; did you mean --dots? (softkin measure --help"});
  expect_refused({"camera", good, "--bord", "checker"}, {"did you mean --board? (softkin measure camera --help"});
  refused({"--camera", "camera", "--dots", "red", "--scale", "0,0,100,0=20mm"}, {"camera: "});
  EXPECT_EQ(measure({"--help"}).exit_code, 0);
  EXPECT_EQ(measure({"camera", "--help"}).exit_code, 0);
}

}  // namespace
