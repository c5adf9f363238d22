#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <softkin/kinematics/small_program.hpp>
#include <vector>

namespace softkin {

namespace {

constexpr double rounding = 1e-13;

/// Of the program on the face where the rows of `held` are equalities.
struct FaceStep {
  Eigen::VectorXd step, multipliers;  // multipliers in the order of held; >= 0 where a row holds the minimiser back
};

/// By the range of the rows held: H^-1 and the Schur complement of the rows.
FaceStep step_on_face(const Eigen::LLT<Eigen::MatrixXd>& factor, const Eigen::VectorXd& slope,
                      const Eigen::MatrixXd& rows, const std::vector<Eigen::Index>& held) {
  FaceStep result;
  result.step = -factor.solve(slope);
  const auto count = static_cast<Eigen::Index>(held.size());
  if (count == 0) return result;
  Eigen::MatrixXd face(count, slope.size());
  for (Eigen::Index i = 0; i < count; ++i) face.row(i) = rows.row(held[static_cast<std::size_t>(i)]);
  const Eigen::MatrixXd response = factor.solve(face.transpose());
  result.multipliers = (face * response).completeOrthogonalDecomposition().solve(-face * result.step);
  result.step += response * result.multipliers;
  return result;
}

}  // namespace

Eigen::VectorXd solve_small_program(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Eigen::MatrixXd& rows,
                                    const Eigen::VectorXd& bounds, const Eigen::VectorXd& start) {
  const Eigen::LLT<Eigen::MatrixXd> factor(h);
  Eigen::VectorXd at = start;
  std::vector<Eigen::Index> held;
  const Eigen::Index most = 20 * (rows.rows() + 1);
  for (Eigen::Index round = 0; round < most; ++round) {
    const FaceStep face = step_on_face(factor, g + h * at, rows, held);
    double length = 1;
    Eigen::Index blocking = -1;
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      if (std::find(held.begin(), held.end(), i) != held.end()) continue;
      const double approach = rows.row(i).dot(face.step);
      if (!(approach < -rounding * rows.row(i).norm() * face.step.norm())) continue;
      const double reach = std::max(0.0, (rows.row(i).dot(at) - bounds[i]) / -approach);
      if (reach < length) {
        length = reach;
        blocking = i;
      }
    }
    at += length * face.step;
    if (blocking >= 0) {
      held.push_back(blocking);
      continue;
    }
    Eigen::Index worst = 0;
    if (held.empty() || face.multipliers.minCoeff(&worst) >= 0) break;
    held.erase(held.begin() + worst);
  }
  return at;
}

}  // namespace softkin
