#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "picture_samples.hpp"

namespace softkin {
namespace {

using namespace testing;

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
