#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/io/picture/canvas.hpp>
#include <utility>

#include "picture_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

/// Drawing area 180 x 180, so that 1 mm is 90 pixels and the middle is at (100, 100).
TEST_F(PictureTest, MarksStandOverTheLayersWhereTheyAre) {
  const Pixel red{255, 0, 0}, blue{0, 0, 255};
  const auto place = [](double x, double y) { return std::pair(int(100 + 90 * x), int(100 - 90 * y)); };
  PictureMark line;
  line.points.resize(3, 3);
  line.points << -0.5, -0.5, -3, 0.5, -0.5, 0, 0.5, 0.5, 3;  // also behind the square
  line.color = {1, 0, 0};
  PictureMark dot{Points::Constant(1, 3, 0), "", {1, 0, 0}};
  PictureMark cross = dot;
  cross.points << -0.5, 0.5, 0;
  cross.sign = PictureMark::Sign::cross;
  write_picture(path(), {square(0)}, from_above(200, 200), {line, dot, cross});
  const Picture picture = read_png(path());
  for (const auto& [x, y] :
       {place(-0.5, -0.5), place(0, -0.5), place(0.5, 0), place(0.5, 0.5), place(0, 0), place(-0.5, 0.5)})
    EXPECT_TRUE(near(picture.at(x, y), red, 90)) << x << " " << y;
  const auto [x, y] = place(-0.5, 0.5);
  for (const int route : {-1, 1}) {
    EXPECT_TRUE(near(picture.at(x + 2 * route, y + 2 * route), red, 90)) << "an arm of the cross";
    EXPECT_FALSE(near(picture.at(x + 3 * route, y), red, 90)) << "between its arms";
  }
  EXPECT_EQ(picture.at(70, 110), blue) << "away from all marks";
}

TEST_F(PictureTest, MarksAreInThePictureWhereverTheyAre) {
  PictureMark far{Points::Constant(1, 3, 0), "", {1, 0, 0}};
  far.points << 3, 0, 0;
  write_picture(path(), {square(0)}, from_above(200, 100), {far});
  const Picture picture = read_png(path());  // 4 mm on 180 pixels
  EXPECT_EQ(picture.at(190, 50), (Pixel{255, 0, 0}));
  EXPECT_EQ(picture.at(55, 50), (Pixel{0, 0, 255}));
  EXPECT_EQ(picture.at(150, 50), white);
  far.points << std::nan(""), 0, 0;
  EXPECT_THROW(write_picture(path(), {square(0)}, from_above(200, 100), {far}), InvalidInput);
  far.points.resize(0, 3);
  EXPECT_THROW(write_picture(path(), {square(0)}, from_above(200, 100), {far}), InvalidInput);
}

TEST_F(PictureTest, EdgesAreThinAndDark) {
  PictureLayer layer = square(0, {1, 1, 0});
  layer.edges = true;
  const Picture picture = drawn({layer}, from_above(200, 200));
  EXPECT_LT(picture.at(100, 99)[0], 220);  // on the diagonal
  EXPECT_EQ(picture.at(105, 99), (Pixel{255, 255, 0}));
  EXPECT_EQ(picture.at(60, 100), (Pixel{255, 255, 0}));
}

/// Longest run of dark pixels in the lowest rows.
int scale_bar_length(const Picture& picture) {
  int longest = 0;
  for (int y = picture.height * 8 / 10; y < picture.height; ++y) {
    for (int x = 0, run = 0; x < picture.width; ++x) {
      const Pixel p = picture.at(x, y);
      run = p[0] < 120 && p[1] < 120 && p[2] < 120 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  return longest;
}

TEST_F(PictureTest, ScaleBarHasARoundLength) {
  for (const double size : {100.0, 37.0, 0.8}) {
    const PictureLayer layer = rectangle(0, size, 0, size / 2, 0);
    const Picture picture = drawn({layer}, from_above(1280, 800));
    int width = 0;
    for (int x = 0; x < 1280; ++x) width += picture.at(x, 360) != white;
    const double length = scale_bar_length(picture) * size / width, pixel = size / width;
    const double power = std::pow(10, std::floor(std::log10(length + 2 * pixel)));
    double error = length;
    for (const double factor : {1.0, 2.0, 5.0}) error = std::min(error, std::abs(length - factor * power));
    EXPECT_LT(error, 2.5 * pixel) << size;
  }
}

TEST_F(PictureTest, ColourBarRunsFromLowToHigh) {
  PictureLayer layer = square(0);
  layer.values = {0, 1, 1, 0};
  PictureOptions options = from_above(640, 400);
  const auto rows_of = [](const Picture& picture, const Pixel& color) {
    std::vector<int> rows;
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 500; x < picture.width; ++x) {
        if (picture.at(x, y) == color && (rows.empty() || rows.back() != y)) rows.push_back(y);
      }
    }
    return rows;
  };
  const Picture plain = drawn({layer}, options);
  const std::vector<int> low = rows_of(plain, map_low), high = rows_of(plain, map_high);
  ASSERT_FALSE(low.empty());
  ASSERT_FALSE(high.empty());
  EXPECT_GT(low.front(), high.back() + 250) << "high is above";
  options.value_label = "displacement [mm]";
  EXPECT_GT(drawn({layer}, options).covered(), 0) << "with a label";
  layer.values.clear();
  EXPECT_TRUE(rows_of(drawn({layer}, options), map_high).empty()) << "no values, no bar";
}

