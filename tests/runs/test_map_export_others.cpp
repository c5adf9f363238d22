#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/runs/map_export.hpp>
#include <softkin/runs/page.hpp>

#include "cli/run_program.hpp"
#include "exported_maps.hpp"
#include "support/skips.hpp"

/// The exported module in node, and the arrays in numpy, against the map itself.

namespace softkin::runs {
namespace {

using Reported = nlohmann::json;

#define SKIP_WITHOUT_MODULES()                   \
  if (!page_is_there()) GTEST_SKIP() << no_page; \
  SKIP_WITHOUT_PROGRAM("node")

/// not_a_number: as a reader of JSON wants it
std::string commands_text(const std::vector<Eigen::VectorXd>& rows, const std::string& not_a_number) {
  std::string text;
  for (const Eigen::VectorXd& row : rows) {
    text += text.empty() ? "[" : ",";
    for (Index i = 0; i < std::ssize(row); ++i)
      text += (i == 0 ? "[" : ",") + (std::isnan(row[i]) ? not_a_number : exact(row[i]));
    text += "]";
  }
  return text + "]";
}

Reported reported_by(const std::string& program, const std::filesystem::path& exported, const std::string& commands,
                     const softkin::testing::TemporaryFolder& folder) {
  using softkin::testing::shell_quoted;
  const std::string file = folder.write("commands.json", commands);
  const auto run =
      softkin::testing::run_shell(program + " " + shell_quoted(exported.string()) + " " + shell_quoted(file) + " 2>&1");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  return run.exit_code == 0 ? Reported::parse(run.output) : Reported();
}

void expect_close(const Reported& found, const Eigen::Ref<const Eigen::VectorXd>& wanted, double tolerance) {
  ASSERT_EQ(found.size(), static_cast<std::size_t>(wanted.size()));
  for (Index i = 0; i < std::ssize(wanted); ++i)
    EXPECT_NEAR(found[i].get<double>(), wanted[i], tolerance * std::max(1.0, std::abs(wanted[i])));
}

void expect_shape(const Reported& found, const KinematicMap& map, const Eigen::VectorXd& commands,
                  const KinematicMap::Place& place) {
  if (!map.data().shape) return;
  const Points points = map.shape(commands.data(), place);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(points.size()));
  for (Index v = 0; v < points.rows(); ++v)
    for (Index k = 0; k < 3; ++k) EXPECT_NEAR(found[3 * v + k].get<double>(), points(v, k), 1e-4) << "vertex " << v;
}

/// Returns how many of the commands are inside; calls compare with the map's own results for those.
template <class Compare>
int compare_all(const KinematicMap& map, const std::vector<Eigen::VectorXd>& commands, const Reported& answers,
                const Compare& compare) {
  int inside = 0;
  Eigen::VectorXd values(map.outputs());
  maps::RowMatrix slopes(map.inputs(), map.outputs());
  EXPECT_EQ(answers.size(), commands.size());
  for (std::size_t n = 0; n < std::min(commands.size(), answers.size()); ++n) {
    const auto place = map.evaluate(commands[n].data(), values.data(), slopes.data());
    const bool answered = answers[n].contains("outputs") && !answers[n]["outputs"].is_null();
    EXPECT_EQ(answered, place.has_value()) << commands[n].transpose();
    if (!answered || !place) continue;
    ++inside;
    expect_close(answers[n]["outputs"], values, 1e-12);
    expect_shape(answers[n]["shape"], map, commands[n], *place);
    compare(answers[n], values, slopes);
  }
  EXPECT_GT(inside, 50);
  EXPECT_GT(commands.size(), static_cast<std::size_t>(inside));
  return inside;
}

/// Checks that ik reports its true error, and that it reaches targets that are the map's own outputs.
void expect_ik(const KinematicMap& map, const Reported& found, const Eigen::Vector3d& target, int& reached) {
  if (found.is_null()) return;  // it starts outside
  const auto commands = found["commands"].get<std::vector<double>>();
  Eigen::VectorXd values(map.outputs());
  ASSERT_TRUE(map.evaluate(commands.data(), values.data()));
  const double error = (values.head<3>() - target).norm();
  EXPECT_NEAR(found["errorMm"].get<double>(), error, 1e-9);
  EXPECT_EQ(found["reached"].get<bool>(), error <= 1e-3);
  reached += error <= 1e-3;
}

/// Words after "export" that name something.
std::set<std::string> exported_names(const std::string& text) {
  std::set<std::string> names;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (word != "export" || !(words >> word >> word)) continue;
    names.insert(word.substr(0, word.find_first_of("(:")));
  }
  return names;
}

