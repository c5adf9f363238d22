#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/maps/fit.hpp>

namespace softkin::maps {

namespace {

/// Regularisation weights of the coefficients: of degree 0, and of the highest degrees. They are so small that the
/// observations dominate.
struct Caution {
  double least, most;
};
constexpr Caution of_fits{1e-7, 1e-3}, of_plans{1e-4, 1e-1};

/// The rows of the least-squares matrix for a point: one for the values, and one per slope with its weight.
struct Rows {
  RowMatrix rows;             // 1 + d by #terms
  Eigen::VectorXd of_slopes;  // d: the weight of each slope

  Rows(const Terms& terms, const Eigen::VectorXd& x) : rows(1 + terms.cols(), terms.rows()), of_slopes(terms.cols()) {
    Eigen::VectorXd values;
    RowMatrix slopes;
    evaluate_terms(terms, x, values, &slopes);
    rows.row(0) = values;
    for (Index j = 0; j < terms.cols(); ++j) {
      const double highest = std::max<double>(1, terms.col(j).maxCoeff());
      of_slopes[j] = std::max(std::sqrt(std::max(0.0, 1 - x[j] * x[j])), 1 / highest) / highest;
      rows.row(1 + j) = of_slopes[j] * slopes.row(j);
    }
  }
};

Eigen::VectorXd weights_of(const Terms& terms, const Eigen::VectorXd& decay, const Caution& caution) {
  Eigen::VectorXd weights(terms.rows());
  for (Index t = 0; t < terms.rows(); ++t)
    weights[t] = std::min(caution.most, caution.least * std::exp(terms.row(t).cast<double>().dot(decay)));
  return weights;
}

/// The i-th number of the sequence of van der Corput to a base.
double radical_inverse(Index i, int base) {
  double value = 0, digit = 1.0 / base;
  for (; i > 0; i /= base, digit /= base) value += digit * static_cast<double>(i % base);
  return value;
}

/// Points among which new ones are chosen.
RowMatrix candidates(Index variables) {
  constexpr std::array<int, max_variables> primes{2, 3, 5, 7, 11, 13, 17, 19};
  constexpr double pi = 3.14159265358979323846;
  const Index corners = Index{1} << variables, inside = 200 * std::max<Index>(1, variables);
  RowMatrix points(corners + 2 * variables + 1 + inside, variables);
  points.setZero();
  Index row = 1;  // the first is the middle
  for (Index corner = 0; corner < corners; ++corner, ++row)
    for (Index j = 0; j < variables; ++j) points(row, j) = (corner >> j) & 1 ? 1 : -1;
  for (Index j = 0; j < variables; ++j)
    for (const double end : {-1.0, 1.0}) points(row++, j) = end;
  for (Index i = 1; i <= inside; ++i, ++row)
    for (Index j = 0; j < variables; ++j) points(row, j) = std::cos(pi * radical_inverse(i, primes[j]));
  return points;
}

}  // namespace

Polynomials fit(const Terms& terms, const std::vector<Observation>& observations, const Eigen::VectorXd& decay) {
  const Index count = terms.rows();
  Index equations = count;
  for (const Observation& each : observations) equations += 1 + each.slopes.rows();
  const Index outputs = observations.front().values.size();
  Eigen::MatrixXd left = Eigen::MatrixXd::Zero(equations, count), right = Eigen::MatrixXd::Zero(equations, outputs);
  Index row = 0;
  for (const Observation& each : observations) {
    const Rows rows(terms, each.x);
    const Index known = 1 + each.slopes.rows();
    left.middleRows(row, known) = rows.rows.topRows(known);
    right.row(row) = each.values;
    for (Index j = 0; j < each.slopes.rows(); ++j) right.row(row + 1 + j) = rows.of_slopes[j] * each.slopes.row(j);
    row += known;
  }
  left.bottomRows(count) = weights_of(terms, decay, of_fits).asDiagonal();
  return {terms, least_squares_of_full_rank(left, right)};
}

Eigen::VectorXd decay_of(const Polynomials& polynomials) {
  constexpr double usual = 1.6, slowest = 0.3, fastest = 4;
  constexpr double still_falling = 3;  // over that of the highest degree: those below are errors of the fit
  const Terms& terms = polynomials.terms();
  Eigen::VectorXd decay(terms.cols());
  for (Index j = 0; j < terms.cols(); ++j) {
    const Index highest = terms.rows() > 0 ? terms.col(j).maxCoeff() : 0;
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(highest + 1);
    for (Index t = 0; t < terms.rows(); ++t)
      largest[terms(t, j)] = std::max(largest[terms(t, j)], polynomials.coefficients().row(t).cwiseAbs().maxCoeff());
    for (Index k = highest; k-- > 0;) largest[k] = std::max(largest[k], largest[k + 1]);
    // from the first degree on: the mean gives no information on the decay of the varying part
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    bool falls = true;
    for (Index k = 1; k <= highest && largest[k] > 0 && falls; ++k) {
      falls = largest[k] > still_falling * largest[highest];
      const double value = std::log(largest[k]), at = static_cast<double>(k);
      n += 1, x += at, y += value, xx += at * at, xy += at * value;
    }
    decay[j] = n < 3 ? usual : std::clamp(-(n * xy - x * y) / (n * xx - x * x), slowest, fastest);
  }
  return decay;
}

RowMatrix worst_known(const Terms& terms, const Eigen::VectorXd& decay, const RowMatrix& known, Index count) {
  const RowMatrix points = candidates(terms.cols());
  Eigen::MatrixXd normal = weights_of(terms, decay, of_plans).cwiseAbs2().asDiagonal();
  for (Index i = 0; i < known.rows(); ++i) {
    const RowMatrix rows = Rows(terms, known.row(i)).rows;
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  const CholeskyFactor factor(normal);
  // the unknown part of each candidate's values, in an orthonormal basis of the terms
  Eigen::MatrixXd values(terms.rows(), points.rows());
  Eigen::VectorXd of_point;
  for (Index i = 0; i < points.rows(); ++i) {
    evaluate_terms(terms, points.row(i), of_point, nullptr);
    values.col(i) = of_point;
  }
  factor.solve_lower(values);
  Eigen::VectorXd unknown = values.colwise().squaredNorm();
  RowMatrix chosen(count, terms.cols());
  Eigen::MatrixXd made(terms.rows(), 0);  // inverse = I - made made^T
  for (Index i = 0; i < count; ++i) {
    Index worst = 0;
    unknown.maxCoeff(&worst);
    chosen.row(i) = points.row(worst);
    Eigen::MatrixXd rows = Rows(terms, points.row(worst)).rows.transpose();
    factor.solve_lower(rows);
    for (Index j = 0; j < 1 + terms.cols(); ++j) {
      const Eigen::VectorXd row = rows.col(j);
      Eigen::VectorXd change = row - made * (made.transpose() * row);
      change /= std::sqrt(1 + row.dot(change));
      unknown -= (values.transpose() * change).cwiseAbs2();
      made.conservativeResize(Eigen::NoChange, made.cols() + 1);
      made.col(made.cols() - 1) = change;
    }
  }
  return chosen;
}

}  // namespace softkin::maps
