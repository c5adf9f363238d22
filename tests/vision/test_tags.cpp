#include <gtest/gtest.h>

#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/dots.hpp>

#include "board_paint.hpp"

namespace {

using namespace softkin;
using namespace softkin::testing;
using namespace softkin::vision;

const Camera tag_lens{.width = 640,
                      .height = 480,
                      .fx = 720,
                      .fy = 722,
                      .cx = 318,
                      .cy = 243,
                      .k1 = -0.22,
                      .k2 = 0.07,
                      .p1 = 0.0006,
                      .p2 = -0.0005};

/// Largest error of the view over the board and around it, by its size [-].
double scale_error(const Photograph& photo, const PlaneView& view, const BoardSpec& board) {
  double worst = 0;
  const std::array<Vec2, 4> corners{Vec2(0, 0), Vec2(board.width(), 0), Vec2(board.width(), board.height()),
                                    Vec2(0, board.height())};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const Vec2 measured = view.to_mm(seen_pixel(photo, corners[i])) - view.to_mm(seen_pixel(photo, corners[j]));
      const double length = (corners[i] - corners[j]).norm();
      worst = std::max(worst, std::abs(measured.norm() - length) / length);
    }
  return worst;
}

TEST(Board, ScaleIsWithinAFifthOfAPercent) {
  double worst = 0;
  for (const char* text : {"5x4,tag=12mm,gap=3mm", "charuco,7x5,square=10mm,tag=7mm"})
    for (unsigned shot = 0; shot < 3; ++shot) {
      const BoardSpec board = parse_board(text);
      Photograph photo{.blur = 0.6 + 0.4 * shot, .noise = 5, .seed = shot + 1};
      if (shot == 0) photo.to_picture = tilted(720, {318, 243}, {0, 0, 0.05}, {-36, 28, 116});
      if (shot == 1) photo.to_picture = tilted(720, {318, 243}, {0.5, -0.3, 0.2}, {-30, 28, 130});
      if (shot == 2) photo.to_picture = tilted(720, {318, 243}, {-0.4, 0.5, -0.6}, {-35, 8, 150});
      if (shot > 0) photo.camera = tag_lens;
      const RgbImage picture = render(photo, BoardPaint(board, {0, 0}));
      const PlaneView view(photo.camera, find_board(picture, board, photo.camera));
      const double error = scale_error(photo, view, board);
      std::printf("%s, shot %u: residual %.3f pixel, scale %.4f %%\n", text, shot, view.residual(), 100 * error);
      worst = std::max(worst, error);
      EXPECT_LT(view.residual(), 0.15);
      // the frame: origin, and up is up
      EXPECT_LT((view.to_mm(seen_pixel(photo, {0, 0})) - Vec2(0, 0)).norm(), 0.05);
      EXPECT_LT((view.to_mm(seen_pixel(photo, {70, 50})) - Vec2(70, 50)).norm(), 0.08);
    }
  EXPECT_LT(worst, 0.002);
}

TEST(Board, DotsBesideItAreWithinThreeTenthsOfAPixelInPerspective) {
  const BoardSpec board = parse_board("5x4,tag=9mm,gap=3mm");
  const std::vector<Disc> discs{{{70, 10}, 3, red}, {{75, 40}, 2.5, blue}};
  const Photograph photo{.to_picture = tilted(720, {318, 243}, {0.55, 0.3, 0.1}, {-40, 22, 125}),
                         .camera = tag_lens,
                         .blur = 1,
                         .noise = 5};
  const RgbImage picture = render(photo, BoardPaint(board, {0, 0}, discs_on(discs)));
  const PlaneView view(tag_lens, find_board(picture, board, tag_lens));
  for (const auto& [disc, colour] : {std::pair{discs[0], "red"}, std::pair{discs[1], "blue"}}) {
    const MarkerPlace dot = find_dot(picture, Colour(colour), view, colour);
    const double pixel = std::sqrt(view.pixel_area(dot.pixel));
    std::printf("%s: %.3f pixel, standard error %.3f\n", colour, (dot.place - disc.centre).norm() / pixel,
                dot.error / pixel);
    EXPECT_LT((dot.place - disc.centre).norm() / pixel, 0.3);
    EXPECT_LT((dot.place - disc.centre).norm(), 5 * dot.error);
  }
}

TEST(Tags, CentresAreWithinATenthOfAPixel) {
  const BoardSpec three = parse_board("3x1,tag=12mm,gap=9.3mm,dictionary=5x5_100,first=7");
  for (unsigned shot = 0; shot < 3; ++shot) {
    Photograph photo{.blur = 0.7 + 0.4 * shot, .noise = 6, .seed = shot + 3};
    photo.to_picture = shot == 0 ? straight(7.1, {80.3, 300.4})
                                 : tilted(720, {318, 243}, {0.6 - 0.5 * shot, 0.4, 0.2 * shot}, {-28, 5, 110});
    if (shot > 0) photo.camera = tag_lens;
    const std::vector<Tag> tags = find_tags(render(photo, BoardPaint(three, {0, 0})), "5x5_100", photo.camera);
    ASSERT_EQ(tags.size(), 3U);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(tags[std::size_t(i)].number, 7 + i);
      const Vec2 truth = ideal_pixel(photo, {6 + 21.3 * i, 6});
      EXPECT_LT((tags[std::size_t(i)].centre() - truth).norm(), 0.1);
      EXPECT_LT((tags[std::size_t(i)].corners[0] - ideal_pixel(photo, {21.3 * i, 12})).norm(), 0.15);
    }
  }
}

TEST(Board, RefusesWhatIsNotThere) {
  const BoardSpec board = parse_board("5x4,tag=12mm,gap=3mm");
  Photograph photo{.to_picture = straight(6, {90, 430}), .blur = 0.7, .noise = 3};
  const RgbImage empty = render(photo, [](const Vec2&) { return paper; });
  const RgbImage picture = render(photo, BoardPaint(board, {0, 0}));
  const auto refused = [&](const RgbImage& shown, const std::string& text) {
    return message_of([&] { (void)find_board(shown, parse_board(text), std::nullopt); });
  };
  EXPECT_NE(refused(empty, "5x4,tag=12mm,gap=3mm").find("the board is not found: none of its 20 tags"),
            std::string::npos);
  EXPECT_NE(refused(empty, "checker,9x6,square=10mm").find("no 8 x 5 inner corners"), std::string::npos);
  EXPECT_NE(refused(empty, "charuco,7x5,square=10mm,tag=7mm").find("not found"), std::string::npos);
  EXPECT_NE(refused(picture, "5x4,tag=12mm,gap=3mm,first=18").find("too little of the board"), std::string::npos)
      << refused(picture, "5x4,tag=12mm,gap=3mm,first=18");
  EXPECT_NE(refused(picture, "9x9,tag=12mm,gap=3mm").find("dictionary 4x4_50 has 50"), std::string::npos);
  EXPECT_NE(refused(picture, "5x4,tag=12mm,gap=3mm,dictionary=4x4").find("no dictionary '4x4'"), std::string::npos);
  const BoardPaint row(parse_board("5x1,tag=12mm,gap=3mm"), {0, 0});
  const Paint twice = [&](const Vec2& place) { return row(place.y() > 30 ? Vec2(place - Vec2(0, 30)) : place); };
  photo.to_picture = straight(4, {30, 430});
  EXPECT_NE(refused(render(photo, twice), "5x4,tag=12mm,gap=3mm").find("twice"), std::string::npos);
}

}  // namespace
