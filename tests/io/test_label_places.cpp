#include <gtest/gtest.h>

#include <random>
#include <softkin/io/picture/label_places.hpp>
#include <softkin/io/wrapped_lines.hpp>

namespace softkin {
namespace {

double common(const Area& a, const Area& b) {
  const Eigen::Vector2d size = a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low);
  return size.minCoeff() > 0 ? size.prod() : 0;
}

TEST(LabelPlaces, LabelsOfNearMarkersDoNotOverlap) {
  const Area picture{{0, 0}, {640, 400}};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<LabelWish> wishes;
    std::vector<Area> marks, labels;
    const Eigen::Vector2d middle(320 + 300 * any(random), 200 + 180 * any(random));
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector2d at = middle + 6 * Eigen::Vector2d(any(random), any(random));
      wishes.push_back({at, 40, 11});
      marks.push_back({at.array() - 3, at.array() + 3});
    }
    wishes.push_back({middle, 0, 0});  // without a label
    const std::vector<Eigen::Vector2d> corners = label_places(wishes, marks, picture, 1);
    ASSERT_EQ(corners.size(), wishes.size());
    for (int i = 0; i < 5; ++i) labels.push_back({corners[i], corners[i] + Eigen::Vector2d(40, 11)});
    for (std::size_t i = 0; i < labels.size(); ++i) {
      EXPECT_NEAR(common(labels[i], picture), 40 * 11, 1e-9) << "trial " << trial;
      for (const Area& mark : marks) EXPECT_EQ(common(labels[i], mark), 0) << "trial " << trial;
      for (std::size_t j = 0; j < i; ++j) EXPECT_EQ(common(labels[i], labels[j]), 0) << "trial " << trial;
    }
  }
}

TEST(LabelPlaces, ALoneLabelIsBesideItsMarker) {
  const Eigen::Vector2d corner = label_places({{{100, 100}, 40, 11}}, {}, {{0, 0}, {640, 400}}, 1)[0];
  EXPECT_GT(corner.x(), 100);
  EXPECT_LT(corner.x(), 110);
  EXPECT_LT(corner.y() + 11, 100);
}

TEST(WrappedLines, BreakAtSpacesAndHoldAllOfTheText) {
  const auto fits = [](const std::string& line) { return line.size() <= 10; };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(wrapped_lines("", 3, fits), Lines{""});
  EXPECT_EQ(wrapped_lines("air = 1", 3, fits), Lines{"air = 1"});
  EXPECT_EQ(wrapped_lines("air = 1.5, b = 2", 3, fits), (Lines{"air = 1.5,", "b = 2"}));
  EXPECT_EQ(wrapped_lines("abcdefghijklmn", 3, fits), (Lines{"abcdefghij", "klmn"}));
  EXPECT_EQ(wrapped_lines("one two three four five", 2, fits), (Lines{"one two", "three four five"}));
  EXPECT_EQ(wrapped_lines("\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4", 2, fits),
            (Lines{"\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4", "\xC3\xA4"}));
}

}  // namespace
}  // namespace softkin
