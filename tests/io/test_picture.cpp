#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/picture/canvas.hpp>
#include <softkin/io/picture/picture.hpp>

namespace softkin {
namespace {

namespace fs = std::filesystem;
using Pixel = std::array<int, 3>;

constexpr Pixel white{255, 255, 255}, map_low{0x44, 0x01, 0x54}, map_middle{0x21, 0x91, 0x8c},
    map_high{0xfd, 0xe7, 0x25};

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;

  [[nodiscard]] Pixel at(int x, int y) const {
    const std::uint8_t* p = bytes.data() + 3 * (std::size_t(y) * width + x);
    return {p[0], p[1], p[2]};
  }
  [[nodiscard]] double covered() const {
    int count = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) count += at(x, y) != white;
    }
    return double(count) / (double(width) * height);
  }
};

bool near(const Pixel& a, const Pixel& b, int tolerance) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(a[k] - b[k]) > tolerance) return false;
  }
  return true;
}

Picture read_png(const fs::path& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&header, path.c_str())) << header.message;
  header.format = PNG_FORMAT_RGB;
  Picture picture{int(header.width), int(header.height), std::vector<std::uint8_t>(PNG_IMAGE_SIZE(header))};
  EXPECT_TRUE(png_image_finish_read(&header, nullptr, picture.bytes.data(), 0, nullptr)) << header.message;
  return picture;
}

/// A rectangle in a plane of constant z, seen from +z it fills [x0, x1] x [y0, y1].
PictureLayer rectangle(double x0, double x1, double y0, double y1, double z) {
  PictureLayer layer;
  layer.points.resize(4, 3);
  layer.points << x0, y0, z, x1, y0, z, x1, y1, z, x0, y1, z;
  layer.triangles = {{0, 1, 2}, {0, 2, 3}};
  layer.edges = false;
  return layer;
}

PictureLayer square(double z, std::array<double, 3> color = {0, 0, 1}, double opacity = 1) {
  PictureLayer layer = rectangle(-1, 1, -1, 1, z);
  layer.color = color;
  layer.opacity = opacity;
  return layer;
}

PictureLayer octahedron() {
  PictureLayer layer;
  layer.points.resize(6, 3);
  layer.points << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  for (const Index x : {0, 1}) {
    for (const Index y : {2, 3}) {
      for (const Index z : {4, 5}) layer.triangles.push_back({x, y, z});
    }
  }
  layer.edges = false;
  return layer;
}

PictureOptions from_above(int width, int height) {
  PictureOptions options;
  options.width = width;
  options.height = height;
  options.view = {0, 0, 3};
  options.up = {0, 2, 0};
  return options;
}

class PictureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "softkin_picture_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path path() const { return folder_ / "picture.png"; }

  Picture drawn(const std::vector<PictureLayer>& layers, const PictureOptions& options) {
    write_picture(path(), layers, options);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1) << "only the picture";
    Picture picture = read_png(path());
    EXPECT_EQ(picture.width, options.width);
    EXPECT_EQ(picture.height, options.height);
    return picture;
  }

  void expect_refused(const std::vector<PictureLayer>& layers, const PictureOptions& options, const std::string& why) {
    try {
      write_picture(path(), layers, options);
      ADD_FAILURE() << "not refused: " << why;
    } catch (const InvalidInput& refusal) {
      const std::string message = refusal.what();
      EXPECT_EQ(message.rfind(path().string() + ": ", 0), 0u) << message;
      EXPECT_NE(message.find(why), std::string::npos) << message;
    }
    EXPECT_TRUE(fs::is_empty(folder_)) << why;
  }

  fs::path folder_;
};

TEST_F(PictureTest, SquareCoversItsShare) {
  EXPECT_NEAR(drawn({square(5)}, from_above(200, 200)).covered(), 0.81, 1e-9);
  EXPECT_NEAR(drawn({square(5)}, from_above(160, 80)).covered(), 0.81 / 2, 1e-9);
  EXPECT_NEAR(drawn({rectangle(7, 11, -3, -1, 0)}, from_above(200, 200)).covered(), 0.81 / 2, 1e-9);
}

TEST_F(PictureTest, ObliqueSquareIsForeshortened) {
  PictureOptions options = from_above(200, 200);
  options.view = {0, -std::sqrt(3), 1};  // 60 degrees from the normal
  options.up = {0, 0, 1};
  EXPECT_NEAR(drawn({square(0)}, options).covered(), 0.81 * 0.5, 0.01);
}

