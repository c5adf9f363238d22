#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/saddle.hpp>

namespace softkin::physical {

namespace {

/// Fraction of a constraint's own compliance below which the part independent of other constraints is rounding [-].
constexpr double dependent = 1e-9;

/// Calls visit(value) for every entry of the diagonal except those of pressures.
template <class Visit>
void each_diagonal(const supports::ReducedMatrix& matrix, LargeVector<double>& values, const Visit& visit) {
  const linear::BlockColumns& columns = matrix.columns();
  for (Index node = 0; node < columns.nodes(); ++node) {
    if (matrix.scalars() > 0 && matrix.is_scalar(node)) continue;
    for (Index i = 0; i < columns.width(node); ++i)
      visit(values[columns.offsets[columns.starts[node]] + i * (columns.width(node) + 1)]);
  }
}

}  // namespace

Saddle::Saddle(const supports::ActuatorMeasures& measures, std::shared_ptr<const Layout> layout, Precision usual)
    : measures_(measures), layout_(std::move(layout)), factor_(layout_->symbolic), precision_(usual) {}

void Saddle::activate(const std::vector<bool>& active) {
  active_.clear();
  for (Index a = 0; a < std::ssize(active); ++a)
    if (active[a]) active_.push_back(a);
}

void Saddle::factorise(const Matrix& matrix, const Balance* step, Team& team) {
  const supports::ReducedMatrix& reduced = matrix.layout->reduced;
  double trace = 0;
  spectrum_.stiffest = 0;
  each_diagonal(reduced, matrix.values, [&](double value) {
    trace += std::abs(value);
    spectrum_.stiffest = std::max(spectrum_.stiffest, std::abs(value));
  });
  const double mean = spectrum_.mean = trace / std::max<Index>(1, reduced.columns().size() - reduced.scalars());
  if (matrix.shift > 0) each_diagonal(reduced, matrix.values, [&](double& value) { value += matrix.shift * mean; });
  if (layout_ != matrix.layout) {
    factor_.change(matrix.layout->symbolic);
    layout_ = matrix.layout;
  }
  solve_factorised(matrix, precision_, step, team);
  if (!factor_.trusted() && (spectrum_.unstable == 0 || tendons_.count() > 0 || !loses_energy(matrix, team)))
    solve_factorised(matrix, Precision::twice, step, team);
}

void Saddle::solve_factorised(const Matrix& matrix, Precision precision, const Balance* step, Team& team) {
  const supports::ReducedMatrix& reduced = layout_->reduced;
  ask(step);
  if (!reduced.in_order()) reduced.to_columns(solutions_, in_columns_);
  Eigen::MatrixXd& right_sides = reduced.in_order() ? solutions_ : in_columns_;
  spectrum_.negative =
      factor_.factorise(matrix.values, 1e-13 * spectrum_.mean, precision, right_sides, team, matrix.spare).negative -
      reduced.scalars();
  if (!reduced.in_order()) reduced.to_unknowns(in_columns_, solutions_);
  close();
}

/// Is there a change of shape that keeps the active measures and decreases the energy? The Rayleigh-Ritz method on
/// inverse iterates of the last factorisation finds it; rounding of the factorisation does not matter, as the energies
/// are those of the stiffness itself.
bool Saddle::loses_energy(const Matrix& matrix, Team& team) {
  constexpr int iterates = 5;
  constexpr double rounding = 1e-12;  // over the mean diagonal
  const Index size = slopes_.rows();
  Balance right;
  right.constraint.setZero(measures_.count());
  Eigen::VectorXd next = unsymmetric(size), multipliers;
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
  for (Index i = 0; i < std::ssize(compliance_); ++i)  // a compliant measure is a stiffness, not a constraint
    if (compliance_[i] > 0) image -= slopes_.col(i) * (slopes_.col(i).transpose() * basis) / compliance_[i];
  return symmetric_eigenvalues(-(basis.transpose() * image)).minCoeff() < -rounding * spectrum_.mean;
}

void Saddle::couple(Team& team) {
  ask(nullptr);
  solve_without_tendons(solutions_, team);
  close();
}

void Saddle::solve_without_tendons(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team) {
  const supports::ReducedMatrix& reduced = layout_->reduced;
  if (reduced.in_order()) return factor_.solve(right_sides, team);
  reduced.to_columns(right_sides, in_columns_);
  factor_.solve(in_columns_, team);
  reduced.to_unknowns(in_columns_, right_sides);
}

/// Returns the changes of tendon tensions with moves, V^T moves.
Eigen::MatrixXd Saddle::followed(const Eigen::Ref<const Eigen::MatrixXd>& moves) const {
  return tendons_.turned(moves) + friction_.rates * (tendons_.along.transpose() * moves);
}

void Saddle::solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team) {
  solve_without_tendons(right_sides, team);
  if (tendons_.count() == 0) return;
  right_sides -= friction_.along * (friction_.inverse * followed(right_sides));
}

