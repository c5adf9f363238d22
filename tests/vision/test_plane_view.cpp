#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/camera.hpp>
#include <vision/rendering.hpp>

#include "../cli/run_program.hpp"

namespace {

using namespace softkin;
using namespace softkin::testing;
using namespace softkin::vision;

const Camera view_lens{.width = 640,
                       .height = 480,
                       .fx = 620,
                       .fy = 622,
                       .cx = 315,
                       .cy = 244,
                       .k1 = -0.31,
                       .k2 = 0.12,
                       .p1 = 0.001,
                       .p2 = -0.0007,
                       .k3 = -0.01,
                       .focal_error = 0.5,
                       .reprojection_error = 0.08,
                       .pictures = 9};

TEST(Camera, DistortionIsTakenOutAgain) {
  for (int x = 0; x < 640; x += 71)
    for (int y = 0; y < 480; y += 59) {
      const Vec2 seen(x, y), ideal = undistorted(view_lens, seen);
      EXPECT_LT((bent(view_lens, ideal) - seen).norm(), 1e-9);
      EXPECT_LT((distorted(view_lens, ideal) - seen).norm(), 1e-9);
    }
}

TEST(Camera, FileGivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const Camera read = read_camera(folder.write("camera.yaml", camera_text(view_lens)));
  EXPECT_EQ(read.width, 640);
  EXPECT_NEAR(read.fy, 622, 1e-9);
  EXPECT_NEAR(read.k1, -0.31, 1e-9);
  EXPECT_NEAR(read.p2, -0.0007, 1e-12);
  EXPECT_NEAR(read.reprojection_error, 0.08, 1e-9);
  EXPECT_EQ(read.pictures, 9);
}

TEST(Camera, RefusesFilesByLine) {
  const TemporaryFolder folder;
  const std::string text = camera_text(view_lens);
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    const std::string file = folder.write("camera.yaml", changed);
    return message_of([&] { (void)read_camera(file); });
  };
  EXPECT_NE(refused("fx: 620", "fx: -3").find("camera.yaml:4: 'fx' must be a number"), std::string::npos)
      << refused("fx: 620", "fx: -3");
  EXPECT_NE(refused("fx: 620", "focal: 620").find("unknown key 'focal'"), std::string::npos);
  EXPECT_NE(refused("fx: 620, ", "").find("'fx' is missing"), std::string::npos);
  EXPECT_NE(refused("width: 640", "width: 640.5").find("whole numbers"), std::string::npos);
  EXPECT_NE(refused("softkin_camera: 1", "softkin_camera: 2").find("'softkin_camera'"), std::string::npos);
  EXPECT_NE(refused("distortion:", "lens:").find("unknown key 'lens'"), std::string::npos);
  EXPECT_NE(refused("k1: -0.31", "k1: -6").find("folds"), std::string::npos) << refused("k1: -0.31", "k1: -6");
  EXPECT_NE(message_of([&] { (void)read_camera(folder / "none.yaml"); }).find("none.yaml"), std::string::npos);
}

TEST(PlaneView, FindsThePerspectiveThatMadeThePoints) {
  const Photograph photo{.to_picture = tilted(700, {320, 240}, {0.6, -0.3, 0.5}, {-40, 20, 250}), .camera = view_lens};
  std::vector<PlanePoint> points;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 4; ++j) {
      const Vec2 place(20 * i, 20 * j);
      points.push_back({ideal_pixel(photo, place), place});
    }
  const PlaneView view(view_lens, points);
  EXPECT_LT(view.residual(), 1e-9);
  for (const Vec2& place : {Vec2(13, 7), Vec2(77, 55), Vec2(-5, 66)}) {
    EXPECT_LT((view.to_mm(seen_pixel(photo, place)) - place).norm(), 1e-7);
    EXPECT_LT((view.to_pixel(place) - seen_pixel(photo, place)).norm(), 1e-7);
  }
  // the area of a pixel, by its corners
  const Vec2 pixel = seen_pixel(photo, {50, 30});
  const Vec2 a = view.to_mm(pixel + Vec2(-0.5, -0.5)), b = view.to_mm(pixel + Vec2(0.5, 0.5));
  const Vec2 c = view.to_mm(pixel + Vec2(-0.5, 0.5)), d = view.to_mm(pixel + Vec2(0.5, -0.5));
  const Vec2 u = b - a, v = c - d;
  EXPECT_NEAR(view.pixel_area(pixel), std::abs(u.x() * v.y() - u.y() * v.x()) / 2, 1e-5);
  // another frame in the same plane
  const PlaneView moved = view.moved({10, 5}, 0.3);
  const Vec2 there = moved.to_mm(seen_pixel(photo, {10 + 20 * std::cos(0.3), 5 + 20 * std::sin(0.3)}));
  EXPECT_LT((there - Vec2(20, 0)).norm(), 1e-7);
}