TEST_F(PictureTest, UpIsUpAndRightIsRight) {
  PictureLayer layer = rectangle(0, 1, 0, 1, 0);
  layer.triangles = {{0, 1, 3}};  // the corners (0, 0), (1, 0), (0, 1)
  const Picture picture = drawn({layer}, from_above(100, 100));
  EXPECT_NE(picture.at(20, 80), white);
  EXPECT_NE(picture.at(10, 20), white);
  EXPECT_NE(picture.at(80, 90), white);
  EXPECT_EQ(picture.at(80, 20), white);
}

TEST_F(PictureTest, BackgroundIsWhite) {
  const Picture picture = drawn({square(0)}, from_above(200, 200));
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 10; ++j) {
      for (const Pixel& p : {picture.at(i, j), picture.at(j, i), picture.at(i, 199 - j), picture.at(199 - j, i)}) {
        ASSERT_EQ(p, white);
      }
    }
  }
}

TEST_F(PictureTest, NearerHidesFarther) {
  const PictureLayer far = square(0, {0, 0, 1});
  PictureLayer near_by = rectangle(-0.5, 0.5, -0.5, 0.5, 1);
  near_by.color = {1, 0, 0};
  for (const auto& layers : {std::vector{far, near_by}, std::vector{near_by, far}}) {
    const Picture picture = drawn(layers, from_above(200, 200));
    EXPECT_EQ(picture.at(100, 100), (Pixel{255, 0, 0}));
    EXPECT_EQ(picture.at(100, 30), (Pixel{0, 0, 255}));
    PictureOptions below = from_above(200, 200);
    below.view = {0, 0, -1};
    EXPECT_EQ(drawn(layers, below).at(100, 100), (Pixel{0, 0, 255}));
  }
}

TEST_F(PictureTest, CrossingSurfacesShowTheNearerPart) {
  PictureLayer tilted = square(0, {1, 0, 0});
  for (int i = 0; i < 4; ++i) tilted.points(i, 2) = tilted.points(i, 0);  // rises to the right
  const Picture picture = drawn({square(0, {0, 0, 1}), tilted}, from_above(200, 200));
  EXPECT_EQ(picture.at(60, 100), (Pixel{0, 0, 255}));
  EXPECT_GT(picture.at(140, 100)[0], 100);
  EXPECT_EQ(picture.at(140, 100)[2], picture.at(140, 100)[1]);
}

TEST_F(PictureTest, ValuesTakeTheColoursOfTheMap) {
  PictureLayer layer = square(0);
  layer.values = {-3, 5, 5, -3};
  const Picture picture = drawn({layer}, from_above(400, 200));
  EXPECT_TRUE(near(picture.at(110, 50), map_low, 3));
  EXPECT_TRUE(near(picture.at(200, 150), map_middle, 4));
  EXPECT_TRUE(near(picture.at(289, 50), map_high, 3));
}

TEST_F(PictureTest, LayersShareOneRangeOfUsedPoints) {
  PictureLayer left = rectangle(0, 1, 0, 1, 0), right = rectangle(1, 2, 0, 1, 0);
  left.values.assign(4, 2);
  right.values.assign(4, 4);
  left.points.conservativeResize(5, 3);
  left.points.row(4) << 1e6, 0, 0;  // of no triangle
  left.values.push_back(1e6);
  const Picture picture = drawn({left, right}, from_above(200, 100));
  EXPECT_EQ(picture.at(20, 50), map_low);
  EXPECT_EQ(picture.at(180, 50), map_high);
  right.values.assign(4, 2);
  EXPECT_EQ(drawn({left, right}, from_above(200, 100)).at(180, 50), map_low) << "no range: one colour";
}

TEST_F(PictureTest, HugeAndTinyNumbersAreDrawn) {
  for (const double size : {1e-200, 1e300}) {
    PictureLayer layer = square(0);
    layer.points *= size;
    layer.values = {-1e308, 1e308, 1e308, -1e308};
    const Picture picture = drawn({layer}, from_above(400, 300));
    EXPECT_TRUE(near(picture.at(100, 150), picture.at(100, 100), 0));
    EXPECT_GT(picture.covered(), 0.2);
  }
}

TEST_F(PictureTest, SymmetricSceneGivesSymmetricPicture) {
  const Picture picture = drawn({octahedron()}, from_above(200, 200));
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      ASSERT_TRUE(near(picture.at(x, y), picture.at(y, x), 1)) << "the light is on the diagonal";
      ASSERT_EQ(picture.at(x, y) == white, picture.at(199 - x, y) == white);
    }
  }
  EXPECT_GT(picture.at(75, 75)[0], picture.at(125, 75)[0]);
  EXPECT_GT(picture.at(125, 75)[0], picture.at(125, 125)[0]);
}

