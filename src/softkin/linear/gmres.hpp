#pragma once

#include <Eigen/Core>
#include <vector>

namespace softkin::linear {

/// Solves A x = b by restarted GMRES, from x = 0.
///
/// product    product(v, out): out = A v; out is of the right size
/// tolerance  |b - A x| / |b| at which it stops
/// rounds     how often the basis is filled
/// basis      work space: as many vectors as are kept before a restart, and one
/// x          the solution, or the best found
/// returns    whether the tolerance was reached
/// source     Saad and Schultz 1986, Algorithm 4; modified Gram-Schmidt, Givens rotations
template <class Product>
bool gmres(const Product& product, const Eigen::VectorXd& b, double tolerance, int rounds,
           std::vector<Eigen::VectorXd>& basis, Eigen::VectorXd& x) {
  const int columns = static_cast<int>(basis.size()) - 1;
  const double goal = tolerance * b.norm();
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(columns + 1, columns);
  Eigen::VectorXd right(columns + 1), cosines(columns), sines(columns), residual = b;
  x = Eigen::VectorXd::Zero(b.size());
  double left = residual.norm();
  for (int round = 0; round < rounds && left > goal; ++round) {
    basis[0] = residual / left;
    right.setZero();
    right[0] = left;
    int used = 0;
    while (used < columns && left > goal) {
      const int j = used++;
      Eigen::VectorXd& next = basis[used];
      next.resize(b.size());
      product(basis[j], next);
      for (int i = 0; i <= j; ++i) {
        upper(i, j) = next.dot(basis[i]);
        next -= upper(i, j) * basis[i];
      }
      const double norm = next.norm();
      upper(j + 1, j) = norm;
      for (int i = 0; i < j; ++i) {
        const double above = upper(i, j);
        upper(i, j) = cosines[i] * above + sines[i] * upper(i + 1, j);
        upper(i + 1, j) = cosines[i] * upper(i + 1, j) - sines[i] * above;
      }
      const double length = std::hypot(upper(j, j), upper(j + 1, j));
      if (!(length > 0)) {  // A is singular along this vector, or a number is not finite
        --used;
        break;
      }
      cosines[j] = upper(j, j) / length;
      sines[j] = upper(j + 1, j) / length;
      upper(j, j) = length;
      right[j + 1] = -sines[j] * right[j];
      right[j] *= cosines[j];
      left = std::abs(right[j + 1]);
      if (!(norm > 0)) break;  // the solution lies in the basis
      next /= norm;
    }
    if (used == 0) return false;
    const Eigen::VectorXd shares =
        upper.topLeftCorner(used, used).template triangularView<Eigen::Upper>().solve(right.head(used));
    for (int i = 0; i < used; ++i) x += shares[i] * basis[i];
    if (left <= goal) return x.allFinite();
    product(x, residual);
    residual = b - residual;
    left = residual.norm();
  }
  return left <= goal && x.allFinite();
}

}  // namespace softkin::linear