void compare_module(const MapData& data) {
  SCOPED_TRACE(data.name);
  const KinematicMap map(data);
  const softkin::testing::TemporaryFolder folder;
  const std::vector<Eigen::VectorXd> commands = testing::commands_of(map, false, 80);
  const Reported reported =
      reported_by("node '" SOFTKIN_SOURCE_DIR "/tests/runs/exported_map.mjs'",
                  folder.write("map.mjs", map_js_module(data)), commands_text(commands, "null"), folder);
  int reached = 0, reached_far = 0;
  const int inside = compare_all(map, commands, reported["answers"],
                                 [&](const Reported& answer, const auto& values, const auto& slopes) {
                                   for (Index q = 0; q < map.outputs(); ++q)
                                     expect_close(answer["jacobian"][q], slopes.col(q), 1e-9);
                                   expect_ik(map, answer["near"], values.template head<3>(), reached);
                                   expect_ik(map, answer["far"], 4 * values.template head<3>(), reached_far);
                                 });
  EXPECT_GE(reached, data.name == "2 boxes" ? 0 : inside * 97 / 100);
  EXPECT_LT(reached_far, inside);
  EXPECT_EQ(reported["check"], "");
  EXPECT_EQ(reported["name"], data.name);
  EXPECT_EQ(reported["outputs"][0]["largestError"], data.check.largest[0]);
  EXPECT_EQ(reported["inputs"][0]["high"], data.inputs[0].high);
  EXPECT_EQ(reported["checked"]["points"], 200);
  EXPECT_EQ(reported["exported"].get<std::set<std::string>>(), exported_names(map_js_types(data)));
}

TEST(MapExportJs, AnswersAsTheMapDoes) {
  SKIP_WITHOUT_MODULES();
  for (const MapData& data : testing::small_maps()) compare_module(data);
}

TEST(MapExportJs, ItsCheckNoticesAnotherCoefficient) {
  SKIP_WITHOUT_MODULES();
  const softkin::testing::TemporaryFolder folder;
  std::string module = map_js_module(testing::arm_map());
  const std::string before = "\"coefficients\":\"";
  const std::size_t at = module.find(before) + before.size() + 9;  // in the first number's last bytes but one
  module[at] = module[at] == 'A' ? 'B' : 'A';
  const Reported reported = reported_by("node '" SOFTKIN_SOURCE_DIR "/tests/runs/exported_map.mjs'",
                                        folder.write("map.mjs", module), "[[1, 2, 3]]", folder);
  EXPECT_NE(reported["check"], "");
}

TEST(MapExportNumpy, AnswersAsTheMapDoes) {
  SKIP_WITHOUT_PYTHON("numpy");
  const std::string test_python = softkin::testing::shell_quoted(softkin::testing::test_python());
  for (const MapData& data : testing::small_maps()) {
    SCOPED_TRACE(data.name);
    const KinematicMap map(data);
    const softkin::testing::TemporaryFolder folder;
    const std::vector<Eigen::VectorXd> commands = testing::commands_of(map, false);
    const Reported reported =
        reported_by(test_python + " '" SOFTKIN_SOURCE_DIR "/tests/runs/exported_map.py'",
                    folder.write("map.npz", map_npz(data)), commands_text(commands, "NaN"), folder);
    compare_all(map, commands, reported["answers"], [](const auto&...) {});
    EXPECT_EQ(reported["names"]["robot"], (std::vector<std::string>{data.name, data.robot}));
    EXPECT_EQ(reported["names"]["inputs"][0], data.inputs[0].name);
    EXPECT_EQ(reported["names"]["output_units"][0], "mm");
    EXPECT_EQ(reported["checked"], (std::vector<int>{200, 0}));
  }
}

TEST(MapExportNumpy, IsAnArchiveThatOthersFindSound) {
  SKIP_WITHOUT_PYTHON("sys");
  const softkin::testing::TemporaryFolder folder;
  const std::string file = folder.write("map.npz", map_npz(testing::cable_map()));
  const auto run = softkin::testing::run_shell(
      softkin::testing::shell_quoted(softkin::testing::test_python()) +
      " -c 'import sys, zipfile; z = zipfile.ZipFile(sys.argv[1]); print(z.testzip(), len(z.namelist()))' '" + file +
      "' 2>&1");
  EXPECT_EQ(run.output.substr(0, 5), "None ") << run.output;
}

}  // namespace
}  // namespace softkin::runs
