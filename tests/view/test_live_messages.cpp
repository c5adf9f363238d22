#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "live_client.hpp"
#include "runs/small_runs.hpp"
#include "view/live_messages.hpp"

namespace softkin::view {
namespace {

using MessageJson = nlohmann::json;

/// Why a message is refused; "" where it is not.
std::string refusal_of(const std::string& text, std::optional<RequestId>* id = nullptr) {
  static const Model model = runs::testing::bending_model();
  try {
    (void)read_client_message(text, model);
  } catch (const Refusal& refusal) {
    if (id != nullptr) *id = refusal.id();
    return refusal.what();
  }
  return "";
}

TEST(LiveMessages, AreRead) {
  const Model model = runs::testing::bending_model();  // air 0.5 to 3, tendon 0.5 to 1.2; markers tip, corner
  const auto read = [&](const std::string& text) { return read_client_message(text, model); };
  EXPECT_EQ(std::get<Hello>(read(R"({"type":"hello","secret":"ab\u00e9"})")).secret, "ab\xc3\xa9");
  const auto command = std::get<CommandRequest>(read(R"({"type":"command","id":7,"commands":[0.5,1.2]})"));
  EXPECT_EQ(command.id, 7u);
  EXPECT_EQ(command.commands, Eigen::Vector2d(0.5, 1.2));
  const auto target = std::get<TargetRequest>(
      read(R"({"id":9007199254740992,"marker":1,"at":[1,-2.5,1e2],"type":"target","more":[{}]})"));
  EXPECT_EQ(target.id, 9007199254740992u);
  EXPECT_EQ(target.marker, 1);
  EXPECT_EQ(target.at, Vec3(1, -2.5, 100));
  EXPECT_TRUE(std::holds_alternative<Take>(read(R"({"type":"take"})")));
  EXPECT_TRUE(std::holds_alternative<Release>(read(R"({"type":"release"})")));
}

TEST(LiveMessages, AreRefusedInASentence) {
  const std::pair<const char*, const char*> table[] = {
      {"", "this is no JSON"},
      {"null", "a message is a JSON object"},
      {"[]", "a message is a JSON object"},
      {"{", "this is no JSON"},
      {"{} {}", "this is no JSON"},
      {"\xff\xfe", "this is no JSON"},
      {R"({"type":"hello","secret":"\ud800"})", "this is no JSON"},
      {"{}", "type is missing"},
      {R"({"type":3})", "type must be text"},
      {R"({"type":"drop","id":3})", "there is no message of type 'drop'"},
      {R"({"type":"a\nb"})", "there is no message of type 'a?b'"},
      {R"({"type":"hello"})", "secret is missing"},
      {R"({"type":"hello","secret":7})", "secret must be text"},
      {R"({"type":"command","commands":[1,1]})", "id is missing"},
      {R"({"type":"command","id":0,"commands":[1,1]})", "id must be an integer from 1 to 2^53"},
      {R"({"type":"command","id":-1,"commands":[1,1]})", "id must be an integer"},
      {R"({"type":"command","id":1.5,"commands":[1,1]})", "id must be an integer"},
      {R"({"type":"command","id":"1","commands":[1,1]})", "id must be an integer"},
      {R"({"type":"command","id":9007199254740993,"commands":[1,1]})", "id must be an integer"},
      {R"({"type":"command","id":1})", "commands is missing"},
      {R"({"type":"command","id":1,"commands":{}})", "commands must be a list of 2 numbers, one per actuator"},
      {R"({"type":"command","id":1,"commands":[1]})", "commands must be a list of 2 numbers"},
      {R"({"type":"command","id":1,"commands":[1,1,1]})", "commands must be a list of 2 numbers"},
      {R"({"type":"command","id":1,"commands":[1,"1"]})", "commands must be a list of finite numbers"},
      {R"({"type":"command","id":1,"commands":[1,null]})", "commands must be a list of finite numbers"},
      {R"({"type":"command","id":1,"commands":[1,true]})", "commands must be a list of finite numbers"},
      {R"({"type":"command","id":1,"commands":[NaN,1]})", "this is no JSON"},
      {R"({"type":"command","id":1,"commands":[1,Infinity]})", "this is no JSON"},
      {R"({"type":"command","id":1,"commands":[1e999,1]})", "this is no JSON"},
      {R"({"type":"command","id":1,"commands":[3.01,1]})", "air: 3.01 is outside its range, 0.5 to 3 [-]"},
      {R"({"type":"command","id":1,"commands":[1,0.49]})", "tendon: 0.49 is outside its range, 0.5 to 1.2 [-]"},
      {R"({"type":"target","id":1,"at":[1,1,1]})", "marker is missing"},
      {R"({"type":"target","id":1,"marker":2,"at":[1,1,1]})", "marker must be an integer from 0 to 1"},
      {R"({"type":"target","id":1,"marker":-1,"at":[1,1,1]})", "marker must be an integer from 0 to 1"},
      {R"({"type":"target","id":1,"marker":0.5,"at":[1,1,1]})", "marker must be an integer from 0 to 1"},
      {R"({"type":"target","id":1,"marker":18446744073709551616,"at":[1,1,1]})", "marker must be an integer"},
      {R"({"type":"target","id":1,"marker":0})", "at is missing"},
      {R"({"type":"target","id":1,"marker":0,"at":[1,1]})", "at must be a list of 3 numbers"},
      {R"({"type":"target","id":1,"marker":0,"at":[1,1,1e308]})", "at is farther away than "},
      {R"({"type":"target","id":1,"marker":0,"at":[-1e4,1,1]})", "at is farther away than "}};
  for (const auto& [text, why] : table) {
    const std::string reported = refusal_of(text);
    EXPECT_EQ(reported.find(why), 0u) << text << ": " << reported;
  }
  EXPECT_EQ(refusal_of(R"({"type":"target","id":1,"marker":0,"at":[-1e3,1,1]})"), "");
}

TEST(LiveMessages, RefusalsNameTheRequest) {
  std::optional<RequestId> id;
  refusal_of(R"({"type":"command","id":12,"commands":[9,1]})", &id);
  EXPECT_EQ(id, 12u);
  refusal_of(R"({"type":"command","id":-12,"commands":[9,1]})", &id);
  EXPECT_EQ(id, std::nullopt);
  EXPECT_EQ(MessageJson::parse(refused_text(Refusal("no \"such\"", 3))),
            MessageJson::parse(R"({"type":"refused","id":3,"why":"no \"such\""})"));
  EXPECT_TRUE(MessageJson::parse(refused_text(Refusal("no"))).at("id").is_null());
}

TEST(LiveMessages, AreBounded) {
  const std::string shortest = R"({"type":"hello","secret":""})";
  const std::string fits(longest_message - shortest.size(), 'a');
  EXPECT_EQ(refusal_of(R"({"type":"hello","secret":")" + fits + "\"}"), "");
  EXPECT_EQ(refusal_of(R"({"type":"hello","secret":")" + fits + "a\"}"), "a message is at most 4096 bytes long");
  EXPECT_EQ(refusal_of(std::string(4096, '[')), "a message is a JSON object");
  EXPECT_EQ(refusal_of(R"({"type":)" + std::string(2000, '[') + std::string(2000, ']') + "}"),
            "a message is a JSON object");
  EXPECT_LT(refusal_of(R"({"type":")" + std::string(4000, 'x') + "\"}").size(), 100u);
}

