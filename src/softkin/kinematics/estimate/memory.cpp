#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/memory.hpp>

namespace softkin::estimate {

namespace {

/// A variance below this fraction of the largest one of a place belongs to a fixed direction, such as the normal of a
/// flat patch.
constexpr double min_spanned = 1e-8;

/// Returns M with M M^T equal to the covariance, without the directions that it does not span.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const double largest = eigen.values.maxCoeff();
  std::vector<Index> spanned;
  for (Index k = 0; k < std::ssize(eigen.values); ++k)
    if (eigen.values[k] > min_spanned * largest) spanned.push_back(k);
  Eigen::MatrixXd root(covariance.rows(), static_cast<Index>(spanned.size()));
  for (Index c = 0; c < std::ssize(spanned); ++c)
    root.col(c) = std::sqrt(eigen.values[spanned[c]]) * eigen.vectors.col(spanned[c]);
  return root;
}

/// Returns the covariance of the products of a force's components with the place's coordinates relative to its mean;
/// the component is the slower index, and both factors are independent.
Eigen::MatrixXd product_covariance(const Variables& variables, const FreeForce& force) {
  Mat3 squares = Mat3::Zero();
  Vec3 mean = Vec3::Zero();
  for (Index axis = 0; axis < 3; ++axis)
    if (const Index v = force.variables[axis]; v >= 0) {
      const Variable& variable = variables.all()[v];
      squares(axis, axis) = variable.deviation * variable.deviation;
      mean[axis] = variable.mean;
    }
  squares += mean * mean.transpose();
  Eigen::MatrixXd all(9, 9);
  for (Index a = 0; a < 3; ++a)
    for (Index b = 0; b < 3; ++b) all.block<3, 3>(3 * a, 3 * b) = squares(a, b) * force.patch->covariance();
  return all;
}

}  // namespace

Memory::Memory(const Variables& variables) : variables_(variables) {
  const Index numbers = variables.numbers(), size = numbers + 9 * std::ssize(variables.forces());
  mean_.setZero(size);
  mean_.head(numbers) = variables.means();
  from_y_.setZero(size, numbers);
  for (Index i = 0; i < numbers; ++i) from_y_(i, i) = variables.all()[i].deviation;
  for (std::size_t f = 0; f < variables.forces().size(); ++f) {
    const Eigen::MatrixXd root = root_of(product_covariance(variables, variables.forces()[f]));
    const Index columns = from_y_.cols(), more = root.cols();
    from_y_.conservativeResize(Eigen::NoChange, columns + more);
    from_y_.rightCols(more).setZero();
    from_y_.block(numbers + 9 * f, columns, 9, more) = root;
  }
  // columns are orthogonal
  to_y_ = from_y_.colwise().squaredNorm().cwiseInverse().transpose().asDiagonal() * from_y_.transpose();
  forget();
}

void Memory::forget() {
  information_.setZero(from_y_.cols(), from_y_.cols());
  pull_.setZero(from_y_.cols());
}

Eigen::VectorXd Memory::sums(const Eigen::VectorXd& values, const std::vector<Place>& places) const {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(mean_.size());
  sums.head(variables_.numbers()) = values;
  for (std::size_t f = 0; f < places.size(); ++f) {
    const FreeForce& force = variables_.forces()[f];
    const Vec3 path = force.patch->at(places[f], variables_.model().rest) - force.patch->middle();
    for (Index axis = 0; axis < 3; ++axis)
      if (const Index v = force.variables[axis]; v >= 0)
        sums.segment<3>(variables_.numbers() + 9 * f + 3 * axis) = values[v] * path;
  }
  return sums;
}

Eigen::VectorXd Memory::at(const Eigen::VectorXd& values, const std::vector<Place>& places) const {
  return to_y_ * (sums(values, places) - mean_);
}

Eigen::MatrixXd Memory::slopes(const Eigen::VectorXd& values, const std::vector<Place>& places) const {
  const Index numbers = variables_.numbers();
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(mean_.size(), variables_.columns());
  slopes.topLeftCorner(numbers, numbers).setIdentity();
  for (std::size_t f = 0; f < places.size(); ++f) {
    const FreeForce& force = variables_.forces()[f];
    const Vec3 path = force.patch->at(places[f], variables_.model().rest) - force.patch->middle();
    const auto tangents = force.patch->tangents(places[f]);
    for (Index axis = 0; axis < 3; ++axis) {
      const Index v = force.variables[axis];
      if (v < 0) continue;
      const Index row = numbers + 9 * f + 3 * axis;
      slopes.block<3, 1>(row, v) = path;
      slopes.block<3, 2>(row, numbers + 2 * f) = values[v] * tangents;
    }
  }
  return to_y_ * slopes;
}

void Memory::add(const Eigen::MatrixXd& by_parts, const std::vector<Place>& base, const Eigen::VectorXd& values,
                 const std::vector<Place>& places, const Eigen::VectorXd& missed, const Eigen::VectorXd& weights) {
  // a part of a force is its product with the displacement along a tangent from the base
  const Index numbers = variables_.numbers();
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(by_parts.cols(), mean_.size());
  parts.topLeftCorner(numbers, numbers).setIdentity();
  Index part = numbers;
  for (std::size_t f = 0; f < base.size(); ++f) {
    const FreeForce& force = variables_.forces()[f];
    const auto tangents = force.patch->tangents(base[f]);
    const Vec3 from = force.patch->middle() - force.patch->at(base[f], variables_.model().rest);
    for (Index axis = 0; axis < 3; ++axis) {
      const Index v = force.variables[axis];
      for (Index t = 0; v >= 0 && t < 2; ++t, ++part) {
        parts.block<1, 3>(part, numbers + 9 * f + 3 * axis) = tangents.col(t).transpose();
        parts(part, v) = tangents.col(t).dot(from);
      }
    }
  }
  const Eigen::MatrixXd by_y = by_parts * parts * from_y_;
  Eigen::VectorXd target = by_y * at(values, places);
  for (Index r = 0; r < std::ssize(weights); ++r) target[r] -= weights[r] > 0 ? missed[r] : 0;
  information_ += by_y.transpose() * weights.asDiagonal() * by_y;
  pull_ += by_y.transpose() * weights.cwiseProduct(target);
}

void Memory::fade(double fraction) {
  const double kept = fraction * fraction;
  const SymmetricEigen eigen = symmetric_eigen(information_);
  Eigen::VectorXd along = eigen.vectors.transpose() * pull_, faded(along.size());
  for (Index k = 0; k < std::ssize(along); ++k) {
    const double estimated = std::max(0.0, eigen.values[k]);  // deviation before is 1
    faded[k] = kept * estimated / (1 + (1 - kept) * estimated);
    along[k] *= fraction * (1 + faded[k]) / (1 + estimated);
  }
  information_ = eigen.vectors * faded.asDiagonal() * eigen.vectors.transpose();
  pull_ = eigen.vectors * along;
}

}  // namespace softkin::estimate