/// Sets the right-hand sides of a factorisation: the forces of the active constraints, the segments of tendons with
/// friction, and for a step the residual force.
void Saddle::ask(const Balance* step) {
  const Eigen::Index count = slopes_.cols(), segments = tendons_.count();
  solutions_.resize(slopes_.rows(), count + segments + (step ? 1 : 0));
  solutions_.leftCols(count) = pulls_.cols() > 0 ? pulls_ : slopes_;
  if (segments > 0) solutions_.middleCols(count, segments) = Eigen::MatrixXd(tendons_.along);
  if (step) solutions_.col(count + segments) = -step->force;
}

/// Computes the responses, the Schur complement and the inertia under the constraints.
void Saddle::close() {
  const Index count = active_.size();
  spectrum_.unstable = spectrum_.negative;
  if (tendons_.count() == 0) {
    responses_ = solutions_.leftCols(count);
  } else {
    friction_.free = solutions_.leftCols(count);
    friction_.along = solutions_.middleCols(count, tendons_.count());
    friction_.stretches = tendons_.along.transpose() * friction_.along;
    const Eigen::MatrixXd rates = tendons_.rates(slips_, Eigen::VectorXd::Zero(tendons_.count()), {});
    spectrum_.unstable = negative_with_tendons(rates);
    set_rates(rates);
  }
  close_constraints();
  if (count > 0)
    spectrum_.unstable -= static_cast<int>((symmetric_eigenvalues(schur_matrix_).array() < -dependent).count());
}

/// Sets the rates of change of tendon tensions with segment lengths, for the last factorisation.
void Saddle::set_rates(const Eigen::MatrixXd& rates) {
  const Eigen::Index segments = tendons_.count();
  friction_.rates = rates;
  friction_.inverse = inverse_of(Eigen::MatrixXd::Identity(segments, segments) + tendons_.turned(friction_.along) +
                                 friction_.rates * friction_.stretches);
  responses_ = friction_.free - friction_.along * (friction_.inverse * followed(friction_.free));
}

/// Returns the number of negative eigenvalues of the stiffness with the symmetrised contribution of the lengths of
/// sticking tendons: from rates S_jk T_j with a symmetric S, S_jk sqrt(T_j T_k). It never reduces the stiffness, as the
/// mean of both would.
///
/// source  Haynsworth 1968: the inertia of K + W D W^T is that of K and of -1/D - W^T K^-1 W, less that of -1/D
int Saddle::negative_with_tendons(const Eigen::MatrixXd& rates) const {
  constexpr double nothing = 1e-12;
  const SymmetricEigen eigen = symmetric_eigen(rates.cwiseProduct(rates.transpose()).cwiseMax(0).cwiseSqrt());
  const double largest = eigen.values.maxCoeff();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < eigen.values.size(); ++i)
    if (eigen.values[i] > nothing * largest) kept.push_back(i);
  if (kept.empty()) return spectrum_.negative;
  Eigen::MatrixXd vectors(eigen.vectors.rows(), kept.size());
  Eigen::VectorXd inverse(vectors.cols());
  for (Eigen::Index i = 0; i < vectors.cols(); ++i) {
    vectors.col(i) = eigen.vectors.col(kept[i]);
    inverse[i] = 1 / eigen.values[kept[i]];
  }
  Eigen::MatrixXd inner = vectors.transpose() * friction_.stretches * vectors;
  inner = -0.5 * (inner + inner.transpose()).eval();
  inner.diagonal() -= inverse;
  const auto below = (symmetric_eigenvalues(inner).array() < 0).count();
  return spectrum_.negative + static_cast<int>(below - inner.rows());
}

/// Sets the tensions of cables with commanded lengths, over the current ones, after a change of their multipliers.
void Saddle::grow(const Eigen::VectorXd& change, Eigen::VectorXd& growth) const {
  for (const TendonColumns::Tendon& tendon : tendons_.tendons)
    for (std::size_t i = 0; i < active_.size(); ++i)
      if (active_[i] == tendon.actuator) growth[active_[i]] = 1 + change[i] / tendon.tension;
}

void Saddle::close_constraints() {
  const Index count = active_.size();
  if (count == 0) return;
  Eigen::MatrixXd schur = slopes_.transpose() * responses_;
  if (compliance_.size() > 0) schur.diagonal() += compliance_;
  scale_.resize(count);
  for (Index i = 0; i < count; ++i) scale_[i] = schur(i, i) != 0 ? 1 / std::sqrt(std::abs(schur(i, i))) : 1;
  schur_matrix_ = scale_.asDiagonal() * (0.5 * (schur + schur.transpose()).eval()) * scale_.asDiagonal();
  if (tendons_.count() == 0 && pulls_.cols() == 0)
    schur_ = MinimumNorm(schur_matrix_, dependent);
  else
    schur_ = MinimumNorm(scale_.asDiagonal() * schur * scale_.asDiagonal(), dependent);
}