TEST(LiveMessages, FramesReadBack) {
  LiveShape shape;
  shape.id = 7;
  shape.status = "limit";
  shape.remark = "beyond \"this\"\xff";
  shape.commands = Eigen::Vector2d(1.25, 1.0 / 3);
  shape.loads = {2.5, std::nullopt, std::numeric_limits<double>::quiet_NaN()};
  shape.measures = {std::nullopt, 0.75};
  shape.markers = {{1, 2, 3}, {4, 5, std::numeric_limits<double>::infinity()}};
  shape.iterations = 9;
  shape.seconds = 0.125;
  shape.target = TargetAnswer{1, {7, 8, 9}, 0.5, false, "why not"};
  shape.arrays = {"strain"};
  shape.vertices = 2;
  shape.numbers = {1, 2, 3, 4, 5, 6, 0.1f, -0.0f};
  for (const RequestId id : {RequestId{7}, RequestId{0}, RequestId{123456789}}) {
    const std::string bytes = frame_bytes(shape, id);
    const testing::LiveFrame frame(bytes);
    EXPECT_EQ(bytes.size() % 4, 0u);
    EXPECT_EQ(frame.numbers, shape.numbers);
    MessageJson wanted = MessageJson::parse(
        R"({"status":"limit","commands":[1.25,0.3333333333333333],"loads":[2.5,null,null],"measures":[null,0.75],
            "markers":[[1.0,2.0,3.0],[4.0,5.0,null]],"iterations":9,"seconds":0.125,"arrays":["strain"],"vertices":2,
            "target":{"marker":1,"at":[7.0,8.0,9.0],"error_mm":0.5,"reached":false,"why":"why not"}})");
    wanted["id"] = id;
    wanted["remark"] = "beyond \"this\"\xef\xbf\xbd";
    EXPECT_EQ(frame.head, wanted);
  }
  shape.target.reset();
  EXPECT_TRUE(testing::LiveFrame(frame_bytes(shape, 1)).head.at("target").is_null());
}

TEST(LiveMessages, StatesAreTold) {
  EXPECT_EQ(MessageJson::parse(state_text({"00ff", true, false, true, true, 3})),
            MessageJson::parse(R"({"type":"state","model":"00ff","secret":true,"control":false,"free":true,
                                   "streamed":true,"watchers":3})"));
}

TEST(LiveMessages, SecretsAreTheSameOrNot) {
  EXPECT_TRUE(same_secret("abc", "abc"));
  for (const char* other : {"", "ab", "abd", "abcd", "Abc"}) EXPECT_FALSE(same_secret(other, "abc")) << other;
  EXPECT_FALSE(same_secret(std::string_view("abc\0", 4), "abc"));
  EXPECT_FALSE(same_secret("abc", std::string_view("abc\0", 4)));
}

}  // namespace
}  // namespace softkin::view
