#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/knowledge.hpp>

namespace softkin::estimate {

namespace {

/// A variance below this fraction of the prior one belongs to a fixed direction, such as the normal of a flat patch.
constexpr double held = 1e-8;

Eigen::MatrixXd covariance_before(const Variables& variables) {
  const Index numbers = variables.numbers(), size = numbers + 3 * std::ssize(variables.forces());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  for (Index i = 0; i < numbers; ++i) {
    const double deviation = variables.all()[i].deviation;
    covariance(i, i) = deviation * deviation;
  }
  for (std::size_t f = 0; f < variables.forces().size(); ++f) {
    const Index first = numbers + 3 * f;
    covariance.block<3, 3>(first, first) = variables.forces()[f].patch->covariance();
  }
  return covariance;
}

Eigen::VectorXd mean_before(const Variables& variables) {
  const Index numbers = variables.numbers();
  Eigen::VectorXd mean(numbers + 3 * std::ssize(variables.forces()));
  mean.head(numbers) = variables.means();
  for (std::size_t f = 0; f < variables.forces().size(); ++f)
    mean.segment<3>(numbers + 3 * f) = variables.forces()[f].patch->middle();
  return mean;
}

/// Returns the pseudoinverse of a covariance, computed in coordinates scaled by their prior standard deviations.
Eigen::MatrixXd information_of(const Variables& variables, const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd units(covariance.rows());
  for (Index i = 0; i < variables.numbers(); ++i) units[i] = variables.all()[i].deviation;
  for (std::size_t f = 0; f < variables.forces().size(); ++f)
    units.segment<3>(variables.numbers() + 3 * f)
        .setConstant(std::sqrt(variables.forces()[f].patch->covariance().trace()));
  const Eigen::VectorXd inverse_units = units.cwiseInverse();
  const SymmetricEigen eigen = symmetric_eigen(inverse_units.asDiagonal() * covariance * inverse_units.asDiagonal());
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(covariance.rows(), covariance.rows());
  for (Index k = 0; k < std::ssize(eigen.values); ++k)
    if (eigen.values[k] > held) inverse += eigen.vectors.col(k) * eigen.vectors.col(k).transpose() / eigen.values[k];
  return inverse_units.asDiagonal() * inverse * inverse_units.asDiagonal();
}

}  // namespace

Eigen::VectorXd coordinates_of(const Variables& variables, const Eigen::VectorXd& values,
                               const std::vector<Place>& places) {
  Eigen::VectorXd coordinates(variables.numbers() + 3 * std::ssize(places));
  coordinates.head(variables.numbers()) = values;
  for (std::size_t f = 0; f < places.size(); ++f)
    coordinates.segment<3>(variables.numbers() + 3 * f) =
        variables.forces()[f].patch->at(places[f], variables.model().rest);
  return coordinates;
}

Eigen::MatrixXd directions_at(const Variables& variables, const std::vector<Place>& places) {
  const Index numbers = variables.numbers();
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(numbers + 3 * std::ssize(places), variables.columns());
  directions.topLeftCorner(numbers, numbers).setIdentity();
  for (std::size_t f = 0; f < places.size(); ++f)
    directions.block<3, 2>(numbers + 3 * f, numbers + 2 * f) = variables.forces()[f].patch->tangents(places[f]);
  return directions;
}

Knowledge::Knowledge(const Variables& variables)
    : mean(mean_before(variables)), information(information_of(variables, covariance_before(variables))) {}

double Knowledge::value(const Variables& variables, const Eigen::VectorXd& values,
                        const std::vector<Place>& places) const {
  const Eigen::VectorXd off = coordinates_of(variables, values, places) - mean;
  double value = off.dot(information * off);
  if (memory == nullptr) return value;
  const Eigen::VectorXd y = memory->at(values, places);
  return value + y.dot(memory->information() * y) - 2 * memory->pull().dot(y);
}

Knowledge::Cost Knowledge::cost(const Variables& variables, const Eigen::VectorXd& values,
                                const std::vector<Place>& places) const {
  const Eigen::MatrixXd directions = directions_at(variables, places);
  const Eigen::VectorXd off = coordinates_of(variables, values, places) - mean;
  Cost cost{directions.transpose() * information * directions, directions.transpose() * (information * off),
            value(variables, values, places)};
  if (memory == nullptr) return cost;
  const Eigen::MatrixXd slopes = memory->slopes(values, places);
  cost.matrix += slopes.transpose() * memory->information() * slopes;
  cost.gradient += slopes.transpose() * (memory->information() * memory->at(values, places) - memory->pull());
  return cost;
}

}  // namespace softkin::estimate
