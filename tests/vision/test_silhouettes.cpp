#include <gtest/gtest.h>

#include <cmath>
#include <softkin/vision/measurements.hpp>
#include <softkin/vision/silhouettes.hpp>
#include <vision/rendering.hpp>

namespace {

using namespace softkin;
using namespace softkin::testing;
using namespace softkin::vision;

constexpr double pixels_in_mm = 5;  // in a mm

Photograph camera_above() {
  return {.width = 360, .height = 260, .to_picture = straight(pixels_in_mm, {180, 130}), .blur = 1, .noise = 4};
}

PlaneView view_from_above(const Photograph& photo) {
  const Vec2 origin(photo.to_picture(0, 2), photo.to_picture(1, 2));
  const PlaneView plain({}, 1 / pixels_in_mm);
  return plain.moved(plain.to_mm(origin), 0);
}

/// An ellipse about the origin, turned.
Paint ellipse(double a, double b, double turn, const Eigen::Vector3d& colour, const Eigen::Vector3d& ground) {
  return [=](const Vec2& place) -> Eigen::Vector3d {
    const double u = std::cos(turn) * place.x() + std::sin(turn) * place.y(),
                 v = std::cos(turn) * place.y() - std::sin(turn) * place.x();
    return u * u / (a * a) + v * v / (b * b) < 1 ? colour : ground;
  };
}

Silhouette silhouette_in(const Paint& paint, const std::string& look, const Photograph& photo = camera_above()) {
  return find_silhouette(render(photo, paint), SilhouetteLook(look), view_from_above(photo));
}

TEST(Silhouettes, ADarkDiscHasItsRadius) {
  const double radius = 18.3;
  const Vec2 centre(2.4, -1.1);
  const Silhouette disc = silhouette_in(discs_on({{centre, radius, ink}}), "dark");
  ASSERT_GT(disc.points.size(), 200u);
  EXPECT_LE(disc.points.size(), 400u);
  double sum = 0;
  for (const Vec2& point : disc.points) {
    EXPECT_NEAR((point - centre).norm(), radius, 0.4 / pixels_in_mm);
    sum += (point - centre).norm();
  }
  EXPECT_NEAR(sum / double(disc.points.size()), radius, 0.1 / pixels_in_mm);
  EXPECT_NEAR(disc.area, M_PI * radius * radius, 0.003 * M_PI * radius * radius);
  EXPECT_NEAR(disc.length, 2 * M_PI * radius, 0.005 * 2 * M_PI * radius);
  EXPECT_FALSE(disc.cut);
}

TEST(Silhouettes, ABrightEllipseOnDarkGroundHasItsArea) {
  const double a = 25, b = 9;
  const Silhouette bright = silhouette_in(ellipse(a, b, 0.4, paper, ink), "bright"),
                   dark = silhouette_in(ellipse(a, b, 0.4, ink, paper), "dark");
  for (const Silhouette& silhouette : {bright, dark}) {
    EXPECT_NEAR(silhouette.area, M_PI * a * b, 0.005 * M_PI * a * b);
    const double h = std::pow((a - b) / (a + b), 2);  // Ramanujan 1914
    const double length = M_PI * (a + b) * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)));
    EXPECT_NEAR(silhouette.length, length, 0.01 * length);
  }
}

TEST(Silhouettes, AColouredDiscHasItsRadius) {
  const double radius = 20;
  const Paint paint = discs_on({{{0, 0}, radius, red}, {{28, 18}, 4, red}, {{0, 0}, 7, blue}});
  const Silhouette disc = silhouette_in(paint, "red");
  ASSERT_GT(disc.points.size(), 200u);
  for (const Vec2& point : disc.points) EXPECT_NEAR(point.norm(), radius, 0.4 / pixels_in_mm);
  EXPECT_NEAR(disc.area, M_PI * radius * radius, 0.003 * M_PI * radius * radius);
  EXPECT_NEAR(disc.length, 2 * M_PI * radius, 0.01 * 2 * M_PI * radius);
}

/// A silhouette includes no hole and no part at the frame.
TEST(Silhouettes, HasNoHoleAndEndsAtTheFrame) {
  const Paint ring = discs_on({{{0, 0}, 8, paper}, {{0, 0}, 20, ink}});
  const Silhouette whole = silhouette_in(ring, "dark");
  for (const Vec2& point : whole.points) EXPECT_NEAR(point.norm(), 20, 0.1);
  const Vec2 centre(30, 0);  // the frame is at 36
  const Silhouette half = silhouette_in(discs_on({{centre, 15, ink}}), "dark");
  EXPECT_TRUE(half.cut);
  ASSERT_FALSE(half.points.empty());
  for (const Vec2& point : half.points) {
    EXPECT_NEAR((point - centre).norm(), 15, 0.1);
    EXPECT_LT(point.x(), 35.4);
  }
}

TEST(Silhouettes, AreRefusedWithAReason) {
  const auto refusal = [](const Paint& paint, const std::string& look) {
    return message_of([&] { (void)silhouette_in(paint, look); });
  };
  const Paint disc = discs_on({{{0, 0}, 10, ink}});
  EXPECT_NE(refusal(disc, "red").find("nothing that is red has 100 pixels or more"), std::string::npos);
  EXPECT_NE(refusal(disc, "bright").find("it is the ground behind the robot"), std::string::npos);
  EXPECT_NE(refusal([](const Vec2&) { return paper; }, "dark").find("the same brightness"), std::string::npos);
  EXPECT_NE(message_of([] { (void)SilhouetteLook("dakr"); }).find("no colour 'dakr'"), std::string::npos);
}

TEST(Silhouettes, AreATableOfPoints) {
  MeasureOptions options;
  options.scale = "0,0,100,0=20mm";
  options.outline = "dark";
  PhotoSeries series(options);
  series.add(render(camera_above(), discs_on({{{0, 0}, 10, ink}})), "a.png");
  series.add(render(camera_above(), discs_on({{{5, 3}, 12, ink}})), "b.png");
  const Table table = series.table();
  ASSERT_EQ(table.columns.size(), 3u);
  EXPECT_EQ(table.columns[1].key, "x_mm");
  Vec2 low = Vec2::Constant(1e9), high = -low;
  for (const Row& row : table.rows) {
    if (std::get<double>(row[0]) != 2) continue;
    const Vec2 point(std::get<double>(row[1]), std::get<double>(row[2]));
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  EXPECT_LT((low - Vec2(36 + 5 - 12, -26 + 3 - 12)).norm(), 0.1) << low.transpose();  // of the first pixel's centre
  EXPECT_LT((high - Vec2(36 + 5 + 12, -26 + 3 + 12)).norm(), 0.1) << high.transpose();
  EXPECT_NE(series.csv().find("# picture 2: b.png\n"), std::string::npos);
  EXPECT_NE(series.json().find("\"area_mm2\""), std::string::npos);
  EXPECT_EQ(series.shown_outlines().rows.size(), 2u);
  options.interface = "red,blue";
  EXPECT_NE(message_of([&] { (void)PhotoSeries(options); }).find("tables of their own"), std::string::npos);
}

}  // namespace
