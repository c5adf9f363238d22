#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/saddle.hpp>

namespace softkin::physical {

namespace {

/// Share of a constraint's own compliance below which what it adds to others is rounding [-].
constexpr double dependent = 1e-9;

/// visit(value) of every entry of the diagonal.
template <class Visit>
void each_diagonal(const linear::BlockColumns& columns, LargeVector<double>& values, const Visit& visit) {
  for (Index node = 0; node < columns.nodes(); ++node)
    for (Index i = 0; i < columns.width(node); ++i)
      visit(values[columns.offsets[columns.starts[node]] + i * (columns.width(node) + 1)]);
}

}  // namespace

Saddle::Saddle(const supports::ActuatorMeasures& measures, std::shared_ptr<const Layout> layout, Precision usual)
    : measures_(measures), layout_(std::move(layout)), factor_(layout_->symbolic), precision_(usual) {}

void Saddle::activate(const std::vector<bool>& active) {
  active_.clear();
  for (Index a = 0; a < static_cast<Index>(active.size()); ++a)
    if (active[a]) active_.push_back(a);
}

void Saddle::factorise(const Matrix& matrix, const Balance* step, Team& team) {
  const linear::BlockColumns& columns = matrix.layout->reduced.columns();
  double trace = 0;
  spectrum_.stiffest = 0;
  each_diagonal(columns, matrix.values, [&](double value) {
    trace += std::abs(value);
    spectrum_.stiffest = std::max(spectrum_.stiffest, std::abs(value));
  });
  const double mean = spectrum_.mean = trace / std::max<Index>(1, columns.size());
  if (matrix.shift > 0) each_diagonal(columns, matrix.values, [&](double& value) { value += matrix.shift * mean; });
  if (layout_ != matrix.layout) {
    factor_.change(matrix.layout->symbolic);
    layout_ = matrix.layout;
  }
  solve_factorised(matrix, precision_, step, team);
  if (!factor_.trusted() && (spectrum_.unstable == 0 || !loses_energy(matrix, team)))
    solve_factorised(matrix, Precision::twice, step, team);
}

void Saddle::solve_factorised(const Matrix& matrix, Precision precision, const Balance* step, Team& team) {
  const supports::ReducedMatrix& reduced = layout_->reduced;
  ask(step);
  if (!reduced.in_order()) reduced.to_columns(solutions_, in_columns_);
  Eigen::MatrixXd& right_sides = reduced.in_order() ? solutions_ : in_columns_;
  spectrum_.negative =
      factor_.factorise(matrix.values, 1e-13 * spectrum_.mean, precision, right_sides, team, matrix.spare).negative;
  if (!reduced.in_order()) reduced.to_unknowns(in_columns_, solutions_);
  close();
}

/// Is there a change of shape that keeps the active measures and loses energy? Rayleigh's and Ritz's method on inverse
/// iterates of the last factorisation, however it is rounded: energies are those of the stiffness itself.
bool Saddle::loses_energy(const Matrix& matrix, Team& team) {
  constexpr int iterates = 5;
  constexpr double rounding = 1e-12;  // over the mean diagonal
  const Index size = static_cast<Index>(slopes_.rows());
  Balance right;
  right.constraint.setZero(measures_.count());
  Eigen::VectorXd next = lopsided(size), multipliers;
  Eigen::MatrixXd basis(next.size(), iterates);
  for (int i = 0; i < iterates; ++i) {
    right.force = -next;
    step(right, next, multipliers, team);
    for (int again = 0; again < 2; ++again) next -= basis.leftCols(i) * (basis.leftCols(i).transpose() * next);
    next.normalize();
    if (!next.allFinite()) return false;
    basis.col(i) = next;
  }
  Eigen::MatrixXd image = Eigen::MatrixXd::Zero(basis.rows(), iterates);
  linear::subtract_product(matrix.layout->reduced.columns(), matrix.values, basis, image, team);
  return symmetric_eigenvalues(-(basis.transpose() * image)).minCoeff() < -rounding * spectrum_.mean;
}

void Saddle::couple(Team& team) {
  ask(nullptr);
  solve(solutions_, team);
  close();
}

void Saddle::solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team) {
  const supports::ReducedMatrix& reduced = layout_->reduced;
  if (reduced.in_order()) return factor_.solve(right_sides, team);
  reduced.to_columns(right_sides, in_columns_);
  factor_.solve(in_columns_, team);
  reduced.to_unknowns(in_columns_, right_sides);
}

/// What a factorisation is to solve for: the active constraints' slopes, and for a step the force of the balance.
void Saddle::ask(const Balance* step) {
  const Eigen::Index count = slopes_.cols();
  solutions_.resize(slopes_.rows(), count + (step ? 1 : 0));
  solutions_.leftCols(count) = slopes_;
  if (step) solutions_.col(count) = -step->force;
}

/// What the constraints leave of the stiffness, from their responses.
void Saddle::close() {
  const Index count = static_cast<Index>(active_.size());
  spectrum_.unstable = spectrum_.negative;
  if (count == 0) return;
  responses_ = solutions_.leftCols(count);
  Eigen::MatrixXd schur = slopes_.transpose() * responses_;
  scale_.resize(count);
  for (Index i = 0; i < count; ++i) scale_[i] = schur(i, i) != 0 ? 1 / std::sqrt(std::abs(schur(i, i))) : 1;
  schur = scale_.asDiagonal() * (0.5 * (schur + schur.transpose()).eval()) * scale_.asDiagonal();
  schur_ = MinimumNorm(schur, dependent);
  spectrum_.unstable -= static_cast<int>((symmetric_eigenvalues(schur).array() < -dependent).count());
}

void Saddle::step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change, Team& team) {
  step = -balance.force;
  if (!step.isZero(0)) solve(step, team);  // where constraints alone change there is nothing to solve for
  meet_constraints(balance, step, change);
}

void Saddle::first_step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change) const {
  step = solutions_.col(static_cast<Index>(active_.size()));
  meet_constraints(balance, step, change);
}

/// Change of the multipliers that closes the constraints, of which a step without them misses so much more.
Eigen::VectorXd Saddle::closing(const Balance& balance, const Eigen::VectorXd& more) const {
  Eigen::VectorXd asked = more;
  for (Index i = 0; i < static_cast<Index>(asked.size()); ++i)
    asked[i] += measures_.sign(active_[i]) * balance.constraint[active_[i]];
  return scale_.cwiseProduct(schur_.solve(scale_.cwiseProduct(asked)));
}

/// Adds to a step without constraints what closes them.
void Saddle::meet_constraints(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change) const {
  change.setZero(measures_.count());
  if (active_.empty()) return;
  const Eigen::VectorXd multipliers = closing(balance, slopes_.transpose() * step);
  step -= responses_ * multipliers;
  for (Index i = 0; i < static_cast<Index>(multipliers.size()); ++i) change[active_[i]] = multipliers[i];
}

void Saddle::correct_multipliers(const Balance& balance, Eigen::VectorXd& multipliers) const {
  if (active_.empty()) return;
  const Eigen::VectorXd change = closing(balance, -(responses_.transpose() * balance.force));
  for (Index i = 0; i < static_cast<Index>(change.size()); ++i) multipliers[active_[i]] += change[i];
}

}  // namespace softkin::physical
