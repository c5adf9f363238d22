#include <gtest/gtest.h>

#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/vision/camera.hpp>

#include "board_paint.hpp"

namespace {

using namespace softkin;
using namespace softkin::testing;
using namespace softkin::vision;

const Camera lens{.width = 640,
                  .height = 480,
                  .fx = 655,
                  .fy = 657,
                  .cx = 326,
                  .cy = 235,
                  .k1 = -0.25,
                  .k2 = 0.08,
                  .p1 = 0.0008,
                  .p2 = -0.0006};

Photograph shot_of(const BoardSpec& board, unsigned i, double tilt) {
  const double angle = 0.9 * i;
  const Eigen::Vector3d turns(tilt * std::sin(angle), tilt * std::cos(angle), 0.1 * i);
  Photograph photo{.camera = lens, .blur = 0.8, .noise = 4, .seed = i + 1};
  // the board's middle, a little to each side
  const Eigen::Matrix3d at_origin = tilted(lens.fx, {lens.cx, lens.cy}, turns, {0, 0, 150});
  const Vec2 middle(board.width() / 2, board.height() / 2);
  Eigen::Matrix3d shift;
  shift << 1, 0, -middle.x() + 8 * std::cos(2.1 * i), 0, 1, -middle.y() + 5 * std::sin(1.7 * i), 0, 0, 1;
  photo.to_picture = at_origin * shift;
  return photo;
}

std::vector<BoardSight> sights_of(const BoardSpec& board, unsigned count, double tilt) {
  std::vector<BoardSight> sights;
  for (unsigned i = 0; i < count; ++i)
    sights.push_back({"shot " + std::to_string(i),
                      find_board(render(shot_of(board, i, tilt), BoardPaint(board, {0, 0})), board, std::nullopt)});
  return sights;
}

class CameraFit : public ::testing::TestWithParam<const char*> {};

TEST_P(CameraFit, FindsTheLensThatTookThePictures) {
  std::vector<double> errors;
  const Camera found = fit_camera(sights_of(parse_board(GetParam()), 8, 0.55), 640, 480, errors);
  std::printf("%s: fx %.2f +- %.2f (655), cx %.2f (326), k1 %.4f (-0.25), reprojection %.3f pixel\n", GetParam(),
              found.fx, found.focal_error, found.cx, found.k1, found.reprojection_error);
  EXPECT_NEAR(found.fx, 655, 3);
  EXPECT_NEAR(found.fy, 657, 3);
  EXPECT_NEAR(found.fx, 655, 4 * found.focal_error);
  EXPECT_LT(found.reprojection_error, 0.15);
  EXPECT_EQ(errors.size(), 8U);
  // compares undistorted pixels, up to a translation and rotation of the whole
  for (const Vec2& seen : {Vec2(120, 100), Vec2(520, 110), Vec2(500, 380), Vec2(130, 370)}) {
    const Vec2 a = undistorted(found, seen) - seen, b = undistorted(lens, seen) - seen;
    EXPECT_LT((a - b).norm(), 1.0) << seen.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Boards, CameraFit,
                         ::testing::Values("checker,10x7,square=9mm", "charuco,10x7,square=9mm,tag=6.5mm"));

TEST(CameraFits, RefusesPicturesThatDoNotFixIt) {
  const BoardSpec board = parse_board("checker,10x7,square=9mm");
  std::vector<double> errors;
  EXPECT_THROW((void)fit_camera(sights_of(board, 3, 0.5), 640, 480, errors), InvalidInput);
  EXPECT_THROW((void)fit_camera(sights_of(board, 4, 0.0), 640, 480, errors), InvalidInput);
}

}  // namespace
