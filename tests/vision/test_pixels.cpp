#include <gtest/gtest.h>

#include <random>
#include <set>
#include <softkin/vision/outlines.hpp>
#include <softkin/vision/pixels.hpp>
#include <utility>

namespace {

using namespace softkin;
using namespace softkin::vision;
using Places = std::set<std::pair<int, int>>;

TEST(OwnPixels, GrayIsTheWeightedMeanOfColours) {
  std::mt19937 random(3);
  RgbImage picture(40, 30);
  for (auto& byte : picture.bytes) byte = static_cast<std::uint8_t>(random());
  const GrayImage gray = gray_of(picture);
  for (int i = 0; i < 40 * 30; ++i) {
    const std::uint8_t* rgb = picture.bytes.data() + 3 * i;
    EXPECT_NEAR(gray.bytes[std::size_t(i)], 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2], 0.51);
  }
}

TEST(OwnPixels, HueSaturationAndValueGiveTheColourBack) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> byte(0, 255);
  for (int i = 0; i < 1000; ++i) {
    const std::array<float, 3> rgb{byte(random), byte(random), byte(random)};
    const std::array<float, 3> hsv = hsv_of(rgb);
    const auto channel = [&](float n) {  // Wikipedia, HSL and HSV, "HSV to RGB alternative"
      const float k = std::fmod(n + hsv[0] / 60, 6.0F);
      return hsv[2] - hsv[2] * hsv[1] * std::max(0.0F, std::min({k, 4 - k, 1.0F}));
    };
    EXPECT_NEAR(channel(5), rgb[0], 1e-3);
    EXPECT_NEAR(channel(3), rgb[1], 1e-3);
    EXPECT_NEAR(channel(1), rgb[2], 1e-3);
  }
  EXPECT_EQ(hsv_of({90, 90, 90}), (std::array<float, 3>{0, 0, 90}));
}

TEST(OwnPixels, BetweenThemThePictureIsLinearAndBeyondTheFrameThatOfItsRim) {
  RgbImage picture(9, 7);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x) {
      picture.pixel(x, y)[0] = static_cast<std::uint8_t>(10 + 7 * x + 3 * y);
      picture.pixel(x, y)[1] = static_cast<std::uint8_t>(200 - 5 * x - 11 * y);
      picture.pixel(x, y)[2] = 77;
    }
  const GrayImage gray = gray_of(picture);
  for (const Vec2& at : {Vec2(0, 0), Vec2(3.25, 4.5), Vec2(7.999, 5.001), Vec2(8, 6), Vec2(2, 0.75)}) {
    const Eigen::Vector3d expected(10 + 7 * at.x() + 3 * at.y(), 200 - 5 * at.x() - 11 * at.y(), 77);
    EXPECT_LT((between(picture, at) - expected).norm(), 1e-9);
    EXPECT_NEAR(between(gray, at), Eigen::Vector3d(0.299, 0.587, 0.114).dot(expected), 0.51);
  }
  EXPECT_EQ(between(gray, {-3, 2}), gray.at(0, 2));
  EXPECT_EQ(between(gray, {20, 40}), gray.at(8, 6));
}

/// The pixels that have a neighbour, along a row or a column, in what surrounds the blob.
Places border_of(const Blob& blob) {
  const int width = blob.box.width + 2, height = blob.box.height + 2;
  const auto set = [&](int x, int y) {
    return x > 0 && y > 0 && x < width - 1 && y < height - 1 && blob.mask.at(x - 1, y - 1) != 0;
  };
  Places outside{{0, 0}}, border;
  std::vector<std::pair<int, int>> open{{0, 0}};
  while (!open.empty()) {
    const auto [x, y] = open.back();
    open.pop_back();
    for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      const std::pair next(x + dx, y + dy);
      if (next.first < 0 || next.second < 0 || next.first >= width || next.second >= height) continue;
      if (set(next.first, next.second))
        border.emplace(blob.box.x + next.first - 1, blob.box.y + next.second - 1);
      else if (outside.insert(next).second)
        open.push_back(next);
    }
  }
  return border;
}

TEST(Outline, IsTheBorderOfRandomBlobsStepByStep) {
  std::mt19937 random(7);
  int blobs = 0;
  for (const int fraction : {25, 45, 60, 85})
    for (int round = 0; round < 20; ++round) {
      RgbImage picture(48, 40);  // white; 3 x 3 pixels of red a piece, so that their mean is red in the middle
      for (int y = 3; y < 36; y += 3)
        for (int x = 3; x < 44; x += 3)
          if (static_cast<int>(random() % 100) < fraction)
            for (int k = 0; k < 9; ++k) {
              std::uint8_t* pixel = picture.pixel(x + k % 3, y + k / 3);
              pixel[0] = 200, pixel[1] = 20, pixel[2] = 20;
            }
      double total = 0;
      for (const Blob& blob : find_blobs(picture, Colour("red"), 1)) {
        const std::vector<Vec2> outline = outline_of(blob);
        Places places;
        for (std::size_t i = 0; i < outline.size(); ++i) {
          places.emplace(static_cast<int>(outline[i].x()), static_cast<int>(outline[i].y()));
          const Vec2 to_next = outline[(i + 1) % outline.size()] - outline[i];
          EXPECT_LE(to_next.lpNorm<Eigen::Infinity>(), 1);
          EXPECT_TRUE(outline.size() == 1 || to_next.norm() > 0);
        }
        EXPECT_EQ(places, border_of(blob));
        EXPECT_EQ(blob.area,
                  std::count_if(blob.mask.bytes.begin(), blob.mask.bytes.end(), [](int v) { return v > 0; }));
        total += blob.area;
        ++blobs;
      }
      EXPECT_GT(total, 0);
    }
  EXPECT_GT(blobs, 200);
}

TEST(Outline, MomentsAreThoseOfTheTriangleAndTheRectangle) {
  const Vec2 a(2, 1), b(7, 2), c(3, 6);
  for (const std::vector<Vec2>& triangle : {std::vector<Vec2>{a, b, c}, std::vector<Vec2>{c, b, a}}) {
    const AreaMoments moments = moments_of(triangle);
    EXPECT_NEAR(moments.area, 12, 1e-12);  // half of (5, 1) x (1, 5)
    EXPECT_LT((moments.centre - (a + b + c) / 3).norm(), 1e-12);
    // exact for squares: the mean over the middles of the sides
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    for (const Vec2& middle : {Vec2((a + b) / 2), Vec2((b + c) / 2), Vec2((c + a) / 2)})
      second += middle * middle.transpose() / 3;
    EXPECT_LT((moments.second - second).norm(), 1e-12);
  }
  const AreaMoments line = moments_of({Vec2(1, 1), Vec2(5, 1)});
  EXPECT_EQ(line.area, 0);
  EXPECT_LT((line.centre - Vec2(3, 1)).norm(), 1e-12);
}

}  // namespace