TEST_F(PictureTest, BothSidesOfASurfaceLookAlike) {
  PictureLayer turned = octahedron();
  for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(drawn({octahedron()}, from_above(200, 200)).bytes, drawn({turned}, from_above(200, 200)).bytes);
}

TEST_F(PictureTest, SeamsAreClosed) {
  PictureLayer fan;
  const int count = 97;
  fan.points.resize(count + 1, 3);
  fan.points.row(count) << 0.013, -0.021, 0;
  for (Index i = 0; i < count; ++i) {
    fan.points.row(i) << std::cos(2 * M_PI * i / count), std::sin(2 * M_PI * i / count), 0;
    fan.triangles.push_back({i, (i + 1) % count, count});
  }
  fan.color = {0, 0, 0};
  fan.edges = false;
  const Picture picture = drawn({fan}, from_above(300, 230));
  for (int y = 0; y < 230; ++y) {
    for (int x = 0; x < 300; ++x) {
      if (std::hypot(x - 149.5, y - 114.5) < 100) {
        ASSERT_EQ(picture.at(x, y), (Pixel{0, 0, 0})) << x << ' ' << y;
      }
    }
  }
}

TEST_F(PictureTest, SeeThroughLayersAreBlended) {
  const PictureLayer solid = square(0, {0, 0, 1}), red = square(1, {1, 0, 0}, 0.5), green = square(2, {0, 1, 0}, 0.25);
  const auto middle = [&](const std::vector<PictureLayer>& layers) {
    return drawn(layers, from_above(100, 100)).at(50, 50);
  };
  EXPECT_TRUE(near(middle({red, solid}), {128, 0, 128}, 1));
  EXPECT_TRUE(near(middle({red}), {255, 128, 128}, 1));
  EXPECT_TRUE(near(middle({solid, red, green}), {96, 64, 96}, 1));
  EXPECT_TRUE(near(middle({green, red, solid}), {96, 64, 96}, 1)) << "by depth, not by order";
  EXPECT_EQ(middle({solid, square(-1, {1, 0, 0}, 0.5)}), (Pixel{0, 0, 255})) << "hidden behind the solid";
  EXPECT_EQ(middle({solid, square(0, {1, 0, 0}, 0.5)}), (Pixel{0, 0, 255})) << "coincides with the solid";
  PictureLayer twice = red;  // a surface behind its own front does not add to it
  twice.points.conservativeResize(8, 3);
  twice.points.bottomRows(4) = red.points.topRows(4).rowwise() - Eigen::RowVector3d(0, 0, 0.5);
  twice.triangles.insert(twice.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
  EXPECT_EQ(middle({twice, solid}), middle({red, solid}));
}

TEST_F(PictureTest, SeeThroughLayersHideWhereTheyNearlyCoincide) {
  const PictureLayer solid = square(0, {0, 0, 1});  // with the layers in front of it 2 x 2 and shallow: size 2.83
  const Pixel blue{0, 0, 255};
  const auto middle = [&](double distance) {
    return drawn({solid, square(distance, {1, 0, 0}, 0.5)}, from_above(100, 100)).at(50, 50);
  };
  for (const double distance : {-0.012, 0.001, 0.012}) EXPECT_EQ(middle(distance), blue) << distance;
  for (const double distance : {0.016, 0.05}) EXPECT_TRUE(near(middle(distance), {128, 0, 128}, 1)) << distance;
  PictureLayer rough = square(0, {1, 0, 0}, 0.5);  // in front in places, as two shapes of a held part are
  for (int i = 0; i < 4; ++i) rough.points(i, 2) = i % 2 == 0 ? 0.01 : -0.01;
  EXPECT_EQ(drawn({solid, rough}, from_above(100, 100)).bytes, drawn({solid}, from_above(100, 100)).bytes)
      << "blotches";
  PictureLayer wide = rectangle(-2, 2, -1, 1, 0.001);
  wide.color = {1, 0, 0};
  wide.opacity = 0.5;
  EXPECT_TRUE(near(drawn({solid, wide}, from_above(200, 100)).at(20, 50), {255, 128, 128}, 1)) << "on the background";
}

TEST_F(PictureTest, ALayerBehindLeavesTheSolidOneAsItIs) {
  PictureLayer ghost = rectangle(-2, 2, -1, 1, 1);  // nearer than the solid one
  ghost.color = {1, 0, 0};
  ghost.opacity = 0.5;
  ghost.behind = true;
  const Picture picture = drawn({square(0), ghost}, from_above(200, 100));
  EXPECT_EQ(picture.at(100, 50), (Pixel{0, 0, 255}));
  EXPECT_TRUE(near(picture.at(20, 50), {255, 128, 128}, 1)) << "on the background";
}

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
  for (const int way : {-1, 1}) {
    EXPECT_TRUE(near(picture.at(x + 2 * way, y + 2 * way), red, 90)) << "an arm of the cross";
    EXPECT_FALSE(near(picture.at(x + 3 * way, y), red, 90)) << "between its arms";
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

TEST_F(PictureTest, RefusesBadLayers) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto refused = [&](const std::function<void(PictureLayer&)>& spoil, const std::string& why) {
    PictureLayer layer = square(0);
    spoil(layer);
    expect_refused({square(1), layer}, from_above(100, 100), why);
  };
  refused([&](PictureLayer& l) { l.points(2, 1) = nan; }, "layer 1: point 2 is not finite");
  refused([&](PictureLayer& l) { l.points(3, 0) = infinity; }, "layer 1: point 3 is not finite");
  refused([&](PictureLayer& l) { l.values = {0, 1, nan, 0}; }, "layer 1: value 2 is not finite");
  refused([&](PictureLayer& l) { l.values = {0, 1, 2}; }, "layer 1: 3 values for 4 points");
  refused([&](PictureLayer& l) { l.triangles[1][2] = 4; }, "layer 1: triangle 1 names point 4 of 4");
  refused([&](PictureLayer& l) { l.triangles[0][0] = -1; }, "layer 1: triangle 0 names point -1 of 4");
  refused([&](PictureLayer& l) { l.color[1] = 1.5; }, "layer 1: a colour is outside [0, 1]");
  refused([&](PictureLayer& l) { l.color[1] = nan; }, "layer 1: a colour is outside [0, 1]");
  for (const double opacity : {0.0, -1.0, 1.01, nan}) {
    refused([&](PictureLayer& l) { l.opacity = opacity; }, "layer 1: opacity is outside (0, 1]");
  }
  refused([&](PictureLayer& l) { l.points(2, 2) = 1.7e308; }, "too large to draw");
}

TEST_F(PictureTest, RefusesWhatShowsNothing) {
  PictureLayer layer = square(0);
  PictureOptions options = from_above(100, 100);
  options.view = {1, 0, 0};
  expect_refused({layer}, options, "seen edge-on");
  layer.points.setConstant(3);
  expect_refused({layer}, from_above(100, 100), "no extent");
  layer.triangles.clear();
  expect_refused({layer}, from_above(100, 100), "at least one triangle");
  expect_refused({}, from_above(100, 100), "at least one triangle");
}

TEST_F(PictureTest, RefusesBadOptions) {
  const auto refused = [&](const std::function<void(PictureOptions&)>& spoil, const std::string& why) {
    PictureOptions options = from_above(64, 64);
    spoil(options);
    expect_refused({square(0)}, options, why);
  };
  refused([](PictureOptions& o) { o.width = 63; }, "width 63 is outside [64, 8192]");
  refused([](PictureOptions& o) { o.height = 8193; }, "height 8193 is outside [64, 8192]");
  refused([](PictureOptions& o) { o.height = -5; }, "height -5 is outside [64, 8192]");
  refused([](PictureOptions& o) { o.view = {0, 0, 0}; }, "neither zero nor parallel");
  refused([](PictureOptions& o) { o.up = {0, 0, 0}; }, "neither zero nor parallel");
  refused([](PictureOptions& o) { o.up = -2 * o.view; }, "neither zero nor parallel");
  refused([](PictureOptions& o) { o.view.x() = std::nan(""); }, "not finite");
  EXPECT_EQ(drawn({square(0)}, from_above(64, 64)).width, 64);
}

TEST_F(PictureTest, AFolderThatIsNotThereIsNamed) {
  const fs::path nowhere = folder_ / "absent" / "a.png";
  try {
    write_picture(nowhere, {square(0)}, from_above(64, 64));
    FAIL() << "not refused";
  } catch (const InvalidInput& refusal) {
    EXPECT_EQ(std::string(refusal.what()), nowhere.string() + ": cannot be written: No such file or directory");
  }
}

}  // namespace
}  // namespace softkin
