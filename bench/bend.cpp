#include "bend.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <optional>

namespace softkin::bench {

namespace {

constexpr double angle_tolerance = 0.05;  // [degrees]

Points centred(const Points& positions, const std::vector<Index>& vertices) {
  Points points(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) = positions.row(vertices[i]);
  const Eigen::RowVector3d mean = points.colwise().mean();
  return points.rowwise() - mean;
}

/// Walks along the equilibria of growing volume.
class Walk {
 public:
  Walk(const Model& model, const Statics& statics, const std::vector<Index>& face, const StaticsOptions& options)
      : model_(model), statics_(statics), options_(options), bend_(model.rest, face) {
    here_.state = statics.rest();
    here_.tip = model.markers.at(0).point.at(model.rest);
  }

  /// Goes on to the first shape that is bent by the angle.
  std::optional<BentShape> to(double angle) {
    while (here_.degrees < angle - angle_tolerance) {
      const double ratio = here_.ratio + step_;
      if (ratio > model_.actuators[0].high) return std::nullopt;
      const std::optional<BentShape> next = solve(ratio);
      if (!next) {
        step_ /= 2;
        if (step_ < 1e-4) return std::nullopt;
        continue;
      }
      const double turned = std::abs(next->degrees - here_.degrees);
      if (turned > largest_turn) {
        step_ /= 2;
        continue;
      }
      if (next->degrees > angle + angle_tolerance) return close_in(*next, angle);
      advance(*next);
      if (turned < largest_turn / 4) step_ *= 1.5;
    }
    return here_;
  }

 private:
  static constexpr double largest_turn = 60;  // of a step [degrees]

  [[nodiscard]] std::optional<BentShape> solve(double ratio) const {
    const Equilibrium found = statics_.solve(Actuation::Constant(1, ratio), here_.state, options_);
    if (found.report.status != Status::converged) return std::nullopt;
    BentShape shape;
    shape.state = found.state;
    shape.ratio = ratio;
    shape.pressure = found.state.multipliers[0];
    Bend bend = bend_;
    shape.degrees = bend.follow(found.state.positions);
    shape.tip = model_.markers[0].point.at(found.state.positions);
    return shape;
  }

  /// The angle lies between here_ and beyond: regula falsi, halved where it creeps.
  std::optional<BentShape> close_in(const BentShape& beyond, double angle) {
    double low = here_.ratio, high = beyond.ratio;
    double low_miss = here_.degrees - angle, high_miss = beyond.degrees - angle;
    for (int attempt = 0; attempt < 40; ++attempt) {
      const double share = attempt % 4 == 3 ? 0.5 : -low_miss / (high_miss - low_miss);
      const std::optional<BentShape> shape = solve(low + share * (high - low));
      if (!shape) return std::nullopt;
      const double miss = shape->degrees - angle;
      if (std::abs(miss) <= angle_tolerance) {
        advance(*shape);
        return shape;
      }
      (miss < 0 ? low : high) = shape->ratio;
      (miss < 0 ? low_miss : high_miss) = miss;
    }
    return std::nullopt;
  }

  void advance(const BentShape& shape) {
    bend_.follow(shape.state.positions);
    here_ = shape;
  }

  const Model& model_;
  const Statics& statics_;
  StaticsOptions options_;
  Bend bend_;
  BentShape here_;
  double step_ = 0.05;  // of the ratio
};

}  // namespace

Bend::Bend(const Points& rest, std::vector<Index> face) : face_(std::move(face)), rest_(centred(rest, face_)) {}

double Bend::follow(const Points& positions) {
  const Mat3 correlation = centred(positions, face_).transpose() * rest_;
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 mirrored = svd.matrixU() * svd.matrixV().transpose();
  const Vec3 signs(1, 1, mirrored.determinant() < 0 ? -1 : 1);
  const Mat3 rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const double angle = std::atan2(rotation(0, 2) - rotation(2, 0), rotation(0, 0) + rotation(2, 2));
  const double turn = angle * 180 / std::numbers::pi - degrees_;
  degrees_ += turn - 360 * std::round(turn / 360);
  return degrees_;
}

std::vector<BentShape> find_bends(const Model& model, const Statics& statics, const std::vector<Index>& face,
                                  const std::vector<double>& angles, const StaticsOptions& options) {
  Walk walk(model, statics, face, options);
  std::vector<BentShape> shapes;
  for (const double angle : angles) {
    const std::optional<BentShape> shape = walk.to(angle);
    if (!shape) break;
    shapes.push_back(*shape);
  }
  return shapes;
}

}  // namespace softkin::bench
