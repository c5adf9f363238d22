#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/inverse_step.hpp>
#include <vector>

namespace softkin::inverse {

namespace {

/// A command nearer than this to an end of its range, as a fraction of the range, is at that end.
constexpr double at_the_end = 1e-9;
/// The distance to an end of a range, or to a tension of zero, below which a gradient that leads beyond it is blocked.
constexpr double held_back = 1e-6;

/// Moves that stay in the ranges and the radius and slacken no cable: rows move >= bounds.
struct Region {
  Eigen::MatrixXd rows;
  Eigen::VectorXd bounds;

  Region(const Pose& pose, const Slopes& slopes, double radius) {
    const Eigen::Index free = pose.fractions.size(), cables = pose.tensions.size();
    rows.setZero(2 * free + cables, free);
    bounds.resize(2 * free + cables);
    rows.topRows(free).setIdentity();
    rows.middleRows(free, free).diagonal().setConstant(-1);
    bounds.head(free) = (-pose.fractions).cwiseMax(-radius);
    bounds.segment(free, free) = -(1 - pose.fractions.array()).min(radius);
    for (Eigen::Index i = 0; i < cables; ++i) {
      const double scale = slopes.tensions.row(i).norm();
      rows.row(2 * free + i) = slopes.tensions.row(i) / (scale > 0 ? scale : 1);
      bounds[2 * free + i] = scale > 0 ? -pose.tensions[i] / scale : -1;
    }
  }
};

/// Are all eigenvalues above a bound, by determinant and trace with the largest possible other eigenvalues? Returns
/// false where this does not decide.
bool clearly_above(const Eigen::MatrixXd& symmetric, double least) {
  const CholeskyFactor factor(symmetric);
  if (!factor.positive()) return false;
  const Eigen::Index others = symmetric.rows() - 1;
  double bound = 1;
  for (Eigen::Index i = 0; i <= others; ++i) bound *= factor.lower()(i, i) * factor.lower()(i, i);
  const double largest = others > 0 ? symmetric.trace() / static_cast<double>(others) : 1;
  for (Eigen::Index i = 0; i < others; ++i) bound /= largest;
  return bound > least;
}

/// Returns the directions without effect, as columns: by the singular values of the slopes, as the eigenvalues of J^T
/// J, which usually show that there are none, are accurate to the root of the rounding error only.
///
/// normal  J^T J
Eigen::MatrixXd blind_directions(const Eigen::MatrixXd& slopes, const Eigen::MatrixXd& normal, double resolution_mm) {
  constexpr double clear = 4, known = 1e-10;
  if (clearly_above(normal, std::max(clear * resolution_mm * resolution_mm, known * normal.trace())))
    return {slopes.cols(), 0};
  const SingularValues singular = singular_values(slopes);
  const auto seen = (singular.values.array() >= resolution_mm).count();
  return singular.right.rightCols(slopes.cols() - seen);
}

/// Returns a positive definite matrix with the magnitudes of the Hessian's curvatures. Directions without effect are
/// made stiff, as rounding would determine the step along them.
Eigen::MatrixXd made_definite(const Eigen::MatrixXd& hessian, double resolution_mm) {
  constexpr double known = 1e-14;
  if (clearly_above(hessian, std::max(resolution_mm * resolution_mm, known * hessian.trace()))) return hessian;
  const SymmetricEigen eigen = symmetric_eigen(hessian);
  const Eigen::VectorXd magnitude = eigen.values.cwiseAbs();
  const double most = std::max(magnitude.maxCoeff(), resolution_mm * resolution_mm);
  const double least = std::max(resolution_mm * resolution_mm, known * most);
  const Eigen::VectorXd made = (magnitude.array() < least).select(most, magnitude);
  return eigen.vectors * made.asDiagonal() * eigen.vectors.transpose();
}

/// Returns the weights of the distances from the preferred actuation. A slack cable that is preferred longer than its
/// path has reached it already.
Eigen::VectorXd weights_of(const Pose& pose, const Eigen::VectorXd& preferred) {
  constexpr double hardly = 1e-6;  // keeps the program definite
  return (pose.idle.array() > 0 && preferred.array() >= pose.fractions.array())
      .select(Eigen::VectorXd::Constant(pose.fractions.size(), hardly), Eigen::VectorXd::Ones(pose.fractions.size()));
}

/// Sets fractions that differ from an end of the range by rounding to that end.
Eigen::VectorXd ended(Eigen::VectorXd fractions) {
  for (double& fraction : fractions) fraction = fraction < at_the_end ? 0 : fraction > 1 - at_the_end ? 1 : fraction;
  return fractions;
}

/// Moves along the blind directions to the point nearest to the preferred actuation.
Eigen::VectorXd sideways_move(const Pose& pose, const Eigen::MatrixXd& blind, const Region& region,
                              const Eigen::VectorXd& move, const Eigen::VectorXd& preferred) {
  const Eigen::VectorXd weights = weights_of(pose, preferred);
  const Eigen::MatrixXd h = blind.transpose() * weights.asDiagonal() * blind;
  const Eigen::VectorXd g = blind.transpose() * weights.cwiseProduct(pose.fractions + move - preferred);
  const Eigen::VectorXd along = solve_small_program(h, g, region.rows * blind, region.bounds - region.rows * move);
  return blind * along;
}

constexpr double rounding = 1e-12;

class SmallProgram {
 public:
  SmallProgram(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Eigen::MatrixXd& rows,
               const Eigen::VectorXd& bounds)
      : factor_(h), rows_(rows), bounds_(bounds), at_(-factor_.solve(g)) {}

