#include <gtest/gtest.h>

#include <cmath>

#include "reported_robot.hpp"

namespace softkin::view {
namespace {

struct Lines {
  Model model = testing::pushed_model();
  LineColumns columns;
  explicit Lines(bool timed = false) : columns(model, testing::pushed_setup(model).columns, reported(), timed) {}
  [[nodiscard]] std::vector<Index> reported() const {
    std::vector<Index> indices;
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      if (model.actuators[a].is<ForceCommand>()) indices.push_back(a);
    return indices;
  }
  [[nodiscard]] std::string refusal_of(const std::string& text, std::optional<double> after = {}) const {
    try {
      (void)read_reading_line(text, columns, after);
    } catch (const Refusal& refusal) {
      return refusal.what();
    }
    return "";
  }
};

TEST(ReadingLines, AreReadByTheColumnsOfATable) {
  const Lines lines;
  const ReadingsRequest line = read_reading_line(
      R"({"t_s": 0.5, "air_kPa": 10, "tip_x_mm": 12.5, "tip_y_mm": null, "corner_z_mm": -1e1})", lines.columns, {});
  EXPECT_EQ(line.time_s, 0.5);
  EXPECT_EQ(line.commands[0], 10);
  ASSERT_EQ(line.values.size(), 6);
  EXPECT_EQ(line.values[0], 12.5);
  EXPECT_EQ(line.values[5], -10);
  for (const Index missing : {1, 2, 3, 4}) EXPECT_TRUE(std::isnan(line.values[missing])) << missing;
  const ReadingsRequest rests = read_reading_line(R"({"corner_y_mm": 1})", lines.columns, 3.0);
  EXPECT_EQ(rests.commands, lines.model.rest_actuation());
  EXPECT_FALSE(rests.time_s.has_value());
}

TEST(ReadingLines, AreRefusedInASentence) {
  const Lines lines, timed(true);
  const std::pair<const char*, const char*> table[] = {
      {"", "this is no JSON"},
      {"{", "this is no JSON"},
      {"[1]", "a line is a JSON object"},
      {"{}", "every reading is missing"},
      {R"({"tip_x_mm": null})", "every reading is missing"},
      {R"({"air_kPa": 10})", "every reading is missing"},
      {R"({"tip_x_mm": NaN})", "this is no JSON"},
      {R"({"tip_x_mm": 1e999})", "this is no JSON"},
      {R"({"tip_x_mm": 1e200})", "tip_x_mm is larger than 1e+09"},
      {R"({"tip_x_mm": "1"})", "tip_x_mm must be a finite number"},
      {R"({"tip_x_mm": [1]})", "tip_x_mm must be a finite number"},
      {R"({"tip_x_mm": true})", "tip_x_mm must be a finite number"},
      {R"({"tipp_x_mm": 1})", "there is no column 'tipp_x_mm'; did you mean 'tip_x_mm'?"},
      {R"({"tip_x_mm": 1, "a\nb": 2})", "there is no column 'a?b'"},
      {R"({"air_kPa": 301, "tip_x_mm": 1})", "air: 301 kPa is outside its range, -100 to 300 kPa"},
      {R"({"air_kPa": null, "tip_x_mm": 1})", "air_kPa is a command"},
      {R"({"air_kPa": 1, "air": 1, "tip_x_mm": 1})", "air: another key commands the same"},
      {R"({"push_fy_N": 1, "tip_x_mm": 1})", "push_fy_N is to be estimated: leave it out"},
      {R"({"t_s": "now", "tip_x_mm": 1})", "t_s must be a finite number"}};
  for (const auto& [text, why] : table)
    EXPECT_EQ(lines.refusal_of(text).find(why), 0u) << text << lines.refusal_of(text);
  EXPECT_EQ(lines.refusal_of(R"({"t_s": 2, "tip_x_mm": 1})", 2), "t_s must increase from line to line");
  EXPECT_EQ(lines.refusal_of(R"({"t_s": 2, "tip_x_mm": 1})", 1.9), "");
  EXPECT_EQ(timed.refusal_of(R"({"tip_x_mm": 1})"), "t_s is missing: estimates fade in time");
  EXPECT_EQ(lines.refusal_of(std::string(longest_line, '[')), "a line is a JSON object");
  EXPECT_EQ(lines.refusal_of(std::string(longest_line + 1, ' ')), "a line is at most 65536 bytes long");
  EXPECT_EQ(lines.refusal_of(R"({"tip_x_mm":)" + std::string(2000, '[') + std::string(2000, ']') + "}"),
            "a line is a JSON object");
}

TEST(ReadingLines, BeginWithAToken) {
  EXPECT_EQ(read_token_line(R"({"token": "abc"})"), "abc");
  for (const char* text : {"abc", R"("abc")", R"({"token": 7})", R"({"secret": "abc"})", R"({"token": "a", "b": 1})"})
    EXPECT_THROW((void)read_token_line(text), Refusal) << text;
  EXPECT_EQ(nlohmann::json::parse(error_line("no \"such\"\xff")).at("error"), "no \"such\"\xef\xbf\xbd");
}

/// With a single marker a table may have the column x_mm without the marker's name.
TEST(ReadingLines, KnowTheOnlyMarker) {
  const Model model = runs::testing::swelling_model();
  const LineColumns columns(model, possible_readings(model), {}, false);
  EXPECT_EQ(read_reading_line(R"({"y_mm": 3})", columns, {}).values[1], 3);
  EXPECT_EQ(read_reading_line(R"({"tip_y_mm": 3})", columns, {}).values[1], 3);
}

}  // namespace
}  // namespace softkin::view
