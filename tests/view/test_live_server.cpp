#include <gtest/gtest.h>

#include <softkin/core/error.hpp>

#include "served_robot.hpp"

namespace softkin::view {
namespace {

using namespace testing;
using Clock = std::chrono::steady_clock;

const Model& some_model() {
  static const Model model = runs::testing::bending_model();
  return model;
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

bool is_status(const std::string& answer, int status) {
  return answer.find("HTTP/1.1 " + std::to_string(status) + " ") == 0;
}

/// Waits until something holds, 5 s at most, more where all is slow.
template <class Holds>
bool comes_true(const Holds& holds) {
  for (const auto begin = Clock::now(); seconds_since(begin) < patient(5);) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

TEST(LiveServer, ServesThePage) {
  const Served served(some_model());
  const std::string host = host_of(served.port()), port = std::to_string(served.port());
  const std::string answer = answer_to(served.port(), "GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  ASSERT_TRUE(is_status(answer, 200)) << answer;
  const std::size_t end = answer.find("\r\n\r\n");
  const std::string head = answer.substr(0, end + 2), html = answer.substr(end + 4);
  const std::string policy =
      "default-src 'none'; script-src 'sha256-abc='; base-uri 'none'; connect-src 'self' "
      "ws://127.0.0.1:" +
      port + " ws://localhost:" + port;
  for (const std::string& line :
       {"Content-Security-Policy: " + policy + "; frame-ancestors 'self' http://127.0.0.1:* http://localhost:*",
        std::string("X-Content-Type-Options: nosniff"), std::string("Referrer-Policy: no-referrer"),
        std::string("Cache-Control: no-store"), std::string("Cross-Origin-Resource-Policy: same-origin"),
        std::string("Content-Type: text/html; charset=utf-8"), "Content-Length: " + std::to_string(html.size())})
    EXPECT_NE(head.find("\r\n" + line + "\r\n"), std::string::npos) << line << " is not in " << head;
  EXPECT_EQ(head.find("Access-Control"), std::string::npos);
  EXPECT_NE(html.find("content=\"" + policy + "\""), std::string::npos);
  EXPECT_NE(html.find(R"("live":{"path":"/live","model":"00ff"})"), std::string::npos);
  EXPECT_EQ(html.find(secret), std::string::npos);
}

TEST(LiveServer, RefusesOtherRequests) {
  const Served served(some_model());
  const int port = served.port();
  const std::string host = host_of(port);
  const auto get = [&](const std::string& line, const std::string& of, const std::string& more = "") {
    return answer_to(port, line + " HTTP/1.1\r\nHost: " + of + "\r\n" + more + "\r\n");
  };
  EXPECT_TRUE(is_status(get("GET /", "localhost:" + std::to_string(port)), 200));
  EXPECT_TRUE(is_status(get("GET /", "evil.com"), 403));
  EXPECT_TRUE(is_status(get("GET /", "evil.com:" + std::to_string(port)), 403));
  EXPECT_TRUE(is_status(get("GET /", host, "Host: evil.com\r\n"), 403));
  EXPECT_TRUE(is_status(answer_to(port, "GET / HTTP/1.0\r\n\r\n"), 403));
  EXPECT_TRUE(is_status(get("GET /secret", host), 404));
  EXPECT_TRUE(is_status(get("GET /../etc/passwd", host), 404));
  const std::string post = get("POST /", host, "Content-Length: 0\r\n");
  EXPECT_TRUE(is_status(post, 405)) << post;
  EXPECT_NE(post.find("Allow: GET\r\n"), std::string::npos);
  EXPECT_TRUE(is_status(get("OPTIONS /", host), 405));
  for (const std::string& junk :
       {std::string("\r\n\r\nabc\r\n\r\n"), std::string("\x16\x03\x01\x02 junk\r\n\r\n"),
        "GET / HTTP/1.1\r\nHost: " + std::string(20000, 'a') + "\r\n\r\n",
        std::string("GET / HTTP/1.1\r\nContent-Length: -5\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost: ") + host + "\r\nContent-Length: 5\r\n\r\nabcde"}) {
    const std::string answer = answer_to(port, junk);
    EXPECT_TRUE(answer.empty() || is_status(answer, 400)) << answer;
  }
  EXPECT_TRUE(is_status(get("GET /", host), 200));
}

TEST(LiveServer, SocketsAreForItsOwnPages) {
  const Served served(some_model());
  const int port = served.port();
  const auto upgrade = [&](const std::string& host, const std::string& more) {
    return answer_to(port, "GET /live HTTP/1.1\r\nHost: " + host + "\r\n" + more +
                               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  };
  const std::string own = "Origin: http://" + host_of(port) + "\r\n";
  EXPECT_TRUE(is_status(upgrade(host_of(port), ""), 403));
  EXPECT_TRUE(is_status(upgrade(host_of(port), "Origin: http://evil.com\r\n"), 403));
  EXPECT_TRUE(is_status(upgrade(host_of(port), "Origin: null\r\n"), 403));
  EXPECT_TRUE(is_status(upgrade(host_of(port), own + "Origin: http://evil.com\r\n"), 403));
  EXPECT_TRUE(is_status(upgrade("localhost:" + std::to_string(port), own), 403));
  EXPECT_TRUE(is_status(upgrade("evil.com:" + std::to_string(port), own), 403));
  EXPECT_TRUE(is_status(answer_to(port, "GET /live HTTP/1.1\r\nHost: " + host_of(port) + "\r\n" + own + "\r\n"), 404));
  EXPECT_NO_THROW(LiveClient{port});
}

TEST(LiveServer, WithoutTheSecretOneWatches) {
  const Served served(some_model());
  for (const std::string& with : {std::string(), std::string("0123456789abcdef0123456789abcdee"), std::string("x")}) {
    LiveClient client = served.client(with);
    const nlohmann::json state = client.next("state");
    EXPECT_EQ(state, nlohmann::json::parse(R"({"type":"state","model":"00ff","secret":false,"control":false,"free":true,
                                               "streamed":false,"watchers":1})"));
    client.command(1, {1, 1});
    EXPECT_EQ(client.next("refused").at("id"), 1);
    client.say(nlohmann::json{{"type", "take"}});
    EXPECT_TRUE(client.next("refused").at("id").is_null());
    client.say(nlohmann::json{{"type", "release"}});
    EXPECT_FALSE(client.next("refused").is_null());
    for (int i = 4; i < 20; ++i) client.send("{}");
    EXPECT_EQ(client.close_code(0.3), 0) << "19 refusals are borne";
    client.send("{}");
    EXPECT_EQ(client.close_code(), 1008);
    EXPECT_TRUE(comes_true([&] {
      LiveClient other = served.client("");
      return other.next("state").at("watchers") == 1;
    }));
  }
  EXPECT_TRUE(served.requested().empty());
}

TEST(LiveServer, ControlGoesFromHandToHand) {
  const Served served(some_model());
  LiveClient first = served.client();
  EXPECT_EQ(first.next("state"), nlohmann::json::parse(R"({"type":"state","model":"00ff","secret":true,"control":true,
                                                           "free":false,"streamed":false,"watchers":0})"));
  LiveClient second = served.client();
  nlohmann::json state = second.next("state");
  EXPECT_EQ(state.at("control"), false);
  EXPECT_EQ(state.at("secret"), true);
  EXPECT_EQ(state.at("free"), false);
  EXPECT_TRUE(first.comes_to([](const auto& s) { return s.at("watchers") == 1; }));
  second.command(1, {1, 1});
  EXPECT_EQ(second.next("refused").at("id"), 1);

  second.say(nlohmann::json{{"type", "take"}});
  EXPECT_TRUE(second.comes_to([](const auto& s) { return s.at("control") == true; }));
  EXPECT_TRUE(first.comes_to([](const auto& s) { return s.at("control") == false && s.at("free") == false; }));
  first.command(1, {1, 1});
  EXPECT_EQ(first.next("refused").at("id"), 1);
  second.command(2, {1, 1});
  ASSERT_TRUE(comes_true([&] { return served.requested().size() == 1; }));

  second.say(nlohmann::json{{"type", "release"}});
  EXPECT_TRUE(first.comes_to([](const auto& s) { return s.at("free") == true; }));
  second.command(3, {1, 1});
  EXPECT_EQ(second.next("refused").at("id"), 3);
  first.say(nlohmann::json{{"type", "take"}});
  EXPECT_TRUE(first.comes_to([](const auto& s) { return s.at("control") == true; }));
  { const LiveClient gone = std::move(first); }
  EXPECT_TRUE(second.comes_to([](const auto& s) { return s.at("free") == true && s.at("watchers") == 1; }));
  LiveClient third = served.client();  // nobody has it
  EXPECT_TRUE(third.comes_to([](const auto& s) { return s.at("control") == true; }));
  EXPECT_EQ(served.requested().size(), 1u);
}

TEST(LiveServer, AnswersAreNumberedForWhoAsked) {
  Served served(some_model());
  LiveClient first = served.client(), watcher = served.client("");
  first.next("state");
  watcher.next("state");
  first.command(7, {1, 1});
  ASSERT_TRUE(comes_true([&] { return served.requested().size() == 1; }));
  const std::uint64_t asker = served.requested()[0].asker;
  served.server.show(made_up_shape(7, 10, asker));
  EXPECT_EQ(first.shape()->head.at("id"), 7);
  EXPECT_EQ(watcher.shape()->head.at("commands").at(0), 7);
  // an answer to a request from before a change of control carries no request id
  LiveClient second = served.client();
  EXPECT_EQ(second.shape()->head.at("id"), 0);
  second.say(nlohmann::json{{"type", "take"}});
  EXPECT_TRUE(second.comes_to([](const auto& s) { return s.at("control") == true; }));
  served.server.show(made_up_shape(8, 10, asker));
  EXPECT_EQ(second.shape()->head.at("id"), 0);
}

TEST(LiveServer, RefusesWhatIsNoMessage) {
  const Served served(some_model());
  const auto closed_by = [&](const std::string& bytes, int opcode, bool last = true) {
    LiveClient client = served.client();
    client.next("state");
    client.send(bytes, opcode, last);
    return client.close_code();
  };
  EXPECT_EQ(closed_by("{}", binary), 1003);
  EXPECT_EQ(closed_by(std::string(4097, ' '), text), 1009);
  EXPECT_EQ(closed_by(std::string(70000, ' '), text), 1009);
  EXPECT_EQ(closed_by("\xff", text), 1007);
  EXPECT_EQ(closed_by("abc", continued), 1002);
  EXPECT_EQ(closed_by("abc", 3), 1002);
  LiveClient client(served.port());
  client.send("{}");
  EXPECT_FALSE(client.next("refused").is_null());
  client.command(1, {1, 1});
  EXPECT_EQ(client.next("refused").at("why"), "hello comes first");
  client.hello(secret);
  EXPECT_EQ(client.next("state").at("control"), true);
  client.hello(secret);
  EXPECT_EQ(client.next("refused").at("why"), "hello was said already");
  for (const std::string& commands : {std::string("[NaN,1]"), std::string("[1e999,1]"), std::string("[4,1]"),
                                      std::string("[1]"), std::string("[1,1,1]")}) {
    client.send(R"({"type":"command","id":5,"commands":)" + commands + "}");
    EXPECT_FALSE(client.next("refused").is_null()) << commands;
  }
  EXPECT_TRUE(served.requested().empty());
  client.command(5, {1, 1});
  client.command(5, {1, 1});
  EXPECT_EQ(client.next("refused").at("id"), 5) << "numbers grow";
  client.target(6, 1, {1, 2, 3});
  EXPECT_TRUE(comes_true([&] { return served.requested().size() == 2; }));
  const auto target = std::get<TargetRequest>(served.requested()[1].what);
  EXPECT_EQ(target.marker, 1);
  EXPECT_EQ(target.at, Vec3(1, 2, 3));
}

TEST(LiveServer, MessagesInPiecesAreOneAndTooManyEndIt) {
  const Served served(some_model());
  LiveClient client = served.client();
  client.next("state");
  client.send("{\"type\":\"comm", text, false);
  client.send("and\",\"id\":1,\"commands\":[1,1]}", continued, true);
  EXPECT_TRUE(comes_true([&] { return served.requested().size() == 1; }));
  for (int id = 2; id < 52; ++id) client.command(static_cast<std::uint64_t>(id), {1, 1});
  EXPECT_TRUE(comes_true([&] { return served.requested().size() == 51; })) << "50 at once are borne";
  for (int id = 52; id < 500; ++id) client.command(static_cast<std::uint64_t>(id), {1, 1});
  EXPECT_EQ(client.close_code(), 1008);
  EXPECT_LT(served.requested().size(), 300u);
  LiveClient pinging = served.client();
  for (int i = 0; i < 500; ++i) pinging.send("", ping);
  EXPECT_EQ(pinging.close_code(), 1008);
}

TEST(LiveServer, SlowReadersDelayNobody) {
  Served served(some_model());
  LiveClient control = served.client();
  control.next("state");
  LiveClient slow = served.client("", 4096);
  slow.next("state");
  constexpr RequestId shapes = 60;
  double slowest = 0;
  for (RequestId id = 1; id <= shapes; ++id) {
    const auto begin = Clock::now();
    served.server.show(made_up_shape(id, 40000));
    ASSERT_TRUE(control.shape(static_cast<std::int64_t>(id)).has_value()) << id;
    slowest = std::max(slowest, seconds_since(begin));
  }
  EXPECT_LT(slowest, patient(1));
  // the shape in transmission, those in the sockets' buffers, and the newest
  std::vector<int> seen;
  while (seen.empty() || seen.back() < static_cast<int>(shapes)) {
    const auto frame = slow.shape();
    ASSERT_TRUE(frame.has_value());
    seen.push_back(static_cast<int>(frame->head.at("commands").at(0)));
    ASSERT_EQ(frame->numbers.size(), 120000u);
  }
  EXPECT_LT(seen.size(), 30u);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
}

TEST(LiveServer, EndsWhatDoesNotComeOn) {
  LiveLimits limits;
  limits.head_s = patient(0.4);
  limits.stalled_s = patient(0.5);
  limits.idle_s = patient(1);
  Served served(some_model(), limits);
  PlainSocket loris(served.port()), mute(served.port());
  loris.send("GET / HTTP/1.1\r\nHost: ");
  LiveClient without_hello(served.port());
  LiveClient silent = served.client(""), stalled = served.client("", 4096), answers = served.client();
  for (int i = 0; i < 10; ++i) served.server.show(made_up_shape(1, 200000));
  EXPECT_EQ(loris.take_rest(patient(2)), "");
  EXPECT_EQ(mute.take_rest(patient(2)), "");
  EXPECT_EQ(without_hello.close_code(patient(2)), 1008);
  // after twice the time that they may be silent; the stalled one is not silent
  for (const auto begin = Clock::now(); seconds_since(begin) < patient(2.5);) {
    (void)answers.receive(0.1);
    stalled.send("", pong);
  }
  answers.command(1, {1, 1});
  EXPECT_TRUE(comes_true([&] { return served.requested().size() == 1; }));
  EXPECT_TRUE(answers.say(nlohmann::json{{"type", "release"}}));
  EXPECT_TRUE(answers.comes_to([](const auto& s) { return s.at("free") == true && s.at("watchers") == 1; }));
}

TEST(LiveServer, HasRoomForSoMany) {
  LiveLimits limits;
  limits.connections = 3;
  const Served served(some_model(), limits);
  const std::string request = "GET / HTTP/1.1\r\nHost: " + host_of(served.port()) + "\r\n\r\n";
  std::vector<LiveClient> clients;
  for (int i = 0; i < 3; ++i) {
    clients.push_back(served.client(""));
    clients.back().next("state");
  }
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(is_status(answer_to(served.port(), request), 503));
  clients.pop_back();
  EXPECT_TRUE(comes_true([&] { return is_status(answer_to(served.port(), request), 200); }));
}

TEST(LiveServer, MapsReachAllWhoWatch) {
  Served served(some_model());
  LiveClient client = served.client(), watcher = served.client("");
  client.next("state");
  watcher.next("state");
  const std::string map = R"({"tables":")" + std::string(1'000'000, 'x') + R"("})";
  served.server.give_map(map);
  for (LiveClient* each : {&client, &watcher}) EXPECT_EQ(each->next("map").at("map").dump(), map);
  LiveClient late = served.client();
  EXPECT_EQ(late.next("map").at("map").dump(), map);
}

TEST(LiveServer, SaysThatItGoes) {
  auto served = std::make_unique<Served>(some_model());
  LiveClient client = served->client(), slow = served->client("", 4096);
  client.next("state");
  slow.next("state");
  PlainSocket mute(served->port());
  for (int i = 0; i < 10; ++i) served->server.show(made_up_shape(1, 200000));
  (void)client.shape();
  const auto begin = Clock::now();
  served->server.stop();
  EXPECT_EQ(client.close_code(), 1001);
  served.reset();
  EXPECT_LT(seconds_since(begin), patient(1));
}

TEST(LiveServer, TellsThatAPortIsBusy) {
  const Served served(some_model());
  try {
    const LiveServer other(served.port());
    FAIL() << "two servers at one port";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()),
              "--port " + std::to_string(served.port()) + ": cannot listen at 127.0.0.1: Address already in use");
  }
}

/// All of it together: robot, server and two pages.
TEST(LiveServer, BendsTheRobotForAll) {
  const Model model = runs::testing::bending_model();
  ServedRobot robot(model);
  LiveClient control = robot.served.client(), watcher = robot.served.client("");
  EXPECT_EQ(control.shape()->head.at("id"), 0);
  watcher.next("state");
  const std::vector<double> commands{1.4, 0.97};
  control.command(1, commands);
  const auto shape = control.shape(1);
  ASSERT_TRUE(shape.has_value());
  const Statics own(model);
  const Equilibrium wanted = own.solve(Eigen::Vector2d(1.4, 0.97), own.rest(), runs::testing::one_thread());
  for (std::size_t i = 0; i < robot.document.vertices().size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(shape->numbers.at(3 * i + axis), wanted.state.positions(robot.document.vertices()[i], axis), 2e-6);
  EXPECT_EQ(shape->head.at("commands"), nlohmann::json(commands));
  const auto seen = watcher.shape(1);
  ASSERT_TRUE(seen.has_value());
  EXPECT_EQ(seen->numbers, shape->numbers);
  control.target(2, 0, {100, 0, 0});
  const auto missed = control.shape(2);
  ASSERT_TRUE(missed.has_value());
  const nlohmann::json& target = missed->head.at("target");
  EXPECT_EQ(target.at("reached"), false);
  EXPECT_NEAR(target.at("error_mm").get<double>(),
              (Vec3(100, 0, 0) - Vec3(missed->head.at("markers").at(0).at(0), missed->head.at("markers").at(0).at(1),
                                      missed->head.at("markers").at(0).at(2)))
                  .norm(),
              1e-9);
  EXPECT_NE(target.at("why").get<std::string>().find(" end of its range, "), std::string::npos) << target;
  LiveClient late = robot.served.client("");
  EXPECT_EQ(late.shape()->numbers, missed->numbers);
}

}  // namespace
}  // namespace softkin::view
