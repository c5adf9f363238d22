#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace softkin::linear {

/// Givens rotations that make a Hessenberg matrix upper triangular, column by column.
struct GivensRotations {
  Eigen::VectorXd cosines, sines;

  explicit GivensRotations(int columns) : cosines(columns), sines(columns) {}

  /// Column j of the matrix, and of the right-hand side what its rotation changes. False where it has no length: the
  /// matrix is singular, or a number is not finite.
  bool rotate(int j, Eigen::MatrixXd& upper, Eigen::VectorXd& right) {
    for (int i = 0; i < j; ++i) {
      const double above = upper(i, j);
      upper(i, j) = cosines[i] * above + sines[i] * upper(i + 1, j);
      upper(i + 1, j) = cosines[i] * upper(i + 1, j) - sines[i] * above;
    }
    const double length = std::hypot(upper(j, j), upper(j + 1, j));
    if (!(length > 0)) return false;
    cosines[j] = upper(j, j) / length;
    sines[j] = upper(j + 1, j) / length;
    upper(j, j) = length;
    right[j + 1] = -sines[j] * right[j];
    right[j] *= cosines[j];
    return true;
  }
};

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
  Eigen::VectorXd right(columns + 1), residual = b;
  GivensRotations rotations(columns);
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
      if (!rotations.rotate(j, upper, right)) {  // A is singular along this vector
        --used;
        break;
      }
      left = std::abs(right[j + 1]);
      if (!(norm > 0)) break;  // the solution lies in the basis
      next /= norm;
    }
    if (used == 0) return false;
    const Eigen::VectorXd fractions =
        upper.topLeftCorner(used, used).template triangularView<Eigen::Upper>().solve(right.head(used));
    for (int i = 0; i < used; ++i) x += fractions[i] * basis[i];
    if (left <= goal) return x.allFinite();
    product(x, residual);
    residual = b - residual;
    left = residual.norm();
  }
  return left <= goal && x.allFinite();
}

/// How conjugate_residuals went: lengths over those of the right-hand sides, of the one that is worst.
struct Remainder {
  double left = 0;   // of what is left
  double apart = 0;  // of A b - b: how far A is from the identity

  /// most: one of these; also where a value is not a number
  static void raise(double& most, double value) {
    if (!(value <= most)) most = value;
  }
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
  constexpr double dependent = 1e-8;  // directions whose images others already have but for rounding, which would grow
  const Eigen::VectorXd sizes = left.colwise().norm();
  const auto fraction_left = [&](Eigen::Index column) {
    return sizes[column] > 0 ? left.col(column).norm() / sizes[column] : 0.0;
  };
  std::vector<Eigen::VectorXd> directions, images;  // images: orthonormal
  Eigen::MatrixXd requested, answered;
  Remainder remainder;
  x.setZero(left.rows(), left.cols());
  for (int round = 0; round < rounds; ++round) {
    std::vector<Eigen::Index> open;
    for (Eigen::Index i = 0; i < left.cols(); ++i)
      if (!(fraction_left(i) <= tolerance)) open.push_back(i);
    if (open.empty()) break;
    requested = left(Eigen::all, open);
    answered.resizeLike(requested);
    product(requested, answered);
    if (round == 0)
      for (Eigen::Index i = 0; i < requested.cols(); ++i)
        Remainder::raise(remainder.apart, (answered.col(i) - requested.col(i)).norm() / requested.col(i).norm());
    const std::size_t known = images.size();
    for (Eigen::Index i = 0; i < requested.cols(); ++i) {
      Eigen::VectorXd direction = requested.col(i), image = answered.col(i);
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
    for (const Eigen::Index i : open) Remainder::raise(remainder.left, fraction_left(i));
    if (images.size() == known) break;
    if (round > 1 && std::pow(remainder.left, static_cast<double>(rounds) / (round + 1)) > tolerance) break;
  }
  return remainder;
}

}  // namespace softkin::linear
