#include <gtest/gtest.h>

#include "reported_robot.hpp"

namespace softkin::view {
namespace {

using namespace testing;

/// A stream without a robot, which records its requests.
class Streamed {
 public:
  explicit Streamed(const StreamLimits& limits = {}, double fade_s = 0) : stream(0, limits) {
    stream.begin(
        {model_, pushed_setup(model_).columns, {1, 2}, fade_s > 0}, secret,
        [this](const LiveRequest& request) { requested_.push_back(request); },
        [this](bool lent) { lent_ += lent ? "+" : "-"; });
  }
  ~Streamed() { stream.stop(); }

  /// A connection that has shown its token.
  [[nodiscard]] PlainSocket writer(const std::string& token = secret) const {
    PlainSocket socket(stream.port());
    socket.send(R"({"token": ")" + token + "\"}\n");
    return socket;
  }
  /// An answer to a request.
  void answer(const LiveRequest& request) {
    LiveAnswer answer{request.asker, {}};
    answer.shape.id = std::get<ReadingsRequest>(request.what).id;
    answer.shape.estimate = R"({"status":"converged","chi_square":3,"readings":[1],"forces":[2]})";
    stream.answer(std::make_shared<const LiveAnswer>(std::move(answer)));
  }
  /// Returns all requests and loans of control, once the stream has ended.
  [[nodiscard]] const std::vector<LiveRequest>& requested() {
    stream.stop();
    return requested_;
  }
  [[nodiscard]] const std::string& lent() {
    stream.stop();
    return lent_;
  }

  ReadingStream stream;

