#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <softkin/kinematics/small_program.hpp>
#include <vector>

namespace softkin::inverse {

namespace {

constexpr double rounding = 1e-12;

class SmallProgram {
 public:
  SmallProgram(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Eigen::MatrixXd& rows,
               const Eigen::VectorXd& bounds)
      : factor_(h), rows_(rows), bounds_(bounds), at_(-factor_.solve(g)) {}

  /// False where rounding lets it find none.
  bool solve() {
    for (Eigen::Index round = 0; round < 10 * (rows_.rows() + 1); ++round) {
      const Eigen::Index row = most_violated();
      if (row < 0) return true;
      if (!meet(row)) return false;
    }
    return false;
  }
  [[nodiscard]] const Eigen::VectorXd& at() const { return at_; }

 private:
  [[nodiscard]] Eigen::Index most_violated() const {
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
    const auto count = static_cast<Eigen::Index>(held_.size());
    if (count == 0) return relief.resize(0);
    Eigen::MatrixXd face(count, row.size());
    for (Eigen::Index i = 0; i < count; ++i) face.row(i) = rows_.row(held_[static_cast<std::size_t>(i)]);
    const Eigen::MatrixXd response = factor_.solve(face.transpose());
    relief = (face * response).ldlt().solve(face * step);
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
        const double rate = relief[static_cast<Eigen::Index>(i)];
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
      for (std::size_t i = 0; i < held_.size(); ++i) multipliers_[i] -= length * relief[static_cast<Eigen::Index>(i)];
      multiplier += length;
      if (primal <= dual) break;
      held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(leaving));
      multipliers_.erase(multipliers_.begin() + static_cast<std::ptrdiff_t>(leaving));
    }
    held_.push_back(row);
    multipliers_.push_back(multiplier);
    return true;
  }

  Eigen::LLT<Eigen::MatrixXd> factor_;
  const Eigen::MatrixXd& rows_;
  const Eigen::VectorXd& bounds_;
  Eigen::VectorXd at_;
  std::vector<Eigen::Index> held_;
  std::vector<double> multipliers_;
};

}  // namespace

Eigen::VectorXd solve_small_program(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Eigen::MatrixXd& rows,
                                    const Eigen::VectorXd& bounds) {
  SmallProgram program(h, g, rows, bounds);
  if (!program.solve()) return Eigen::VectorXd::Zero(g.size());
  return program.at();
}

}  // namespace softkin::inverse
