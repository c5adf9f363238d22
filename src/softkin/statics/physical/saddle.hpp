#pragma once

#include <memory>
#include <softkin/core/dense.hpp>
#include <softkin/linear/mixed_ldlt.hpp>
#include <softkin/statics/physical/balance.hpp>
#include <softkin/statics/physical/tendons.hpp>
#include <softkin/statics/supports/actuator_measures.hpp>
#include <softkin/statics/supports/reduced_matrix.hpp>
#include <utility>

namespace softkin::physical {

/// What the matrix of a factorisation looks like.
struct Layout {
  linear::BlockPattern pattern;  // over vertices
  supports::ReducedMatrix reduced;
  std::shared_ptr<const linear::FrontTree> symbolic;
  std::int64_t slots = 0;         // of the cliques of the pattern
  std::uint64_t fingerprint = 0;  // of these
};

/// The equations of a Newton step, factorised: K step + G change = -force, G^T step - C change = -sign constraint, with
/// the stiffness K over the unknowns, a column of G per active constraint, its slope with its sign, and their
/// compliances C >= 0, 0 but for sealed chambers. Where constraints contradict each other, what misses them least.
///
/// Tendons that rub add few columns: K becomes K + U V^T, by Woodbury's formula, and a measure's multiplier pulls with
/// another column than its slope. As friction is either whole or stiff, a step takes it by its secants over that step.
///
/// K may hold pressures, each with a negative eigenvalue of its own: what is left of K's inertia is that of the shape
/// with pressures that follow it (Haynsworth 1968).
///
/// source  Nocedal, Wright 2006, Numerical optimization, section 16.2: the Schur complement of the constraints
class Saddle {
 public:
  using Precision = linear::MixedLdlt::Precision;

  /// measures  must outlive the object
  Saddle(const supports::ActuatorMeasures& measures, std::shared_ptr<const Layout> layout, Precision usual);

  /// Which measures are active, per actuator.
  void activate(const std::vector<bool>& active);
  /// G, to be written for these before factorise() or couple().
  [[nodiscard]] Eigen::MatrixXd& slopes() { return slopes_; }
  /// C, the same; no rows: 0.
  [[nodiscard]] Eigen::VectorXd& compliance() { return compliance_; }
  /// What the multipliers pull with; no columns: with G.
  [[nodiscard]] Eigen::MatrixXd& pulls() { return pulls_; }
  [[nodiscard]] TendonColumns& tendons() { return tendons_; }
  /// The slips at which what the last factorisation holds is to be taken; see Balance.
  [[nodiscard]] Eigen::VectorXd& slips() { return slips_; }

  /// What is factorised.
  struct Matrix {
    const std::shared_ptr<const Layout>& layout;
    LargeVector<double>& values;  // of its columns
    double shift;                 // times the mean diagonal, added to the values
    LargeVector<double>* spare;   // memory that may be lost; null: none
  };
  /// step  of this balance, to be solved for together with the responses, for first_step(); null: of none
  void factorise(const Matrix& matrix, const Balance* step, Team& team);
  /// What the last factorisation holds of the active measures, from other slopes.
  void couple(Team& team);

  /// Every column becomes nearly its solution, as linear::MixedLdlt says, with the last factorisation.
  void solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team);

  /// Newton step of a balance; change: of all multipliers.
  void step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change, Team& team);
  /// That of the balance with which the last factorisation was made.
  void first_step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change);
  /// What the next step would change multipliers by, without one: G^T K^-1 force needs no solve, but with tendons that
  /// rub.
  void correct_multipliers(const Balance& balance, Eigen::VectorXd& multipliers, Team& team);

  [[nodiscard]] linear::MixedLdlt& factor() { return factor_; }
  [[nodiscard]] const linear::MixedLdlt& factor() const { return factor_; }
  /// Asked of the next factorisation.
  [[nodiscard]] Precision& precision() { return precision_; }
  /// Constraints of the factorisation.
  [[nodiscard]] const std::vector<Index>& active() const { return active_; }
  /// K^-1 pulls
  [[nodiscard]] const Eigen::MatrixXd& responses() const { return responses_; }
  /// S, which makes the diagonal of the next 1.
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }
  /// S (G^T K^-1 pulls + C) S; singular where constraints depend on each other.
  [[nodiscard]] const MinimumNorm& schur() const { return schur_; }

  /// Of the last factorisation.
  struct Spectrum {
    double stiffest = 0;  // the largest of the diagonal [N/mm],
    double mean = 0;      // and their mean
    int negative = 0;     // negative eigenvalues, but those that pressures have of their own,
    int unstable = 0;     // and those that the constraints leave
  };
  [[nodiscard]] const Spectrum& spectrum() const { return spectrum_; }

 private:
  void solve_factorised(const Matrix& matrix, Precision precision, const Balance* step, Team& team);
  bool loses_energy(const Matrix& matrix, Team& team);
  void ask(const Balance* step);
  void solve_without_tendons(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team);
  void close();
  void close_constraints();
  void set_rates(const Eigen::MatrixXd& rates);
  [[nodiscard]] int negative_with_tendons(const Eigen::MatrixXd& rates) const;
  void grow(const Eigen::VectorXd& change, Eigen::VectorXd& growth) const;
  void rub(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change);
  void complete(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change);
  [[nodiscard]] Eigen::MatrixXd followed(const Eigen::Ref<const Eigen::MatrixXd>& moves) const;
  [[nodiscard]] Eigen::VectorXd asked_of(const Balance& balance, const Eigen::VectorXd& more) const;
  [[nodiscard]] Eigen::VectorXd closing(const Balance& balance, const Eigen::VectorXd& more) const;
  void meet_constraints(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change) const;

  const supports::ActuatorMeasures& measures_;
  std::shared_ptr<const Layout> layout_;  // of the factor
  linear::MixedLdlt factor_;
  Precision precision_;
  std::vector<Index> active_;
  Eigen::MatrixXd slopes_, pulls_, responses_;
  Eigen::VectorXd compliance_;
  TendonColumns tendons_;
  Eigen::VectorXd slips_;
  /// What tendons' columns make of the responses.
  struct Rubbing {
    Eigen::MatrixXd free{};       // K^-1 of the pulls without these columns,
    Eigen::MatrixXd along{};      // and of their U
    Eigen::MatrixXd stretches{};  // U^T along
    Eigen::MatrixXd rates{};      // with which V^T is that by the turns and rates U^T
    Eigen::MatrixXd inverse{};    // (1 + V^T along)^-1
  };
  Rubbing rubbing_;
  Eigen::MatrixXd solutions_;   // of the last factorisation: responses, then the step without constraints
  Eigen::MatrixXd in_columns_;  // right-hand sides in the order of the layout, where it has its own
  Eigen::VectorXd scale_;
  Eigen::MatrixXd schur_matrix_;  // its symmetric part
  MinimumNorm schur_;
  Spectrum spectrum_;
};

}  // namespace softkin::physical
