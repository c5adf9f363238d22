#include <gtest/gtest.h>

#include <sstream>

#include "cli/fk_samples.hpp"
#include "cli/start_program.hpp"
#include "served_robot.hpp"

namespace softkin::view {
namespace {

using namespace softkin::testing;
using testing::LiveClient;

/// softkin view of the block, once it serves.
class Viewed {
 public:
  explicit Viewed(const std::vector<std::string>& options = {}, bool terminal = false)
      : folder(physical_scene()), program_(folder, arguments(folder, options), terminal) {
    const bool serves = program_.wait_until([&] { return read_text(folder / "stdout.txt").find("Ctrl-C") != npos; });
    const std::string output = read_text(folder / "stdout.txt"), begin = "view: http://127.0.0.1:";
    const std::size_t at = output.find(begin), mark = output.find("/#", at);
    if (!serves || at == npos || mark == npos) throw std::runtime_error("it does not serve: " + output);
    port = std::stoi(output.substr(at + begin.size()));
    secret = output.substr(mark + 2, output.find('\n', mark) - mark - 2);
  }

  /// Its end after a signal, and the seconds until then.
  std::pair<ProgramResult, double> end(int signal_number) {
    const auto begin = std::chrono::steady_clock::now();
    program_.send(signal_number);
    ProgramResult result = program_.wait();
    return {result, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
  }

  BlockFolder folder;
  int port = 0;
  std::string secret;

 private:
  static constexpr std::size_t npos = std::string::npos;

  static std::vector<std::string> arguments(const BlockFolder& folder, const std::vector<std::string>& options) {
    std::vector<std::string> all{"view", folder.scene, "--no-open", "--threads", "1"};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }

  StartedProgram program_;
};

TEST(ViewCommand, RefusesWhatCannotBe) {
  const BlockFolder folder(physical_scene());
  const auto refuses = [&](const std::vector<std::string>& options, const std::string& why) {
    std::vector<std::string> arguments{"view", folder.scene, "--no-open"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 2) << why;
    EXPECT_EQ(result.output, "") << why;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.errors.find(why), std::string::npos) << result.errors;
  };
  refuses({"--port", "65536"}, "must be an integer from 0 to 65535");
  refuses({"--anderson", "3"}, "it needs --solver local-global");
  for (const char* option : {"--deviation", "--deviation-volume", "--fade", "--readings-port"})
    refuses({option, "1"}, std::string(option) + ": it needs --unknown");
  refuses({"--keep-all"}, "--keep-all: it needs --unknown");
  refuses({"--unknown", "air", "--make-map"}, "--make-map: --unknown is estimated by the solver alone");
  refuses({"--unknown", "air:", "--deviation", "1"}, "what comes after the colon can only be 'place'");
  refuses({"--unknown", "air", "--deviation", "0"}, "--deviation: must be a number > 0 in mm, not 0");
  if (!runs::page_is_there()) return refuses({}, "this softkin was built without its page");
  refuses({"--unknown", "air"}, "what is read needs its deviation: --deviation in mm (coordinate), --deviation-press");
  refuses({"--unknown", "wind", "--deviation", "1"}, "--unknown 'wind': the scene has no command of that name");
  refuses({"--map", folder / "none.skmap"}, "none.skmap");
  refuses({"--map", folder / "none.skmap", "--make-map"}, "--make-map: --map gives one");
  const LiveServer other(0);
  refuses({"--port", std::to_string(other.port())}, "--port " + std::to_string(other.port()) + ": cannot listen");
  refuses({"--unknown", "air", "--deviation", "1", "--readings-port", std::to_string(other.port())},
          "--readings-port " + std::to_string(other.port()) + ": cannot listen");
}

TEST(ViewCommand, BendsTheRobotAsFkDoes) {
  if (!runs::page_is_there()) GTEST_SKIP() << "built without the page";
  Viewed viewed;
  EXPECT_EQ(viewed.secret.size(), 32u);
  const std::string page =
      testing::answer_to(viewed.port, "GET / HTTP/1.1\r\nHost: " + testing::host_of(viewed.port) + "\r\n\r\n");
  EXPECT_NE(page.find("\"live\":{\"path\":\"/live\",\"model\":\""), std::string::npos);
  EXPECT_EQ(page.find(viewed.secret), std::string::npos);
  LiveClient client(viewed.port);
  client.hello(viewed.secret);
  const nlohmann::json state = client.next("state");
  EXPECT_EQ(state.at("control"), true);
  EXPECT_NE(page.find("\"model\":\"" + state.at("model").get<std::string>() + "\""), std::string::npos);
  client.command(1, {1.4, 0.97});
  const auto shape = client.shape(1);
  ASSERT_TRUE(shape.has_value());
  const BlockFolder& folder = viewed.folder;
  ASSERT_EQ(run_fk(folder.scene, {"--set", "air=1.4", "--set", "tendon=0.97", "--report", folder / "r.json"}).exit_code,
            0);
  const auto step = nlohmann::json::parse(read_text(folder / "r.json")).at("steps").at(0);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(shape->head.at("markers").at(0).at(axis).get<double>(),
                step.at("markers").at("tip").at(axis).get<double>(), 1e-6);
  EXPECT_NEAR(shape->head.at("loads").at(0).get<double>(),
              step.at("actuators").at("air").at("pressure_kPa").get<double>(), 1e-4);
  const auto [result, seconds] = viewed.end(SIGINT);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  EXPECT_LT(seconds, patient(1));
  EXPECT_EQ(client.close_code(), 1001);
}

/// Rows of a table with gaps, as lines of JSON.
std::vector<std::string> lines_of_table(const std::string& file) {
  std::istringstream table(read_text(file));
  std::vector<std::string> names, lines;
  for (std::string row; std::getline(table, row);) {
    std::vector<std::string> cells;
    std::istringstream stream(row);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      continue;
    }
    nlohmann::json line;
    for (std::size_t c = 0; c < cells.size(); ++c)
      line[names[c]] = cells[c].empty() ? nlohmann::json() : nlohmann::json(std::stod(cells[c]));
    lines.push_back(line.dump());
  }
  return lines;
}

/// Readings from a stream give the same estimates as softkin estimate.
TEST(ViewCommand, TellsWhatIsStreamedAsEstimateDoes) {
  if (!runs::page_is_there()) GTEST_SKIP() << "built without the page";
  const std::string examples = std::string(SOFTKIN_SOURCE_DIR) + "/examples/estimate/";
  const std::string scene = examples + "finger.yaml", readings = examples + "readings.csv";
  const std::vector<std::string> requested{"--unknown", "touch:place", "--deviation", "0.2", "--threads", "1"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), requested.begin(), requested.end());
    return words;
  };
  const TemporaryFolder folder;
  StartedProgram program(folder, with({"view", scene, "--no-open", "--readings-port", "0"}));
  std::string output;
  ASSERT_TRUE(program.wait_until([&] {
    output = read_text(folder / "stdout.txt");
    return output.find("Ctrl-C") != std::string::npos;
  }));
  const std::string begin = "readings: JSON lines at 127.0.0.1:", first = ", the first ";
  const std::size_t at = output.find(begin), token = output.find(first, at);
  ASSERT_NE(token, std::string::npos) << output;
  testing::PlainSocket writer(std::stoi(output.substr(at + begin.size())));
  const std::size_t end = output.find('\n', token);
  writer.send(output.substr(token + first.size(), end + 1 - token - first.size()));
  const ProgramResult estimated = run_program(with({"estimate", scene, readings, "--json"}));
  ASSERT_EQ(estimated.exit_code, 0) << estimated.errors;
  const auto rows = nlohmann::json::parse(estimated.output).at("rows");
  const std::vector<std::string> lines = lines_of_table(readings);
  for (std::size_t r = 0; r < 3; ++r) {
    writer.send(lines.at(r) + "\n");
    const auto answer = nlohmann::json::parse(writer.take_until("\n", patient(20)).value_or("null"));
    ASSERT_EQ(answer.at("status"), "converged") << answer;
    EXPECT_EQ(answer.at("t_s"), rows[r].at("t_s"));
    EXPECT_EQ(answer.at("words"), rows[r].at("words"));
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& number = rows[r].at("numbers").at(n);
      EXPECT_NEAR(answer.at("numbers").at(n).at("value").get<double>(), number.at("value").get<double>(),
                  number.at("deviation").get<double>() / 100);
    }
  }
  writer.send("{\"m1_x_mm\": }\n");
  EXPECT_NE(writer.take_until("\n").value_or("").find("\"error\""), std::string::npos);
  program.send(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 0);
  EXPECT_EQ(writer.take_rest(), "");
}

