#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <softkin/linear/gmres.hpp>
#include <softkin/statics/target_shape/newton_tangent.hpp>

namespace softkin::target_shape {

namespace {

/// Columns kept before GMRES starts anew, and how often it may.
constexpr int krylov_columns = 40, krylov_rounds = 1;

}  // namespace

Unknowns::Unknowns(const Model& robot, const System& target_shapes)
    : model(robot),
      system(target_shapes),
      matrix(robot, target_shapes),
      freedoms(robot, matrix.pattern()),
      symbolic(std::make_shared<const linear::FrontTree>(linear::make_front_tree(freedoms.columns()))),
      symmetric(target_shapes.is_gradient()) {}

Tangent::Tangent(const Unknowns& unknowns)
    : unknowns_(unknowns), factor_(unknowns.symbolic), work_(unknowns.system.make_scratch()) {
  const Index size = unknowns.freedoms.size();
  column_.resize(size, 1);
  turned_.resize(size);
  unturned_.resize(size);
  origin_ = Points::Zero(unknowns.model.rest.rows(), 3);
  if (!unknowns.symmetric) basis_.assign(krylov_columns + 1, Eigen::VectorXd(size));
}

bool Tangent::factorise_values(double shift, Team& team, SolveReport& report) {
  const linear::BlockColumns& columns = unknowns_.freedoms.columns();
  shift_ = shift;
  double largest = 0;
  shifted_ = values_;
  for (Index node = 0; node < columns.nodes(); ++node) {
    const Index width = columns.width(node);
    double* block = shifted_.data() + columns.offsets[columns.starts[node]];
    for (Index i = 0; i < width; ++i) {
      double& diagonal = block[i * (width + 1)];
      diagonal += shift * std::abs(diagonal);
      largest = std::max(largest, std::abs(diagonal));
    }
  }
  if (!std::isfinite(largest)) return false;
  constexpr double negligible = 1e-14;
  ++report.factorisations;
  const linear::SparseLdlt::Pivots pivots = factor_.factorise(shifted_, negligible * largest, team);
  return pivots.negative == 0;
}

bool Tangent::factorise(const System::Scratch& local, const Points& positions, bool projected, Team& team,
                        SolveReport& report) {
  constexpr double first_shift = 1e-8, last_shift = 1e4, growth = 10;
  gradient_ = -local.residual;
  const auto assemble = [&](bool positive) {
    unknowns_.matrix.assemble(local, positive, slots_, team);
    unknowns_.freedoms.reduce_matrix(unknowns_.matrix.pattern(), slots_, gradient_, positions, values_, team);
  };
  bool definite = false;
  if (!projected) {
    assemble(false);
    definite = factorise_values(0, team, report);
  }
  if (!definite) {
    ++report.projections;
    assemble(true);
    definite = factorise_values(0, team, report);
  }
  if (!definite) ++report.shifts;
  for (double shift = first_shift; !definite && shift < last_shift; shift *= growth)
    definite = factorise_values(shift, team, report);
  if (definite && !unknowns_.symmetric) update_coupling(local, positions, team);
  return definite;
}

void Tangent::update_coupling(const System::Scratch& local, const Points& positions, Team& team) {
  unknowns_.system.redistributions(local, work_, redistributions_, team);
  const Index count = static_cast<Index>(redistributions_.size());
  sources_.resize(factor_.size(), count);
  targets_.resize(factor_.size(), count);
  if (count == 0) return;
  for (Index i = 0; i < count; ++i) {
    unknowns_.freedoms.reduce(redistributions_[i].source, positions, sources_.col(i));
    unknowns_.freedoms.reduce(redistributions_[i].target, positions, targets_.col(i));
  }
  factor_.solve(sources_, team);
  const Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(count, count) + targets_.transpose() * sources_;
  capacitance_ = Eigen::FullPivLU<Eigen::MatrixXd>(inverse).inverse();
  if (!capacitance_.allFinite()) capacitance_.setZero();  // GMRES does without the coupling
}

void Tangent::reduce(const Points& residual, const Points& positions, Eigen::VectorXd& out) const {
  out.resize(unknowns_.freedoms.size());
  unknowns_.freedoms.reduce(residual, positions, out);
}

void Tangent::precondition(Eigen::VectorXd& vector, Team& team) {
  column_.col(0) = vector;
  factor_.solve(column_, team);
  vector = column_.col(0);
  if (sources_.cols() > 0) vector -= sources_ * (capacitance_ * (targets_.transpose() * vector));
}

/// K v: minus the residual's change, and what a turn of the arms of rigid regions does to their torque.
void Tangent::multiply(const System::Scratch& local, const Points& positions, const Eigen::VectorXd& vector,
                       Eigen::VectorXd& product, Team& team) {
  const supports::Freedoms& freedoms = unknowns_.freedoms;
  freedoms.expand(vector, positions, moved_);
  unknowns_.system.residual_change(local, moved_, work_, team);
  freedoms.reduce(work_.residual, positions, product);
  product = -product;
  if (unknowns_.model.rigid.empty()) return;
  // reduce() is linear in the arms: at the moves instead of the positions it gives the torques' change
  freedoms.reduce(local.residual, moved_, turned_);
  freedoms.reduce(local.residual, origin_, unturned_);
  product -= turned_ - unturned_;
}

bool Tangent::solve(const System::Scratch& local, const Points& positions, const Eigen::VectorXd& right,
                    double tolerance, Team& team, Eigen::VectorXd& step) {
  if (unknowns_.symmetric) {
    step = right;
    return true;
  }
  const auto product = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
    multiply(local, positions, in, out, team);
    precondition(out, team);
  };
  return linear::gmres(product, right, tolerance, krylov_rounds, basis_, step);
}

}  // namespace softkin::target_shape