  /// False where rounding lets it find none.
  bool solve() {
    for (Eigen::Index round = 0; round < 10 * (rows_.rows() + 1); ++round) {
      const Eigen::Index row = max_violated();
      if (row < 0) return true;
      if (!meet(row)) return false;
    }
    return false;
  }
  [[nodiscard]] const Eigen::VectorXd& at() const { return at_; }

 private:
  [[nodiscard]] Eigen::Index max_violated() const {
    Eigen::Index found = -1;
    double most = 0;
    for (Eigen::Index i = 0; i < rows_.rows(); ++i) {
      const double length = rows_.row(i).norm();
      if (!(length > 0)) continue;
      const double lack = (bounds_[i] - rows_.row(i).dot(at_)) / length;
      if (lack > most && lack > rounding * (1 + at_.norm())) {
        most = lack;
        found = i;
      }
    }
    return found;
  }

  /// Directions of s and of the multipliers of the rows held, per multiplier of a new row.
  void directions(const Eigen::VectorXd& row, Eigen::VectorXd& step, Eigen::VectorXd& relief) const {
    step = factor_.solve(row);
    const Eigen::Index count = held_.size();
    if (count == 0) return relief.resize(0);
    Eigen::MatrixXd face(count, row.size());
    for (Eigen::Index i = 0; i < count; ++i) face.row(i) = rows_.row(held_[i]);
    const Eigen::MatrixXd response = factor_.solve(Eigen::MatrixXd(face.transpose()));
    relief = solve_symmetric(face * response, face * step);
    step -= response * relief;
  }

  /// Pushes s until it meets a row, letting go of rows that would have to pull.
  bool meet(Eigen::Index row) {
    const Eigen::VectorXd normal = rows_.row(row);
    const double stiff = normal.dot(factor_.solve(normal));
    double multiplier = 0;
    for (;;) {
      Eigen::VectorXd step, relief;
      directions(normal, step, relief);
      double dual = HUGE_VAL;
      std::size_t leaving = 0;
      for (std::size_t i = 0; i < held_.size(); ++i) {
        const double rate = relief[i];
        if (rate > rounding && multipliers_[i] / rate < dual) {
          dual = multipliers_[i] / rate;
          leaving = i;
        }
      }
      const double yielding = normal.dot(step);
      const bool moves = yielding > rounding * stiff;
      const double primal = moves ? (bounds_[row] - normal.dot(at_)) / yielding : HUGE_VAL;
      const double length = std::min(dual, primal);
      if (!std::isfinite(length)) return false;
      if (moves) at_ += length * step;
      for (std::size_t i = 0; i < held_.size(); ++i) multipliers_[i] -= length * relief[i];
      multiplier += length;
      if (primal <= dual) break;
      held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(leaving));
      multipliers_.erase(multipliers_.begin() + static_cast<std::ptrdiff_t>(leaving));
    }
    held_.push_back(row);
    multipliers_.push_back(multiplier);
    return true;
  }