TEST(PlaneView, ErrorIsThatOfRepeatedFits) {
  const Photograph photo{.to_picture = tilted(700, {320, 240}, {0.6, -0.3, 0.5}, {-40, 20, 250})};
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.2);
  const Vec2 place(95, 70), pixel = ideal_pixel(photo, place);
  double squares = 0, expected = 0;
  constexpr int fits = 400;
  for (int k = 0; k < fits; ++k) {
    std::vector<PlanePoint> points;
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 4; ++j) {
        const Vec2 corner(20 * i, 20 * j);
        points.push_back({ideal_pixel(photo, corner) + Vec2(noise(random), noise(random)), corner});
      }
    const PlaneView view({}, points);
    squares += (view.to_mm(pixel) - place).squaredNorm() / 2 / fits;
    expected += std::pow(view.error_at(pixel), 2) / fits;
  }
  EXPECT_NEAR(std::sqrt(expected), std::sqrt(squares), 0.1 * std::sqrt(squares));
}

TEST(PlaneView, RefusesPointsThatFixNoPerspective) {
  const std::vector<PlanePoint> line{{{0, 0}, {0, 0}}, {{1, 1}, {1, 1}}, {{2, 2}, {2, 2}}, {{3, 3}, {3, 3}}};
  EXPECT_THROW(PlaneView({}, line), InvalidInput);
  EXPECT_THROW(PlaneView({}, std::vector<PlanePoint>(line.begin(), line.begin() + 3)), InvalidInput);
}

TEST(QuadEdges, CornersOfABlurredSquareAreWithinATwentiethOfAPixel) {
  const Photograph photo{.to_picture = tilted(700, {320, 240}, {0.5, -0.4, 0.3}, {-10, 10, 260}),
                         .camera = view_lens,
                         .blur = 1.3,
                         .noise = 5};
  const RgbImage picture = render(photo, [](const Vec2& place) {
    const Vec2 middle = place - Vec2(10, 10);
    const double side = std::max(std::abs(middle.x()), std::abs(middle.y()));
    return side < 10 && side > 6 ? ink : paper;
  });
  std::array<Vec2, 4> truth, rough;
  const std::array<Vec2, 4> places{Vec2(0, 20), Vec2(20, 20), Vec2(20, 0), Vec2(0, 0)};
  for (std::size_t i = 0; i < 4; ++i) {
    truth[i] = ideal_pixel(photo, places[i]);
    rough[i] = seen_pixel(photo, places[i]) + Vec2(i % 2 == 0 ? 1.2 : -0.9, 0.8);
  }
  const auto corners = refine_quad(picture, rough, 0.2, view_lens);
  ASSERT_TRUE(corners.has_value());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(((*corners)[i] - truth[i]).norm(), 0.05) << i;
  // nothing there
  for (Vec2& corner : rough) corner += Vec2(150, 100);
  EXPECT_FALSE(refine_quad(picture, rough, 0.2, view_lens).has_value());
}

TEST(Board, ReadsWhatItSaysAndRefusesTheRestByName) {
  const BoardSpec grid = parse_board("5x4,tag=12mm,gap=0.3cm,dictionary=5x5_100,first=3");
  EXPECT_EQ(grid.columns, 5);
  EXPECT_EQ(grid.rows, 4);
  EXPECT_DOUBLE_EQ(grid.gap, 3);
  EXPECT_EQ(grid.dictionary, "5x5_100");
  EXPECT_DOUBLE_EQ(grid.width(), 72);
  EXPECT_EQ(grid_corner(grid, 0, 0), Vec2(0, 57));
  EXPECT_EQ(grid_corner(grid, 19, 2), Vec2(72, 0));
  EXPECT_EQ(grid_corner(grid, 6, 3), Vec2(15, 30));
  EXPECT_EQ(parse_board("charuco,7x5,square=10mm,tag=7mm").tags(), 17);
  EXPECT_DOUBLE_EQ(parse_board("checker,9x6,square=1in").height(), 152.4);
  for (const auto& [text, part] : {std::pair{"5x4,tag=12,gap=3mm", "'12' has no unit"},
                                   {"5x4,tag=12mm", "gap"},
                                   {"5x4,gap=3mm", "tag"},
                                   {"5x4,tag=12mm,gap=3kg", "'3kg'"},
                                   {"5x4,tag=-12mm,gap=3mm", "'-12mm'"},
                                   {"5by4,tag=12mm,gap=3mm", "5by4"},
                                   {"0x4,tag=12mm,gap=3mm", "0x4"},
                                   {"tag=12mm,gap=3mm", "columns x rows"},
                                   {"5x4,tags=12mm,gap=3mm", "did you mean 'tag'"},
                                   {"checker,9x6", "square"},
                                   {"charuco,7x5,square=10mm,tag=12mm", "smaller"},
                                   {"checker,2x6,square=10mm", "3x3"},
                                   {"", "columns"}}) {
    const std::string message = message_of([&, &text = text] { (void)parse_board(text); });
    EXPECT_NE(message.find(part), std::string::npos) << text << ": " << message;
  }
}

}  // namespace
