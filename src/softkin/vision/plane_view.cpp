#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/plane_view.hpp>
#include <utility>

namespace softkin::vision {

namespace {

using Map = Eigen::Matrix3d;

Vec2 mapped(const Map& map, const Vec2& point) {
  return (map * point.homogeneous()).hnormalized();
}

/// Derivative of the map's value by its first 8 entries, the ninth being 1.
Eigen::Matrix<double, 2, 8> by_entries(const Map& map, const Vec2& point) {
  const double w = map.row(2).dot(point.homogeneous());
  const Vec2 value = mapped(map, point);
  Eigen::Matrix<double, 2, 8> result;
  result << point.x(), point.y(), 1, 0, 0, 0, -value.x() * point.x(), -value.x() * point.y(),  //
      0, 0, 0, point.x(), point.y(), 1, -value.y() * point.x(), -value.y() * point.y();
  return result / w;
}

/// To the last digits of single precision, which OpenCV computes it in.
Map first_guess(const std::vector<PlanePoint>& points) {
  std::vector<cv::Point2d> places, pixels;
  for (const PlanePoint& point : points) {
    places.emplace_back(point.place.x(), point.place.y());
    pixels.emplace_back(point.pixel.x(), point.pixel.y());
  }
  Map result = Map::Constant(NAN);
  if (const cv::Mat map = cv::findHomography(places, pixels); !map.empty()) cv::cv2eigen(map, result);
  return result;
}

}  // namespace

PlaneView::PlaneView(std::optional<Camera> camera, double mm_per_pixel) : camera_(std::move(camera)) {
  to_plane_ = Eigen::Vector3d(mm_per_pixel, -mm_per_pixel, 1).asDiagonal();
  fitted_ = to_picture_ = to_plane_.inverse();
}

PlaneView::PlaneView(std::optional<Camera> camera, const std::vector<PlanePoint>& points) : camera_(std::move(camera)) {
  if (points.size() < 4) throw InvalidInput("a plane is found from four points or more");
  fitted_ = first_guess(points);
  const Eigen::Index n = static_cast<Eigen::Index>(2 * points.size());
  Eigen::Matrix<double, Eigen::Dynamic, 8> rows(n, 8);
  Eigen::VectorXd miss(n);
  for (int round = 0;; ++round) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(2 * k);
      rows.middleRows<2>(i) = by_entries(fitted_, points[k].place);
      miss.segment<2>(i) = points[k].pixel - mapped(fitted_, points[k].place);
    }
    const Eigen::Matrix<double, 8, 1> size = rows.colwise().norm().cwiseInverse();
    rows *= size.asDiagonal();  // entries of the map differ in size
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(rows);
    solver.setThreshold(1e-6);
    if (!rows.allFinite() || solver.rank() < 8)
      throw InvalidInput("the points of the plane lie on a line: its perspective cannot be found");
    if (round == 5) {
      // an exact fit of four points says nothing about their errors
      const double variance = n > 8 ? miss.squaredNorm() / static_cast<double>(n - 8) : 0;
      covariance_ = variance * size.asDiagonal() * (rows.transpose() * rows).inverse() * size.asDiagonal();
      break;
    }
    Eigen::Matrix<double, 9, 1> step = Eigen::Matrix<double, 9, 1>::Zero();
    step.head<8>() = size.cwiseProduct(solver.solve(miss));
    fitted_ += step.reshaped<Eigen::RowMajor>(3, 3);
  }
  residual_ = std::sqrt(miss.squaredNorm() / static_cast<double>(points.size()));
  to_picture_ = fitted_;
  to_plane_ = to_picture_.inverse();
}

Vec2 PlaneView::ideal(const Vec2& seen) const {
  return camera_ ? undistorted(*camera_, seen) : seen;
}

Vec2 PlaneView::ideal_to_mm(const Vec2& ideal) const {
  return mapped(to_plane_, ideal);
}

Vec2 PlaneView::to_mm(const Vec2& seen) const {
  return mapped(to_plane_, ideal(seen));
}

Vec2 PlaneView::to_pixel(const Vec2& place) const {
  const Vec2 pixel = mapped(to_picture_, place);
  return camera_ ? distorted(*camera_, pixel) : pixel;
}

double PlaneView::pixel_area(const Vec2& seen) const {
  Eigen::Matrix2d sides;
  sides << to_mm(seen + Vec2(0.5, 0)) - to_mm(seen - Vec2(0.5, 0)),
      to_mm(seen + Vec2(0, 0.5)) - to_mm(seen - Vec2(0, 0.5));
  return std::abs(sides.determinant());
}

double PlaneView::error_at(const Vec2& seen) const {
  const Vec2 place = mapped(fitted_.inverse(), ideal(seen));
  const Eigen::Matrix<double, 2, 8> rows = by_entries(fitted_, place);
  const Eigen::Vector3d image = fitted_ * place.homogeneous();
  // derivative of the pixel by the place, to bring the error of the pixel to the plane
  const Eigen::Matrix2d slope =
      (fitted_.topLeftCorner<2, 2>() - image.hnormalized() * fitted_.block<1, 2>(2, 0)) / image.z();
  const Eigen::Matrix<double, 2, 8> in_plane = slope.inverse() * rows;
  return std::sqrt((in_plane * covariance_ * in_plane.transpose()).trace() / 2);
}

PlaneView PlaneView::moved(const Vec2& origin, double angle) const {
  PlaneView result = *this;
  result.to_plane_ = (Eigen::Rotation2Dd(-angle) * Eigen::Translation2d(-origin)).matrix() * to_plane_;
  result.to_picture_ = result.to_plane_.inverse();
  return result;
}

}  // namespace softkin::vision
