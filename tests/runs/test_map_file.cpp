#include <gtest/gtest.h>

#include <filesystem>
#include <softkin/core/error.hpp>
#include <softkin/io/base64.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/runs/map_file.hpp>
#include <softkin/runs/map_journal.hpp>

#include "statics/physical_samples.hpp"
#include "support/patience.hpp"

namespace softkin::runs {
namespace {

namespace fs = std::filesystem;
using namespace softkin::testing;

RobotSpec mapped_robot() {
  RobotSpec spec = cable_beam();
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 0.9;
    actuator.high = 1.1;
  }
  return spec;
}

const MapData& a_map() {
  static const MapData data = [] {
    MapOptions options;
    options.checks = 5;
    return build_map(compile(mapped_robot()), options)->data;
  }();
  return data;
}

std::string refusal_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(MapFile, ReadsWhatWasWritten) {
  const std::string bytes = map_bytes(a_map());
  const MapData read = map_from_bytes(bytes, "a.skmap");
  EXPECT_EQ(map_bytes(read), bytes);
  const KinematicMap before(a_map()), after(read);
  const Eigen::Vector2d commands(0.93, 1.04);
  Eigen::VectorXd a(before.outputs()), b(after.outputs());
  const auto place = before.evaluate(commands.data(), a.data());
  ASSERT_TRUE(place);
  ASSERT_TRUE(after.evaluate(commands.data(), b.data()));
  EXPECT_EQ(a, b);
  EXPECT_EQ(before.shape(commands.data(), *place), after.shape(commands.data(), *place));
}

TEST(MapFile, RefusesWhatIsCutOffOrBroken) {
  const std::string bytes = map_bytes(a_map());
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{10}, bytes.find('\n') / 2, bytes.find('\n') + 9, bytes.size() - 300})
    EXPECT_NE(
        refusal_of([&] { (void)KinematicMap(map_from_bytes(bytes.substr(0, length), "cut.skmap")); }).find("cut.skmap"),
        std::string::npos)
        << length;
  std::string newer = bytes;
  newer.replace(newer.find(":1,"), 3, ":9,");
  EXPECT_NE(refusal_of([&] { (void)map_from_bytes(newer, "n.skmap"); }).find("newer softkin"), std::string::npos);
  std::string strange = bytes;
  const std::size_t type = strange.find("\"type\":\"f64\"");
  strange.replace(type, 12, "\"type\":\"f32\"");
  EXPECT_THROW((void)map_from_bytes(strange, "s.skmap"), InvalidInput);
}

/// Whatever byte of the header is another one: a map or a refusal, never a crash.
TEST(MapFile, SurvivesAnyByteOfTheHeader) {
  const std::string bytes = map_bytes(a_map());
  const std::size_t end = bytes.find('\n');
  int refused = 0;
  constexpr std::size_t kinds = softkin::testing::instrumented ? 1 : 4;
  for (std::size_t at = 0; at < end; ++at)
    for (std::size_t kind = at; kind < at + kinds; ++kind) {
      const char other = "09-}"[kind % 4];
      std::string changed = bytes;
      changed[at] = other;
      try {
        const KinematicMap map(map_from_bytes(changed, "x.skmap"));
        Eigen::VectorXd values(map.outputs());
        const Eigen::VectorXd commands = Eigen::VectorXd::Constant(map.inputs(), 1);
        (void)map.evaluate(commands.data(), values.data());
      } catch (const InvalidInput&) {
        ++refused;
      }
    }
  EXPECT_GT(refused, 100);
}

TEST(MapFile, IsOfItsRobotAlone) {
  EXPECT_EQ(refusal_of([] { check_robot(a_map(), compile(mapped_robot()), "a.skmap"); }), "");
  const auto refusal = [](const std::function<void(RobotSpec&)>& change) {
    RobotSpec spec = mapped_robot();
    change(spec);
    return refusal_of([&] { check_robot(a_map(), compile(spec), "a.skmap"); });
  };
  EXPECT_NE(refusal([](RobotSpec& s) { s.actuators[0].high = 1.2; }).find("the range of"), std::string::npos);
  EXPECT_NE(refusal([](RobotSpec& s) { s.materials[0].elastic->poisson_ratio = 0.31; }).find("materials"),
            std::string::npos);
  EXPECT_NE(refusal([](RobotSpec& s) { s.markers[0].name = "nose"; }), "");
  EXPECT_NE(refusal([](RobotSpec& s) { s.actuators[1].name = "other"; }), "");
}

TEST(MapFile, Base64IsThatOfTheStandard) {  // RFC 4648, section 10
  const std::vector<std::pair<std::string, std::string>> vectors{{"", ""},
                                                                 {"f", "Zg=="},
                                                                 {"fo", "Zm8="},
                                                                 {"foo", "Zm9v"},
                                                                 {"foob", "Zm9vYg=="},
                                                                 {"fooba", "Zm9vYmE="},
                                                                 {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) {
    EXPECT_EQ(to_base64(bytes), text);
    EXPECT_EQ(from_base64(text), bytes);
  }
  for (const char* wrong : {"Zg=", "Z===", "Zm9?", "Zg==Zg=="}) EXPECT_THROW((void)from_base64(wrong), InvalidInput);
}

TEST(MapFile, TextOfAMapThatWasNotCheckedClaimsNoErrors) {
  MapData data = a_map();
  EXPECT_NE(map_text(data).find("checked at 5 points, largest errors: markers "), std::string::npos);
  data.check.points = 0;
  data.check.outside = 10;
  data.check.largest.setZero();
  EXPECT_EQ(map_text(data).find("largest errors"), std::string::npos) << map_text(data);
  EXPECT_NE(map_text(data).find("none of 10 random actuations is inside the map"), std::string::npos);
}

}  // namespace
}  // namespace softkin::runs
