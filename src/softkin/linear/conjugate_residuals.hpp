#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace softkin::linear {

/// How conjugate_residuals went: lengths over those of the right-hand sides, of the one that is worst.
struct Remainder {
  double left = 0;   // of what is left
  double apart = 0;  // of A b - b: how far A is from the identity
};

/// Solves A X = B for a few right-hand sides together; each gains from the directions that the others ask for. Meant
/// for an A near the identity: it keeps all directions.
///
/// product    product(V, out): out = A V; out is of V's size
/// tolerance  |b - A x| / |b| at which a column is done
/// rounds     products that are allowed; fewer are made where at the rate so far they will not do
/// left       in: B; out: B - A X
/// source     Eisenstat, Elman and Schultz 1983 (GCR), with the directions of all columns as block methods have them
template <class Product>
Remainder conjugate_residuals(const Product& product, double tolerance, int rounds, Eigen::MatrixXd& left,
                              Eigen::MatrixXd& x) {
  constexpr double dependent = 1e-12;  // directions whose images others already have
  const Eigen::VectorXd sizes = left.colwise().norm();
  const auto share_left = [&](Eigen::Index column) {
    return sizes[column] > 0 ? left.col(column).norm() / sizes[column] : 0.0;
  };
  const auto raise = [](double& most, double value) {
    if (!(value <= most)) most = value;  // also where it is not a number
  };
  std::vector<Eigen::VectorXd> directions, images;  // images: orthonormal
  Eigen::MatrixXd asked, answered;
  Remainder remainder;
  x.setZero(left.rows(), left.cols());
  for (int round = 0; round < rounds; ++round) {
    std::vector<Eigen::Index> open;
    for (Eigen::Index i = 0; i < left.cols(); ++i)
      if (!(share_left(i) <= tolerance)) open.push_back(i);
    if (open.empty()) break;
    asked = left(Eigen::all, open);
    answered.resizeLike(asked);
    product(asked, answered);
    if (round == 0)
      for (Eigen::Index i = 0; i < asked.cols(); ++i)
        raise(remainder.apart, (answered.col(i) - asked.col(i)).norm() / asked.col(i).norm());
    const std::size_t known = images.size();
    for (Eigen::Index i = 0; i < asked.cols(); ++i) {
      Eigen::VectorXd direction = asked.col(i), image = answered.col(i);
      const double before = image.norm();
      for (std::size_t j = 0; j < images.size(); ++j) {
        const double part = images[j].dot(image);
        image -= part * images[j];
        direction -= part * directions[j];
      }
      const double size = image.norm();
      if (!(size > dependent * before) || !std::isfinite(size)) continue;
      images.push_back(image / size);
      directions.push_back(direction / size);
      for (Eigen::Index column = 0; column < left.cols(); ++column) {
        const double part = images.back().dot(left.col(column));
        left.col(column) -= part * images.back();
        x.col(column) += part * directions.back();
      }
    }
    remainder.left = 0;
    for (const Eigen::Index i : open) raise(remainder.left, share_left(i));
    if (images.size() == known) break;
    if (round > 0 && std::pow(remainder.left, static_cast<double>(rounds) / (round + 1)) > tolerance) break;
  }
  return remainder;
}

}  // namespace softkin::linear