/// Its commands lead where fk leads.
TEST(ViewCommand, MakesAMapMeanwhile) {
  if (!runs::page_is_there()) GTEST_SKIP() << "built without the page";
  Viewed viewed({"--make-map"}, true);
  LiveClient client(viewed.port);
  client.hello(viewed.secret);
  nlohmann::json map;
  for (int tries = 0; tries < 12 && map.is_null(); ++tries) map = client.next("map");  // 5 s each
  ASSERT_FALSE(map.is_null());
  EXPECT_EQ(map.at("map").at("inputs").size(), 2u);
  EXPECT_GT(map.at("map").at("checked").at("points").get<int>(), 0);
  EXPECT_TRUE(map.at("map").contains("shapeTables"));
  const auto [result, seconds] = viewed.end(SIGINT);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.errors.find(" shapes solved; Ctrl-C ends"), std::string::npos) << result.errors;
}

TEST(ViewCommand, EndsAtOnceWhateverIsUnderWay) {
  if (!runs::page_is_there()) GTEST_SKIP() << "built without the page";
  Viewed viewed({}, true);
  LiveClient client(viewed.port), mute(viewed.port, 4096);
  const testing::PlainSocket silent(viewed.port);
  client.hello(viewed.secret);
  client.next("state");
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  client.target(1, 0, {500, 500, 500});
  const auto [result, seconds] = viewed.end(SIGTERM);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_LT(seconds, patient(1));
  EXPECT_NE(result.errors.find("0 pages watch, one has control; Ctrl-C ends"), std::string::npos) << result.errors;
}

TEST(ViewCommand, ServersOfTheSameSceneAreTold) {
  if (!runs::page_is_there()) GTEST_SKIP() << "built without the page";
  const auto model_of = [](const std::vector<std::string>& options) {
    const Viewed viewed(options);
    LiveClient client(viewed.port);
    client.hello("");
    return client.next("state").at("model").get<std::string>();
  };
  const std::string first = model_of({});
  EXPECT_EQ(model_of({}), first);
  EXPECT_NE(model_of({"--force", "payload=0,0,0.1"}), first);
  EXPECT_NE(model_of({"--solver-tolerance", "1e-3"}), first);
}

}  // namespace
}  // namespace softkin::view