  CholeskyFactor factor_;
  const Eigen::MatrixXd& rows_;
  const Eigen::VectorXd& bounds_;
  Eigen::VectorXd at_;
  std::vector<Eigen::Index> held_;
  std::vector<double> multipliers_;
};

}  // namespace

double predicted_reduction(const Pose& pose, const Slopes& slopes, const Eigen::MatrixXd& curvature,
                           const Eigen::VectorXd& move) {
  const Eigen::VectorXd change = slopes.terms * move;
  return -(pose.terms.dot(change) + 0.5 * change.squaredNorm() + 0.5 * move.dot(curvature * move));
}

double distance_from(const Pose& pose, const Eigen::VectorXd& preferred) {
  const Eigen::VectorXd apart = pose.fractions - preferred;
  return 0.5 * apart.dot(weights_of(pose, preferred).cwiseProduct(apart));
}

InverseStep find_step(const Pose& pose, const Slopes& slopes, const Eigen::MatrixXd& curvature,
                      const Eigen::VectorXd& preferred, const StepLimits& limits) {
  const Region region(pose, slopes, limits.radius);
  const Eigen::MatrixXd normal = slopes.terms.transpose() * slopes.terms;
  InverseStep step;
  step.move = solve_small_program(made_definite(normal + curvature, limits.resolution_mm),
                                  slopes.terms.transpose() * pose.terms, region.rows, region.bounds);
  step.predicted = predicted_reduction(pose, slopes, curvature, step.move);
  step.predicted_norm = (pose.terms + slopes.terms * step.move).norm();
  // where the goals stay out of reach, how near they are comes before how near the actuation is
  const bool near = pose.miss <= 1 || step.predicted_norm < 0.5 * pose.terms.norm();
  const Eigen::MatrixXd blind =
      near ? blind_directions(slopes.terms, normal, limits.resolution_mm) : Eigen::MatrixXd(slopes.terms.cols(), 0);
  if (blind.cols() > 0) {
    const Eigen::VectorXd more = sideways_move(pose, blind, region, step.move, preferred);
    step.sideways = more.cwiseAbs().maxCoeff();
    step.move += more * std::min(1.0, limits.sideways / std::max(step.sideways, 1e-300));
  }
  step.move = ended(pose.fractions + step.move) - pose.fractions;
  return step;
}

double projected_slope(const Pose& pose, const Slopes& slopes) {
  const double norm = pose.terms.norm();
  if (!(norm > 0)) return 0;
  Region region(pose, slopes, 1);
  for (Eigen::Index i = 0; i < region.bounds.size(); ++i)
    region.bounds[i] = region.bounds[i] > -held_back ? 0 : -HUGE_VAL;
  const Eigen::Index free = pose.fractions.size();
  const Eigen::VectorXd gradient = slopes.terms.transpose() * pose.terms / norm;
  return solve_small_program(Eigen::MatrixXd::Identity(free, free), gradient, region.rows, region.bounds).norm();
}

Eigen::VectorXd solve_small_program(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Eigen::MatrixXd& rows,
                                    const Eigen::VectorXd& bounds) {
  SmallProgram program(h, g, rows, bounds);
  if (!program.solve()) return Eigen::VectorXd::Zero(g.size());
  return program.at();
}

}  // namespace softkin::inverse