/// Completes a step without the tendons' columns, K^-1 of its right-hand side, by these columns and the constraints.
/// Friction is taken by its secants over the step, or by its tangents where the balance contains no slips.
void Saddle::rub(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change) {
  constexpr int max_rounds = 60;
  constexpr double accuracy = 1e-6;  // of lengthenings, over the largest
  const bool known = balance.slips.size() > 0;
  const Eigen::VectorXd& slips = known ? balance.slips : slips_;
  const Index count = active_.size();
  // the step without tendons, then the responses of the constraints, in the few coordinates of tendons and constraints
  Eigen::MatrixXd all(step.size(), 1 + count);
  all << step, friction_.free;
  const Eigen::MatrixXd turned = tendons_.turned(all), stretched = tendons_.along.transpose() * all,
                        turns = tendons_.turned(friction_.along), met = slopes_.transpose() * all,
                        held = slopes_.transpose() * friction_.along;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(tendons_.count(), tendons_.count());
  Eigen::VectorXd lengthening = Eigen::VectorXd::Zero(tendons_.count());
  Eigen::VectorXd growth = balance.growth.size() > 0 ? balance.growth : Eigen::VectorXd::Ones(measures_.count());
  Eigen::MatrixXd rates;
  for (int round = 0; round < max_rounds; ++round) {
    rates = tendons_.rates(slips, lengthening, growth);
    const Eigen::MatrixXd tensions =
        inverse_of(one + turns + rates * friction_.stretches) * (turned + rates * stretched);
    const Eigen::MatrixXd lengths = stretched - friction_.stretches * tensions;
    Eigen::VectorXd now = lengths.col(0);
    if (count > 0) {
      Eigen::MatrixXd left = met - held * tensions;
      if (compliance_.size() > 0) left.rightCols(count).diagonal() += compliance_;
      const Eigen::VectorXd more =
          MinimumNorm(left.rightCols(count), dependent).solve(requested_of(balance, left.col(0)));
      now -= lengths.rightCols(count) * more;
      if (known) grow(more, growth);
    }
    const double moved = (now - lengthening).cwiseAbs().maxCoeff();
    lengthening = now;
    if (!known || !now.allFinite() || moved <= accuracy * now.cwiseAbs().maxCoeff()) break;
  }
  set_rates(rates);
  close_constraints();
  step -= friction_.along * (friction_.inverse * (turned.col(0) + rates * stretched.col(0)));
  meet_constraints(balance, step, change);
}

void Saddle::step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change, Team& team) {
  step = -balance.force;
  if (!step.isZero(0))
    solve_without_tendons(step, team);  // where constraints alone change there is nothing to solve for
  complete(balance, step, change);
}

void Saddle::first_step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change) {
  step = solutions_.col(std::ssize(active_) + tendons_.count());
  complete(balance, step, change);
}

/// Adds the contributions of tendons and constraints to a step of the stiffness alone.
void Saddle::complete(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change) {
  if (tendons_.count() > 0)
    rub(balance, step, change);
  else
    meet_constraints(balance, step, change);
}

/// Returns the constraint violations, increased by `more`, those of a step without constraints.
Eigen::VectorXd Saddle::requested_of(const Balance& balance, const Eigen::VectorXd& more) const {
  Eigen::VectorXd requested = more;
  for (Index i = 0; i < std::ssize(requested); ++i)
    requested[i] += measures_.sign(active_[i]) * balance.constraint[active_[i]];
  return requested;
}

/// Returns the change of the multipliers that satisfies the constraints, the violations of which a step without them
/// increases by `more`.
Eigen::VectorXd Saddle::closing(const Balance& balance, const Eigen::VectorXd& more) const {
  return scale_.cwiseProduct(schur_.solve(scale_.cwiseProduct(requested_of(balance, more))));
}

/// Adds the change that satisfies the constraints to a step without them.
void Saddle::meet_constraints(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change) const {
  change.setZero(measures_.count());
  if (active_.empty()) return;
  const Eigen::VectorXd multipliers = closing(balance, slopes_.transpose() * step);
  step -= responses_ * multipliers;
  for (Index i = 0; i < std::ssize(multipliers); ++i) change[active_[i]] = multipliers[i];
}

void Saddle::correct_multipliers(const Balance& balance, Eigen::VectorXd& multipliers, Team& team) {
  if (active_.empty()) return;
  if (tendons_.count() > 0 || pulls_.cols() > 0) {
    Eigen::VectorXd step, change;
    this->step(balance, step, change, team);
    multipliers += change;
    return;
  }
  const Eigen::VectorXd change = closing(balance, -(responses_.transpose() * balance.force));
  for (Index i = 0; i < std::ssize(change); ++i) multipliers[active_[i]] += change[i];
}

}  // namespace softkin::physical
