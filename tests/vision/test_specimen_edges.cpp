#include <gtest/gtest.h>

#include <numbers>
#include <softkin/core/error.hpp>
#include <softkin/vision/specimen_edges.hpp>
#include <vision/rendering.hpp>

namespace {

using namespace softkin;
using namespace softkin::testing;
using namespace softkin::vision;

const Colour a("red"), b("blue");

Photograph photograph(unsigned seed) {
  return {.to_picture = straight(8, {60, 400}), .blur = 1.1, .noise = 5, .seed = seed};
}

/// mm of the view, whose origin is the first pixel, at a place of the bar's plane.
PlaneView view_of(const Photograph& photo) {
  return PlaneView({}, 1 / 8.0).moved(Vec2(photo.to_picture(0, 2), -photo.to_picture(1, 2)) / 8, 0);
}

TEST(Specimen, LengthsAreWithinATenthOfAPixelAndTheRatioFollows) {
  const BarPaint rest{{5.03, 20.1}, 0.07, 21.37, 52.11, 11.3};
  BarPaint pulled = rest;
  pulled.interface = 22.92;  // strain of A 0.0725, of B 0.341
  pulled.length = 64.95;
  const Photograph first = photograph(1), second = photograph(2);
  const Stretch stretch{find_specimen(render(first, rest), a, b, view_of(first)),
                        find_specimen(render(second, pulled), a, b, view_of(second))};
  const double tenth = 0.1 / 8;
  EXPECT_NEAR(stretch.rest.length(), 52.11, tenth);
  EXPECT_NEAR(stretch.rest.interface_length(), 21.37, tenth);
  EXPECT_NEAR(stretch.elongation(), 12.84, tenth);
  EXPECT_NEAR(stretch.shift(), 1.55, tenth);
  EXPECT_NEAR(stretch.rest.axis, 0.07 * 180 / std::numbers::pi, 0.1);
  EXPECT_NEAR(stretch.rest.interface.slant, 0, 0.3);
  EXPECT_LT((stretch.rest.fixed.place - rest.start).norm(), 2 * tenth);
  const double strain_a = 1.55 / 21.37, strain_b = (12.84 - 1.55) / (52.11 - 21.37);
  EXPECT_NEAR(stretch.elasticity_ratio(), strain_b / strain_a, 0.02 * strain_b / strain_a);
  EXPECT_NEAR(stretch.elasticity_ratio(), strain_b / strain_a, 4 * stretch.elasticity_ratio_error());
  std::printf("L %+.4f, L_1 %+.4f, dL %+.4f, dL_1 %+.4f mm off; R_m %.3f +- %.3f, true %.3f\n",
              stretch.rest.length() - 52.11, stretch.rest.interface_length() - 21.37, stretch.elongation() - 12.84,
              stretch.shift() - 1.55, stretch.elasticity_ratio(), stretch.elasticity_ratio_error(),
              strain_b / strain_a);
}

TEST(Specimen, ReportedErrorsAreThoseOfRepetition) {
  const BarPaint bar{{4, 10}, 0.1, 12, 30, 6};
  double squares = 0, expected = 0, mean = 0;
  constexpr int shots = 12;
  std::vector<double> lengths;
  for (unsigned k = 0; k < shots; ++k) {
    Photograph photo = photograph(k + 1);
    photo.width = 340;
    photo.height = 200;
    photo.to_picture = straight(8, {30, 180});
    const SpecimenView view = find_specimen(render(photo, bar), a, b, view_of(photo));
    lengths.push_back(view.length());
    mean += view.length() / shots;
    expected += std::pow(view.length_error(), 2) / shots;
  }
  for (const double length : lengths) squares += std::pow(length - mean, 2) / (shots - 1);
  EXPECT_NEAR(mean, 30, 0.01);
  EXPECT_LT(std::sqrt(squares), 2.5 * std::sqrt(expected));
  EXPECT_GT(std::sqrt(squares), 0.3 * std::sqrt(expected));
}

TEST(Specimen, SlantOfATwistedInterface) {
  for (const double degrees : {-25.0, 10.0, 35.0}) {
    BarPaint bar{{5, 20}, 0.2, 24, 52, 11};
    bar.slant = degrees * std::numbers::pi / 180;
    const Photograph photo = photograph(4);
    const SpecimenView view = find_specimen(render(photo, bar), a, b, view_of(photo));
    EXPECT_NEAR(view.interface.slant, degrees, 0.3);
    EXPECT_NEAR(view.free.slant, 0, 0.4);
    EXPECT_NEAR(view.interface_length(), 24, 0.02);
    // from the other end the slant is the same, for both axes turn by 180 degrees
    EXPECT_NEAR(find_specimen(render(photo, bar), b, a, view_of(photo)).interface.slant, degrees, 0.3);
  }
}

TEST(Specimen, PerspectiveIsTakenOut) {
  const BarPaint bar{{5, 20}, 0.1, 21.5, 60, 12};
  const Photograph photo{.to_picture = tilted(800, {320, 240}, {0.5, 0.3, 0}, {-35, 20, 110}), .blur = 1, .noise = 4};
  std::vector<PlanePoint> points;
  for (const Vec2& place : {Vec2(0, 0), Vec2(70, 0), Vec2(70, 40), Vec2(0, 40)})
    points.push_back({ideal_pixel(photo, place), place});
  const SpecimenView view = find_specimen(render(photo, bar), a, b, PlaneView({}, points));
  EXPECT_NEAR(view.length(), 60, 0.05);
  EXPECT_NEAR(view.interface_length(), 21.5, 0.05);
}

TEST(Specimen, RefusesWhatIsNoSpecimen) {
  Photograph photo = photograph(1);
  const auto refused = [&](const Paint& paint, const Colour& one, const Colour& other) -> std::string {
    try {
      (void)find_specimen(render(photo, paint), one, other, view_of(photo));
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "found";
  };
  const BarPaint bar{{5, 20}, 0.1, 21.5, 50, 12};
  BarPaint outside = bar;
  outside.length = 90;
  EXPECT_NE(refused(bar, a, Colour("green")).find("that is green found"), std::string::npos);
  EXPECT_NE(refused(outside, a, b).find("blue is partly outside the frame"), std::string::npos);
  const Paint apart = [&](const Vec2& place) {
    return place.x() > 22 && place.x() < 28 ? paper : Eigen::Vector3d(bar(place));
  };
  EXPECT_NE(refused(apart, a, b).find("do not meet"), std::string::npos) << refused(apart, a, b);
  const Paint two = [&](const Vec2& place) {
    return Eigen::Vector3d(bar(place.y() > 35 ? Vec2(place - Vec2(0, 22)) : place));
  };
  EXPECT_NE(refused(two, a, b).find("two candidates"), std::string::npos) << refused(two, a, b);
}

}  // namespace
