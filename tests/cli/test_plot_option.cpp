#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <set>

#include "fk_samples.hpp"

namespace {

using namespace softkin::testing;
using nlohmann::json;

/// Texts of a plot; the numbers of points of its curves.
struct PlotText {
  std::set<std::string> texts;
  std::vector<std::size_t> points;

  explicit PlotText(const std::string& file) {
    pugi::xml_document xml;
    EXPECT_TRUE(xml.load_string(read_text(file).c_str())) << file;
    for (const auto& found : xml.select_nodes("//text")) texts.insert(found.node().child_value());
    for (const auto& found : xml.select_nodes("//polyline")) {
      const std::string text = found.node().attribute("points").value();
      points.push_back(std::count(text.begin(), text.end(), ','));
    }
  }
  void expect(const std::vector<std::string>& wanted) const {
    for (const std::string& text : wanted) EXPECT_TRUE(texts.count(text)) << "no '" << text << "'";
  }
};

TEST(PlotOption, FkDrawsWhatThePathDoes) {
  const BlockFolder folder(physical_scene());
  const std::string path = folder.write("path.csv", "t_s,air,tendon\n0,1,1\n1,1.1,0.98\n3,1.2,0.96\n");
  const ProgramResult result = run_fk(folder.scene, {"--path", path, "--plot", folder / "out/plot.svg"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("plot: " + (folder / "out/plot.svg")), std::string::npos) << result.output;
  const PlotText plot(folder / "out/plot.svg");
  plot.expect({"time [s]", "command [-]", "air", "tendon", "corner", "position [mm]", "gauge pressure [kPa]",
               "tension [N]", "x [mm]", "z [mm]", "seen along y"});
  ASSERT_FALSE(plot.points.empty());
  EXPECT_EQ(plot.points.front(), 3u);
}

/// A pressure against itself would be a straight line whatever the robot does.
TEST(PlotOption, FkDrawsVolumesUnderPressureAndTurns) {
  const BlockFolder folder(loaded_scene());
  const std::string path = folder.write("path.csv", "air_kPa,tendon\n0,0\n40,0\n80,0\n");
  const ProgramResult result =
      run_fk(folder.scene, {"--path", path, "--turn", "tip", "corner", "--plot", folder / "plot.svg"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("turn tip to corner [deg]"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("tip turned [deg]"), std::string::npos) << result.output;
  const PlotText plot(folder / "plot.svg");
  plot.expect({"air [kPa]", "volume ratio [-]", "length ratio [-]", "turn [deg]", "tip to corner", "tip"});
  for (const char* none : {"gauge pressure [kPa]", "tension [N]"}) EXPECT_FALSE(plot.texts.count(none)) << none;
  expect_refused(folder, {"--path", path, "--turn", "tip", "corer"}, "--turn: there is no marker 'corer'");
}

TEST(PlotOption, FkDrawsAlongTheOnlyCommandThatChanges) {
  const BlockFolder folder;
  const std::string path = folder.write("path.csv", "air\n1\n1.1\n1.2\n");
  ASSERT_EQ(run_fk(folder.scene, {"--path", path, "--plot", folder / "plot.svg"}).exit_code, 0);
  const PlotText plot(folder / "plot.svg");
  plot.expect({"air [-]", "position [mm]"});
  EXPECT_FALSE(plot.texts.count("command [-]"));
  const std::string back = folder.write("back.csv", "air\n1\n1.1\n1\n");  // no function of its command
  ASSERT_EQ(run_fk(folder.scene, {"--path", back, "--plot", folder / "back.svg"}).exit_code, 0);
  PlotText(folder / "back.svg").expect({"step", "command [-]"});
}

TEST(PlotOption, FkMarksWhatDidNotConvergeAndKeepsStepsOfAnInterruptedRun) {
  const BlockFolder folder;
  const std::string path = folder.write("path.csv", "air\n1\n1.2\n1.4\n");
  const std::vector<std::string> options{
      "--path",         path,       "--plot",       folder / "plot.svg", "--report", folder / "r.json", "-o",
      folder / "s.pvd", "--solver", "local-global", "--max-iterations",  "2"};
  EXPECT_EQ(run_fk(folder.scene, options).exit_code, 1);
  PlotText(folder / "plot.svg").expect({"not converged"});
  const std::string before = read_text(folder / "plot.svg");
  json report = json::parse(read_text(folder / "r.json"));
  report["steps"].erase(2);
  folder.write("r.json", report.dump());
  std::vector<std::string> again = options;
  again.emplace_back("--resume");
  EXPECT_EQ(run_fk(folder.scene, again).exit_code, 1);
  EXPECT_EQ(read_text(folder / "plot.svg"), before);
}

/// Heights of the bars of each histogram over that of the highest of all, as they are drawn.
std::vector<std::vector<double>> drawn_bars(const std::string& file) {
  pugi::xml_document xml;
  EXPECT_TRUE(xml.load_string(read_text(file).c_str())) << file;
  std::vector<std::vector<double>> drawn;
  double highest = 0;
  for (const auto& found : xml.select_nodes("//polyline")) {
    std::string text = found.node().attribute("points").value();
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream stream(text);
    std::vector<double> y;
    for (double x = 0, value = 0; stream >> x >> value;) y.push_back(value);
    if (y.size() < 3) continue;  // the ends of a linear range
    const double base = y.front();
    drawn.emplace_back();
    for (std::size_t i = 1; i + 1 < y.size(); ++i)
      if (y[i] < base - 1e-9 && y[i] == y[i + 1]) drawn.back().push_back(base - y[i]);
    for (const double bar : drawn.back()) highest = std::max(highest, bar);
  }
  for (auto& bars : drawn)
    for (double& bar : bars) bar /= highest;
  return drawn;
}

TEST(PlotOption, FkDrawsTheStrainsOfItsReport) {
  const BlockFolder folder;
  const std::string path = folder.write("path.csv", "air\n1\n1.1\n1.3\n");
  const ProgramResult result =
      run_fk(folder.scene, {"--path", path, "--strains", folder / "s.svg", "--report", folder / "r.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("strains: " + (folder / "s.svg")), std::string::npos) << result.output;
  std::vector<std::vector<double>> fractions;
  double highest = 0;
  const json report = json::parse(read_text(folder / "r.json"));
  for (const json& step : report["steps"]) {
    if (step["actuation"]["air"] == 1) continue;  // at rest there is nothing to see
    fractions.emplace_back();
    for (const double fraction : step["strain"]["volume_shares"])
      if (fraction > 0) fractions.back().push_back(fraction);
    for (const double fraction : fractions.back()) highest = std::max(highest, fraction);
  }
  const std::vector<std::vector<double>> bars = drawn_bars(folder / "s.svg");
  ASSERT_EQ(bars.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(bars[i].size(), fractions[i].size());
    for (std::size_t b = 0; b < bars[i].size(); ++b) EXPECT_NEAR(bars[i][b], fractions[i][b] / highest, 0.005);
  }
  const PlotText plot(folder / "s.svg");
  plot.expect({"principal strain [%]", "fraction of volume [%]"});
  for (const char* command : {"air = 1.1 [-]", "air = 1.3 [-]"})
    EXPECT_TRUE(std::any_of(plot.texts.begin(), plot.texts.end(), [&](const std::string& text) {
      return text.find(command) != std::string::npos;
    })) << command;
  expect_refused(folder, {"--strains", folder / "s.png"}, "must end in .svg");
}

TEST(PlotOption, FkRefusesPlotsThatCannotBe) {
  const BlockFolder folder;
  const std::string path = folder.write("path.csv", "air\n1\n1.2\n");
  expect_refused(folder, {"--plot", folder / "plot.svg"}, "--plot draws the steps of a path");
  expect_refused(folder, {"--path", path, "--plot", folder / "plot.png"}, "must end in .svg");
  expect_refused(folder, {"--path", path, "--plot", folder / "a.svg", "--report", folder / "a.svg"},
                 "--report " + (folder / "a.svg") + ": must end in .json");
  expect_refused(folder, {"--path", path, "--plot", folder.scene + "/a.svg"}, "--plot");
}

TEST(PlotOption, CompareDrawsDifferences) {
  const BlockFolder folder(physical_scene());
  const std::string path = folder.write("path.csv", "air\n1\n1.1\n1.2\n"), a = folder / "a.json", b = folder / "b.json";
  ASSERT_EQ(run_fk(folder.scene, {"--path", path, "--report", a}).exit_code, 0);
  ASSERT_EQ(run_fk(folder.scene, {"--path", path, "--report", b, "--force", "payload=0,0,-0.1"}).exit_code, 0);
  const ProgramResult result = run_program({"compare", a, b, "--turn", "tip", "corner", "--plot", folder / "c.svg"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  PlotText(folder / "c.svg")
      .expect({"air [-]", "turn [degrees]", "tip off by [mm]", "load [kPa]", "load [N]", "a: air", "b: air", "b"});
  for (const auto& [file, why] : {std::pair{a, ".svg"}, std::pair{folder / "c.png", ".svg"}}) {
    const ProgramResult refused = run_program({"compare", a, b, "--plot", file});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_NE(refused.errors.find(why), std::string::npos) << refused.errors;
  }
}

}  // namespace
