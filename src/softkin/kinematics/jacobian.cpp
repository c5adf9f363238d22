#include <softkin/core/error.hpp>
#include <softkin/kinematics/jacobian.hpp>

namespace softkin {

Eigen::MatrixXd jacobian(const Model& model, const Points& positions, const Sensitivity& sensitivity,
                         const std::vector<Index>& markers) {
  Eigen::MatrixXd result(3 * std::ssize(markers), sensitivity.positions.size());
  for (std::size_t p = 0; p < markers.size(); ++p) {
    if (markers[p] < 0 || markers[p] >= std::ssize(model.markers))
      throw InvalidInput("the robot has no marker number " + std::to_string(markers[p]));
    const Marker& marker = model.markers[markers[p]];
    for (std::size_t a = 0; a < sensitivity.positions.size(); ++a)
      result.block<3, 1>(3 * p, a) = marker.velocity(positions, sensitivity.positions[a]);
  }
  return result;
}

Eigen::MatrixXd jacobian(const Statics& statics, const Equilibrium& equilibrium, const std::vector<Index>& markers) {
  return jacobian(statics.model(), equilibrium.state.positions, statics.sensitivity(equilibrium.state), markers);
}

Vec3 marker_slope(const Model& model, const Perturbed& number, std::size_t marker, const Points& positions,
                  const Points& moves) {
  const Vec3 own =
      (number.more.markers[marker].at(positions) - number.less.markers[marker].at(positions)) / number.difference;
  return model.markers[marker].velocity(positions, moves) + own;
}

}  // namespace softkin
