#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "picture_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

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

}  // namespace
}  // namespace softkin
