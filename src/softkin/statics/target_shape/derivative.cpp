#include <algorithm>
#include <limits>
#include <softkin/linear/krylov.hpp>
#include <softkin/statics/target_shape/newton.hpp>

namespace softkin::target_shape {

using namespace energy;

namespace {

/// Largest relative part of a solution by rounding, with the factor of K itself; above it K is singular.
constexpr double singular = 1e-6, unbounded = std::numeric_limits<double>::infinity();
/// Rounds with a factor from nearby that cost about as much as a new factor, and with one that is never exact.
constexpr int symmetric_rounds = 8, max_rounds = 60;

}  // namespace

bool Tangent::solve_exactly(const System::Scratch& local, const Points& positions, const Eigen::MatrixXd& rights,
                            const Accuracy& requested, Team& team, Eigen::MatrixXd& steps) {
  const auto precondition_all = [&](Eigen::MatrixXd& columns) {
    factor_.solve(columns, team);
    if (sources_.cols() > 0) columns -= sources_ * (capacitance_ * (targets_.transpose() * columns));
  };
  Eigen::VectorXd product(rights.rows());
  const auto multiply_all = [&](const Eigen::MatrixXd& in, Eigen::MatrixXd& out) {
    for (Eigen::Index i = 0; i < in.cols(); ++i) {
      multiply(local, positions, in.col(i), product, team);
      out.col(i) = product;
    }
    precondition_all(out);
  };
  Eigen::MatrixXd left = rights;
  precondition_all(left);
  if (!left.allFinite()) return false;
  const linear::Remainder remainder =
      linear::conjugate_residuals(multiply_all, requested.residual, requested.rounds, left, steps);
  return remainder.apart <= requested.apart && remainder.left <= requested.residual && steps.allFinite();
}

Sensitivity Newton::sensitivity(const State& at, bool reuse_factor, double accuracy, Team& team) const {
  const Index actuators = at.actuation.size();
  Sensitivity result = no_sensitivity(at.positions.rows(), actuators);
  std::unique_ptr<Workspace> workspace = take_workspace(&at.positions);
  Tangent& tangent = workspace->tangent;
  System::Scratch& local = workspace->local;
  for (auto& rotations : local.rotations) std::fill(rotations.begin(), rotations.end(), PackRotation{});
  (void)unknowns_.system.local_step(at.actuation, at.positions, local, team);
  Eigen::MatrixXd rights(unknowns_.freedoms.size(), actuators), steps;
  const supports::Turning turning(unknowns_.model);
  std::vector<Points> turned(actuators);  // supported vertices, of commands that turn them
  for (Index a = 0; a < actuators; ++a) {
    if (unknowns_.model.actuators[a].is<TurnCommand>()) {
      Points& moves = turned[a];
      moves.setZero(at.positions.rows(), 3);
      turning.add_velocity(a, at.actuation, 1, moves);
      unknowns_.system.residual_change(local, moves, workspace->work, team);
    } else {
      unknowns_.system.command_change(local, a, workspace->work, team);
    }
    unknowns_.freedoms.reduce(workspace->work.residual, at.positions, rights.col(a));
  }
  const bool near =
      reuse_factor && workspace->solved_shape.rows() == at.positions.rows() && workspace->solved_shape == at.positions;
  const auto solve = [&](int rounds, double apart) {
    return tangent.solve_exactly(local, at.positions, rights, {rounds, accuracy, apart}, team, steps);
  };
  result.regular = near && solve(tangent.symmetric() ? symmetric_rounds : max_rounds, unbounded);
  if (!result.regular) {
    SolveReport report;
    workspace->solved_shape.resize(0, 3);
    if (tangent.factorise(local, at.positions, false, team, report)) {
      const bool exact = tangent.symmetric() && report.projections == 0;
      result.regular = solve(max_rounds, exact ? singular : unbounded);
    }
    if (result.regular) workspace->solved_shape = at.positions;
  }
  for (Index a = 0; result.regular && a < actuators; ++a) {
    unknowns_.freedoms.expand(steps.col(a), at.positions, result.positions[a]);
    if (const Points& moves = turned[a]; moves.rows() > 0) result.positions[a] += moves;
  }
  put_back(std::move(workspace));
  return result;
}

}  // namespace softkin::target_shape