 private:
  const Model model_ = pushed_model();
  std::vector<LiveRequest> requested_;
  std::string lent_;
};

nlohmann::json line_of(PlainSocket& socket) {
  const auto line = socket.take_until("\n");
  return line ? nlohmann::json::parse(*line) : nlohmann::json();
}

std::string error_of(PlainSocket& socket) {
  return line_of(socket).value("error", "no error");
}

TEST(ReadingStream, LetsInWhoHasTheTokenAndOneAtATime) {
  Streamed streamed;
  {
    PlainSocket wrong = streamed.writer("0123456789abcdef0123456789abcdee");
    EXPECT_EQ(error_of(wrong), "this is not the token that softkin printed");
    EXPECT_EQ(wrong.take_rest(), "");
    PlainSocket early(streamed.stream.port());
    early.send("{\"tip_x_mm\": 12}\n");
    EXPECT_EQ(error_of(early).find("the first line must be {\"token\""), 0u);
    EXPECT_EQ(early.take_rest(), "");
  }
  PlainSocket first = streamed.writer();
  first.send("{\"tip_x_mm\": \"\"}\n");  // is answered once it is let in
  EXPECT_EQ(error_of(first), "tip_x_mm must be a finite number");
  PlainSocket second = streamed.writer();
  EXPECT_EQ(error_of(second), "another one streams readings");
  EXPECT_EQ(second.take_rest(), "");
  first.send("{\"tip_x_mm\": 12}\n{\"tip_x_mm\": []}\n");
  EXPECT_EQ(error_of(first), "tip_x_mm must be a finite number");
  { const PlainSocket gone = std::move(first); }
  streamed.answer({(std::uint64_t{1} << 63) + 1, ReadingsRequest{1, {}, {}}});  // which is not waited for any more
  bool is_let_in = false;
  for (int tries = 0; tries < 50 && !is_let_in; ++tries) {  // until the end of the first connection is detected
    PlainSocket next = streamed.writer();
    next.send("{\"tip_x_mm\": 13}\n{\"a\": 1}\n");
    is_let_in = error_of(next).find("there is no column") == 0;
  }
  EXPECT_EQ(streamed.lent(), "+-+-");
  ASSERT_EQ(streamed.requested().size(), 2u);
  EXPECT_NE(streamed.requested()[0].asker, streamed.requested()[1].asker);
  EXPECT_GE(streamed.requested()[0].asker, std::uint64_t{1} << 63);
}

TEST(ReadingStream, MalformedLinesAreToldAndTooManyEndIt) {
  StreamLimits limits;
  limits.refusals = 4;
  Streamed streamed(limits);
  PlainSocket writer = streamed.writer();
  for (const auto& [line, why] : {std::pair{"{\"tip_x_mm\": NaN}", "this is no JSON"},
                                  {"{\"top_x_mm\": 1}", "there is no column 'top_x_mm'; did you mean 'tip_x_mm'?"},
                                  {"{\"tip_x_mm\": 1e300}", "tip_x_mm is larger than 1e+09"}}) {
    writer.send(std::string(line) + "\r\n");
    EXPECT_EQ(error_of(writer).find(why), 0u) << line;
  }
  writer.send("[]\n");
  EXPECT_EQ(error_of(writer), "a line is a JSON object");
  EXPECT_EQ(writer.take_rest(), "");
}

TEST(ReadingStream, EndsLinesThatAreTooLongOrTooMany) {
  {
    Streamed streamed;
    PlainSocket writer = streamed.writer();
    writer.send(std::string(longest_line + 100, ' '));
    EXPECT_EQ(error_of(writer), "a line is at most 65536 bytes long");
    EXPECT_EQ(writer.take_rest(), "");
  }
  StreamLimits limits;
  limits.lines_at_once = 10;
  limits.lines_per_second = 1;
  Streamed streamed(limits);
  PlainSocket writer = streamed.writer();
  for (int i = 0; i < 12; ++i) writer.send("{\"tip_x_mm\": 12}\n");
  EXPECT_EQ(error_of(writer), "too many lines in a short time");
  EXPECT_EQ(streamed.requested().size(), 9u);
}

TEST(ReadingStream, SilentOnesMustShowTheirToken) {
  StreamLimits limits;
  limits.head_s = 0.1;
  Streamed streamed(limits);
  PlainSocket silent(streamed.stream.port());
  EXPECT_EQ(error_of(silent), "no token came");
  EXPECT_EQ(silent.take_rest(), "");
  EXPECT_EQ(streamed.lent(), "");
}

/// The answer reports the newest line that was requested, and how many lines were passed over since the one before.
TEST(ReadingStream, TellsWhatWasPassedOver) {
  Streamed streamed;
  PlainSocket writer = streamed.writer();
  for (int i = 1; i <= 5; ++i) writer.send("{\"t_s\": " + std::to_string(i) + ", \"tip_x_mm\": 12}\n");
  writer.send("{\"t_s\": 5, \"tip_x_mm\": 12}\n");
  EXPECT_EQ(error_of(writer), "t_s must increase from line to line");
  const auto request = [](RequestId id) {
    return LiveRequest{(std::uint64_t{1} << 63) + 1, ReadingsRequest{id, {}, {}}};
  };
  streamed.answer({7, ReadingsRequest{1, {}, {}}});  // of a page
  streamed.answer(request(1));
  const nlohmann::json first = line_of(writer);
  EXPECT_EQ(first.at("t_s"), 1);
  EXPECT_EQ(first.at("passed_over"), 0);
  EXPECT_EQ(first.at("status"), "converged");
  EXPECT_FALSE(first.contains("forces") || first.contains("readings"));
  streamed.answer(request(5));
  const nlohmann::json last = line_of(writer);
  EXPECT_EQ(last.at("t_s"), 5);
  EXPECT_EQ(last.at("passed_over"), 3);
  // after the end of sending, the last request is still answered
  writer.send("{\"t_s\": 6, \"tip_x_mm\": 12}");  // its last line may lack its end
  writer.end_sending();
  EXPECT_EQ(writer.take(1, 0.1), std::nullopt);
  EXPECT_FALSE(writer.is_closed());
  streamed.answer(request(6));
  EXPECT_EQ(line_of(writer).at("t_s"), 6);
  EXPECT_EQ(writer.take_rest(), "");
  EXPECT_EQ(streamed.lent(), "+-");
  ASSERT_EQ(streamed.requested().size(), 6u);
  EXPECT_EQ(streamed.requested()[4].asker, request(5).asker);
  EXPECT_EQ(std::get<ReadingsRequest>(streamed.requested()[4].what).id, 5u);
}

/// A robot that is estimated from a stream, and its pages.
struct ReportedRobot {
  explicit ReportedRobot(double fade_s = 0)
      : model(pushed_model()),
        estimator(model, pushed_setup(model, false, fade_s)),
        statics(model),
        document(model, "softkin view"),
        served(
            model, [this](const LiveRequest& request) { robot->ask(request); }, estimator.columns().size()),
        stream(0) {
    robot = std::make_unique<LiveRobot>(
        statics, document, one_thread(), statics.solve(model.rest_actuation(), statics.rest(), one_thread()),
        [this](auto answer) {
          stream.answer(answer);
          served.server.show(std::move(answer));
        },
        &estimator);
    stream.begin(
        {model, estimator.columns(), estimator.reported_actuators(), estimator.fades()}, secret,
        [this](LiveRequest request) { robot->ask(std::move(request)); },
        [this](bool lent) { served.server.lend(lent); });
  }
  ~ReportedRobot() {
    served.end();
    stream.stop();
    robot.reset();
  }
  static StaticsOptions one_thread() { return runs::testing::one_thread(); }

