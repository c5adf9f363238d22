#include <algorithm>
#include <softkin/statics/gmres.hpp>
#include <softkin/statics/target_shape_newton.hpp>

namespace softkin {

namespace {

constexpr double accuracy = 1e-10;
constexpr int columns = 60, rounds = 5;

}  // namespace

bool TargetShapeTangent::solve_exactly(const TargetShapeSystem::Scratch& local, const Points& positions,
                                       const Eigen::VectorXd& right, Team& team, Eigen::VectorXd& step) {
  std::vector<Eigen::VectorXd> basis(columns + 1, Eigen::VectorXd(right.size()));
  Eigen::VectorXd natural = right;
  precondition(natural, team);
  const auto product = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
    multiply(local, positions, in, out, team);
    precondition(out, team);
  };
  return gmres(product, natural, accuracy, rounds, basis, step);
}

Sensitivity TargetShapeNewton::sensitivity(const State& at, Team& team) const {
  const Index actuators = at.actuation.size();
  Sensitivity result;
  result.positions.assign(static_cast<std::size_t>(actuators), Points::Zero(at.positions.rows(), 3));
  result.multipliers.setZero(actuators, actuators);
  std::unique_ptr<TargetShapeWorkspace> workspace = take_workspace();
  TargetShapeTangent& tangent = workspace->tangent;
  TargetShapeSystem::Scratch& local = workspace->local;
  for (auto& rotations : local.rotations) std::fill(rotations.begin(), rotations.end(), PackRotation{});
  (void)unknowns_.system.local_step(at.actuation, at.positions, local, team);
  SolveReport report;
  Sensitivity found = result;
  found.regular = tangent.factorise(local, at.positions, false, team, report);
  Eigen::VectorXd right, step;
  for (Index a = 0; found.regular && a < actuators; ++a) {
    unknowns_.system.command_change(local, a, workspace->work, team);
    tangent.reduce(workspace->work.residual, at.positions, right);
    found.regular = tangent.solve_exactly(local, at.positions, right, team, step);
    unknowns_.freedoms.expand(step, at.positions, found.positions[a]);
  }
  put_back(std::move(workspace));
  return found.regular ? found : result;
}

}  // namespace softkin
