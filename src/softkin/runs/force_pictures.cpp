#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/body_surface.hpp>
#include <softkin/runs/force_pictures.hpp>

namespace softkin::runs {

namespace {

/// Of the largest variance: a smaller one is none.
constexpr double min_fraction = 1e-12;

/// The two longest half axes of a covariance that hold 90 %.
std::array<Vec3, 2> axes_of(const Mat3& covariance) {
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const double most = eigen.values[2];
  std::array<Vec3, 2> axes{Vec3::Zero(), Vec3::Zero()};
  if (!(most > 0)) return axes;
  const bool flat = eigen.values[1] <= min_fraction * most;
  for (Index k = 0; k < (flat ? 1 : 2); ++k)
    axes[k] = (flat ? interval_90 : ellipse_90) * std::sqrt(eigen.values[2 - k]) * Vec3(eigen.vectors.col(2 - k));
  return axes;
}

/// What is left of it across a direction.
Mat3 across(const Mat3& covariance, const Vec3& direction) {
  if (!(direction.norm() > 0)) return covariance;
  const Vec3 along = direction.normalized();
  const Mat3 rest = Mat3::Identity() - along * along.transpose();
  return rest * covariance * rest;
}

/// The force that a number is a component of; "": of none.
std::string force_of(const Model& model, const EstimatedNumber& number) {
  if (number.actuator < 0) return "";
  const Actuator& actuator = model.actuators[number.actuator];
  const auto* force = actuator.as<ForceCommand>();
  if (!force) return "";
  const std::string end = std::string("_f") + axis_names[force->axis];
  return actuator.name.ends_with(end) ? actuator.name.substr(0, actuator.name.size() - end.size()) : "";
}

}  // namespace

ForcePictures::ForcePictures(const Model& model)
    : model_(model), triangles_(body_surface(model).triangles), surface_(model.rest, triangles_) {}

/// Its covariance at rest, carried along by the face that it is on: an ellipse stays in the surface as that turns.
std::array<Vec3, 2> ForcePictures::place_axes(const EstimatedPlace& place, const Points& positions) const {
  Index number = -1;
  (void)surface_.nearest(place.at_rest, &number);
  const Triangle& face = triangles_[number];
  const auto edges = [&](const Points& of) {
    Eigen::MatrixXd sides(3, 2);
    sides << vertex_at(of, face[1]) - vertex_at(of, face[0]), vertex_at(of, face[2]) - vertex_at(of, face[0]);
    return sides;
  };
  const Eigen::MatrixXd at_rest = edges(model_.rest), now = edges(positions);
  const Eigen::MatrixXd carried = now * least_squares_of_full_rank(at_rest, Eigen::MatrixXd::Identity(3, 3));
  return axes_of(Mat3(carried * place.covariance * carried.transpose()));
}

std::vector<ForcePicture> ForcePictures::of(const Estimate& reported) const {
  std::vector<ForcePicture> pictures;
  const auto command_of = [&](const EstimatedNumber& number) -> const ForceCommand& {
    return std::get<ForceCommand>(model_.actuators[number.actuator].drive);
  };
  for (const EstimatedNumber& number : reported.numbers) {
    const std::string name = force_of(model_, number);
    if (name.empty() ||
        std::any_of(pictures.begin(), pictures.end(), [&](const ForcePicture& p) { return p.name == name; }))
      continue;
    ForcePicture& picture = pictures.emplace_back();
    picture.name = name;
    std::array<Index, 3> rows{-1, -1, -1};  // of the covariance
    for (std::size_t n = 0; n < reported.numbers.size(); ++n) {
      if (force_of(model_, reported.numbers[n]) != name) continue;
      rows[command_of(reported.numbers[n]).axis] = n;
    }
    Mat3 covariance = Mat3::Zero();
    for (int i = 0; i < 3; ++i) {
      if (const auto a = find_actuator(model_, name + "_f" + axis_names[i])) picture.force[i] = reported.actuation[*a];
      for (int j = 0; j < 3; ++j) {
        const Index row = rows[i], column = rows[j];
        if (row >= 0 && column >= 0) covariance(i, j) = reported.covariance(row, column);
      }
    }
    const Vec3 along = picture.force.normalized();
    picture.deviation = std::sqrt(std::max(0.0, along.dot(covariance * along)));
    picture.across = axes_of(across(covariance, picture.force));
    const auto place = std::find_if(reported.places.begin(), reported.places.end(),
                                    [&](const EstimatedPlace& p) { return p.force == name; });
    if (place != reported.places.end()) {
      picture.at = place->present;
      picture.place = place_axes(*place, reported.state.positions);
    } else {
      const ForceCommand& force = command_of(number);
      const EmbeddedPoint& point = force.place ? *force.place : model_.bodies[force.body].center;
      picture.at = point.at(reported.state.positions);
    }
  }
  return pictures;
}

}  // namespace softkin::runs