  Model model;
  LiveEstimator estimator;
  Statics statics;
  runs::PageDocument document;
  Served served;
  ReadingStream stream;
  std::unique_ptr<LiveRobot> robot;
};

/// Pages see the shape follow, without control while it streams.
TEST(ReadingStream, TellsThePushAndPagesFollow) {
  ReportedRobot reported;
  LiveClient page = reported.served.client();
  ASSERT_TRUE(page.comes_to([](const auto& state) { return state.at("control") == true; }));
  PlainSocket writer(reported.stream.port());
  writer.send(std::string(R"({"token": ")") + secret + "\"}\n");
  ASSERT_TRUE(page.comes_to([](const auto& state) { return state.at("streamed") == true; }));
  const Eigen::Vector3d pushes[] = {{0, 0.1, -0.05}, {50, -0.2, 0.1}};
  double time_s = 0;
  for (const Eigen::Vector3d& push : pushes) {
    const Eigen::VectorXd read = read_at(reported.model, push);
    nlohmann::json line{{"t_s", time_s += 1}, {"air_kPa", push[0]}};
    for (std::size_t c = 0; c < 6; ++c) line[reported.estimator.columns()[c].name] = read[c];
    writer.send(line.dump() + "\n");
    const nlohmann::json answer = line_of(writer);
    ASSERT_EQ(answer.at("status"), "converged") << answer;
    EXPECT_EQ(answer.at("t_s"), time_s);
    for (std::size_t n = 0; n < 2; ++n) {
      const nlohmann::json& number = answer.at("numbers").at(n);
      EXPECT_NEAR(number.at("value").get<double>(), push[n + 1], number.at("deviation").get<double>() / 100 + 1e-6);
    }
    std::optional<LiveFrame> shape;
    while ((shape = page.shape(0)) && !shape->head.contains("estimate")) {
    }
    ASSERT_TRUE(shape.has_value());
    EXPECT_NEAR(shape->head.at("markers").at(0).at(2).get<double>(), read[2], 1e-3);
    EXPECT_EQ(shape->head.at("estimate").at("forces").at(0).at("name"), "push");
  }
  page.say({{"type", "take"}});
  EXPECT_NE(page.next("refused").at("why").get<std::string>().find("readings are streamed"), std::string::npos);
  { const PlainSocket gone = std::move(writer); }
  EXPECT_TRUE(page.comes_to([](const auto& state) { return state.at("control") == true && !state.at("streamed"); }));
}

/// A page that has control sends readings; it neither commands nor leads markers there.
TEST(ReadingStream, PagesTellFromWhatIsTyped) {
  ReportedRobot reported;
  LiveClient page = reported.served.client();
  ASSERT_TRUE(page.comes_to([](const auto& state) { return state.at("control") == true; }));
  const Eigen::Vector3d push(0, 0.1, -0.05);
  const Eigen::VectorXd read = read_at(reported.model, push);
  nlohmann::json values = nlohmann::json::array();
  for (const double value : read) values.push_back(value);
  page.say({{"type", "readings"}, {"id", 1}, {"commands", {0, 0, 0}}, {"values", values}});
  const auto shape = page.shape(1);
  ASSERT_TRUE(shape.has_value());
  const nlohmann::json estimate = shape->head.at("estimate"), force = estimate.at("forces").at(0);
  EXPECT_EQ(estimate.at("readings").size(), 6u);
  EXPECT_NEAR(force.at("force_N").at(1).get<double>(), 0.1, 1e-3);
  EXPECT_TRUE(force.at("place_mm").is_null());
  EXPECT_NEAR(shape->head.at("commands").at(2).get<double>(), -0.05, 1e-3);
  page.say({{"type", "readings"}, {"id", 2}, {"commands", {0, 0, 0}}, {"values", std::vector<nlohmann::json>(6)}});
  const auto nothing = page.shape(2);
  ASSERT_TRUE(nothing.has_value());
  EXPECT_EQ(nothing->head.at("status"), "converged") << nothing->head;
  EXPECT_NEAR(nothing->head.at("estimate").at("numbers").at(0).at("deviation").get<double>(), 0.5, 1e-3);
  page.command(3, {0, 0, 0});
  EXPECT_EQ(page.next("refused").at("why"), "forces are estimated here: send readings");
  page.say({{"type", "readings"}, {"id", 4}, {"commands", {0, 0, 0}}, {"values", {1, 2}}});
  EXPECT_EQ(page.next("refused").at("why"), "values must be a list of 6 numbers or null, one per column");
  page.say({{"type", "readings"}, {"id", 5}, {"commands", {0, 0, 0}}, {"values", {1, 2, 3, 4, 5, 1e10}}});
  EXPECT_EQ(page.next("refused").at("why"), "values must be null or numbers up to 1e+09");
}

TEST(LiveEstimate, SaysWhichDeviationIsMissing) {
  const Model model = pushed_model();
  std::array<std::string, readings> options;
  options.fill("--deviation-of-it");
  try {
    (void)estimate_setup(model, {{"push"}}, {}, options, {});
    FAIL() << "nothing can be read";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("--deviation-of-it in mm (coordinate)"), std::string::npos);
  }
  // every kind that this robot has, by the names that tables have
  std::vector<std::string> names;
  for (const PoseColumn& column : possible_readings(model)) names.push_back(column.name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"tip_x_mm", "tip_y_mm", "tip_z_mm", "corner_x_mm", "corner_y_mm", "corner_z_mm",
                                      "air_volume_mm3", "base_force_x_N", "base_force_y_N", "base_force_z_N"}));
}

}  // namespace
}  // namespace softkin::view
