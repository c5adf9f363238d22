#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <softkin/calibration/plane_view.hpp>
#include <softkin/core/error.hpp>
#include <utility>

namespace softkin {

namespace {

using Mat3d = Eigen::Matrix3d;

Vec2 mapped(const Mat3d& map, const Vec2& point) {
  const Eigen::Vector3d image = map * point.homogeneous();
  return image.hnormalized();
}

/// Derivative of the map by the point.
Eigen::Matrix2d derivative(const Mat3d& map, const Vec2& point) {
  const Eigen::Vector3d image = map * point.homogeneous();
  const Vec2 value = image.hnormalized();
  return (map.topLeftCorner<2, 2>() - value * map.block<1, 2>(2, 0)) / image.z();
}

/// Derivative of the map's value by its first 8 entries, the ninth being 1.
Eigen::Matrix<double, 2, 8> by_entries(const Mat3d& map, const Vec2& point) {
  const double w = map.row(2).dot(point.homogeneous());
  const Vec2 value = mapped(map, point);
  Eigen::Matrix<double, 2, 8> result;
  result << point.x(), point.y(), 1, 0, 0, 0, -value.x() * point.x(), -value.x() * point.y(),  //
      0, 0, 0, point.x(), point.y(), 1, -value.y() * point.x(), -value.y() * point.y();
  return result / w;
}

/// To mean 0 and mean distance sqrt(2), so that the equations are of one size.
Mat3d normalizing(const std::vector<Vec2>& points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& point : points) mean += point / static_cast<double>(points.size());
  double spread = 0;
  for (const Vec2& point : points) spread += (point - mean).norm() / static_cast<double>(points.size());
  const double scale = std::sqrt(2.0) / spread;
  Mat3d result;
  result << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return result;
}

/// Direct linear transform.
Mat3d first_guess(const std::vector<Vec2>& from, const std::vector<Vec2>& to) {
  Eigen::MatrixXd system(2 * from.size(), 9);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::RowVector3d p = from[i].homogeneous().transpose();
    system.row(static_cast<Eigen::Index>(2 * i)) << p, 0, 0, 0, -to[i].x() * p;
    system.row(static_cast<Eigen::Index>(2 * i + 1)) << 0, 0, 0, p, -to[i].y() * p;
  }
  // least eigenvector: the singular vector of the system, also where it has but 8 rows
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(system.transpose() * system);
  const Eigen::Matrix<double, 9, 1> entries = solver.eigenvectors().col(0);
  if (!(solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[8]) || !(std::abs(entries[8]) > 1e-9))
    throw InvalidInput("the points of the plane lie on a line: its perspective cannot be found");
  Mat3d map;
  map << entries.segment<3>(0).transpose(), entries.segment<3>(3).transpose(), entries.segment<3>(6).transpose();
  return map / map(2, 2);
}

}  // namespace

PlaneView::PlaneView(std::optional<Camera> camera, double mm_per_pixel) : camera_(std::move(camera)) {
  to_plane_ << mm_per_pixel, 0, 0, 0, -mm_per_pixel, 0, 0, 0, 1;
  to_picture_ = to_plane_.inverse();
}

PlaneView::PlaneView(std::optional<Camera> camera, const std::vector<PlanePoint>& points)
    : camera_(std::move(camera)), perspective_(true) {
  if (points.size() < 4) throw InvalidInput("a plane is found from four points or more");
  std::vector<Vec2> from, to;
  for (const PlanePoint& point : points) from.push_back(point.place), to.push_back(point.pixel);
  const Mat3d scale_from = normalizing(from), scale_to = normalizing(to);
  for (Vec2& point : from) point = mapped(scale_from, point);
  for (Vec2& point : to) point = mapped(scale_to, point);
  Mat3d map = first_guess(from, to);
  Eigen::Matrix<double, 8, 8> normal;
  double squares = 0;
  for (int i = 0; i < 12; ++i) {
    normal.setZero();
    squares = 0;
    Eigen::Matrix<double, 8, 1> right = Eigen::Matrix<double, 8, 1>::Zero();
    for (std::size_t k = 0; k < from.size(); ++k) {
      const Eigen::Matrix<double, 2, 8> rows = by_entries(map, from[k]);
      const Vec2 miss = to[k] - mapped(map, from[k]);
      normal += rows.transpose() * rows;
      right += rows.transpose() * miss;
      squares += miss.squaredNorm();
    }
    const Eigen::Matrix<double, 8, 1> step = normal.ldlt().solve(right);
    if (i == 11 || step.norm() < 1e-14) break;
    map.row(0) += step.segment<3>(0).transpose();
    map.row(1) += step.segment<3>(3).transpose();
    map.block<1, 2>(2, 0) += step.segment<2>(6).transpose();
  }
  if (!map.allFinite()) throw InvalidInput("the points of the plane fit no view of it");
  const double unit = scale_to(0, 0);
  residual_ = std::sqrt(squares / static_cast<double>(points.size())) / unit;
  // an exact fit of four points says nothing about their errors
  const double freedom = 2 * static_cast<double>(points.size()) - 8;
  const double variance = freedom > 0 ? squares / freedom : 0;
  covariance_ = variance * normal.inverse();
  to_picture_ = scale_to.inverse() * map * scale_from;
  to_plane_ = to_picture_.inverse();
  fitted_to_plane_ = scale_from * to_plane_;  // to the normalized plane, in which the covariance is
  fitted_map_ = map;
  fitted_unit_ = unit;
}

Vec2 PlaneView::without_distortion(const Vec2& seen) const {
  return camera_ ? undistorted(*camera_, seen) : seen;
}

Vec2 PlaneView::ideal_to_mm(const Vec2& ideal) const {
  return mapped(to_plane_, ideal);
}

Vec2 PlaneView::to_mm(const Vec2& seen) const {
  return mapped(to_plane_, without_distortion(seen));
}

Vec2 PlaneView::to_pixel(const Vec2& place) const {
  const Vec2 ideal = mapped(to_picture_, place);
  return camera_ ? distorted(*camera_, ideal) : ideal;
}

double PlaneView::pixel_area(const Vec2& seen) const {
  if (!camera_) return std::abs(derivative(to_plane_, seen).determinant());
  const Vec2 right = to_mm(seen + Vec2(0.5, 0)) - to_mm(seen - Vec2(0.5, 0));
  const Vec2 down = to_mm(seen + Vec2(0, 0.5)) - to_mm(seen - Vec2(0, 0.5));
  return std::abs(right.x() * down.y() - right.y() * down.x());
}

double PlaneView::error_at(const Vec2& seen) const {
  const Vec2 ideal = without_distortion(seen);
  if (!perspective_) return 0;
  const Eigen::Matrix<double, 2, 8> rows = by_entries(fitted_map_, mapped(fitted_to_plane_, ideal));
  const Eigen::Matrix2d in_picture = rows * covariance_ * rows.transpose() / (fitted_unit_ * fitted_unit_);
  const Eigen::Matrix2d local = derivative(to_plane_, ideal);
  return std::sqrt((local * in_picture * local.transpose()).trace() / 2);
}

PlaneView PlaneView::moved(const Vec2& origin, double angle) const {
  const double c = std::cos(angle), s = std::sin(angle);
  Eigen::Matrix3d turn, shift;
  turn << c, s, 0, -s, c, 0, 0, 0, 1;
  shift << 1, 0, -origin.x(), 0, 1, -origin.y(), 0, 0, 1;
  PlaneView result = *this;
  result.to_plane_ = turn * shift * to_plane_;
  result.to_picture_ = result.to_plane_.inverse();
  return result;
}

}  // namespace softkin