TEST_F(PictureTest, TicksOfTheColourBarAreRoundNumbers) {
  PictureLayer layer = square(0);
  layer.values = {0, 9.1, 9.1, 0};
  const Picture picture = drawn({layer}, from_above(640, 400));
  int right = 0;
  for (int x = 500; x < picture.width; ++x)
    if (picture.at(x, 343) == map_low) right = x;
  std::vector<double> rows;  // middles of the ticks beside the bar
  for (int y = 0, begin = -1; y < picture.height; ++y) {
    const bool inked = picture.at(right + 3, y)[0] < 230;  // thin strokes cover two rows in part
    if (inked && begin < 0) begin = y;
    if (!inked && begin >= 0) rows.push_back((begin + y) / 2.0);
    if (!inked) begin = -1;
  }
  ASSERT_EQ(rows.size(), 5u) << "0, 2, 4, 6, 8; found " << ::testing::PrintToString(rows);
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(rows[4 - k], 344 - (344 - 20) * 2 * k / 9.1, 1.5);
}

TEST_F(PictureTest, ATitleThatIsTooLongIsContinuedBelow) {
  PictureOptions options = from_above(640, 400);
  const auto inked_rows = [](const Picture& picture) {
    int count = 0;
    for (int y = 0; y < 60; ++y) {
      bool any = false;
      for (int x = 0; x < picture.width; ++x) any = any || picture.at(x, y)[2] < 128;  // of the ink, not of the square
      count += any ? 1 : 0;
    }
    return count;
  };
  options.title = "tendon1 = 0.8";
  const int one = inked_rows(drawn({square(-1)}, options));
  for (int i = 2; i < 12; ++i) options.title += ", tendon" + std::to_string(i) + " = 0.8";
  EXPECT_GT(inked_rows(drawn({square(-1)}, options)), 1.8 * one);
}

TEST_F(PictureTest, TitleStandsAboveAndIsCutToFit) {
  PictureOptions options = from_above(640, 400);
  const auto ink_columns = [](const Picture& picture) {
    std::pair<int, int> columns{picture.width, -1};
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        if (picture.at(x, y) == white) continue;
        columns = {std::min(columns.first, x), std::max(columns.second, x)};
      }
    }
    return columns;
  };
  options.title = "finger";
  const auto [first, last] = ink_columns(drawn({square(0)}, options));
  EXPECT_NEAR(first + last, 639, 3) << "centred";
  EXPECT_NEAR(last - first, Canvas::text_width("finger", 1.25), 3);
  options.title = std::string(1000, 'W');
  const auto [left, right] = ink_columns(drawn({square(0)}, options));
  EXPECT_GE(left, 8);
  EXPECT_LT(right, 632);
}

TEST_F(PictureTest, TextOutsideAsciiIsOneBoxPerCharacter) {
  EXPECT_EQ(Canvas::text_width("\xC3\xA4\xE2\x82\xAC!", 1), Canvas::text_width("abc", 1));
  PictureOptions options = from_above(640, 400);
  options.title = "\xC3\xA4";
  const Picture umlaut = drawn({square(0)}, options);
  options.title = "\xC3\xB6";
  EXPECT_EQ(drawn({square(0)}, options).bytes, umlaut.bytes);
  options.title = "a";
  EXPECT_NE(drawn({square(0)}, options).bytes, umlaut.bytes);
}

TEST(BitmapFont, EveryCharacterHasItsOwnShape) {
  std::set<std::string> shapes;
  for (int c = 32; c <= 127; ++c) {
    std::string shape;
    for (int row = 0; row < glyph_rows; ++row) {
      for (int column = 0; column < glyph_columns; ++column) shape += glyph_cell(char(c), column, row) ? '#' : '.';
    }
    EXPECT_EQ(shape.find('#') == std::string::npos, c == ' ') << char(c);
    EXPECT_TRUE(shapes.insert(shape).second) << char(c);
  }
  EXPECT_FALSE(glyph_cell('A', -1, 4));
  EXPECT_FALSE(glyph_cell('A', 5, 4));
  EXPECT_FALSE(glyph_cell('A', 0, 9));
  EXPECT_TRUE(glyph_cell('A', 0, 4));
}

TEST(RoundLength, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(round_length(20), 20);
  EXPECT_DOUBLE_EQ(round_length(49.9), 20);
  EXPECT_DOUBLE_EQ(round_length(57), 50);
  EXPECT_DOUBLE_EQ(round_length(1.7), 1);
  EXPECT_DOUBLE_EQ(round_length(0.0031), 0.002);
}

}  // namespace
}  // namespace softkin
