#include <algorithm>
#include <softkin/model/model.hpp>

namespace softkin {

Vec3 EmbeddedPoint::at(const Points& positions) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < vertices.size(); ++i) sum += weights[i] * positions.row(vertices[i]).transpose();
  return sum;
}

Eigen::VectorXd Model::rest_actuation() const {
  Eigen::VectorXd ratios(static_cast<Eigen::Index>(actuators.size()));
  for (std::size_t i = 0; i < actuators.size(); ++i)
    ratios[static_cast<Eigen::Index>(i)] = std::clamp(actuators[i].rest, actuators[i].low, actuators[i].high);
  return ratios;
}

}  // namespace softkin
