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

/// The layout of a factorised matrix.
struct Layout {
  linear::BlockPattern pattern;  // over vertices
  supports::ReducedMatrix reduced;
  std::shared_ptr<const linear::FrontTree> symbolic;
  std::int64_t slots = 0;         // of the cliques of the pattern
  std::uint64_t fingerprint = 0;  // of these
};

/// The equations of a Newton step, factorised: K step + G change = -force, G^T step - C change = -sign constraint, with
/// the stiffness K over the unknowns, a column of G per active constraint, its gradient with its sign, and their
/// compliances C >= 0, 0 except for sealed chambers. Constraints that contradict each other are satisfied by least
/// squares.
///
/// Tendons with friction add few columns: K becomes K + U V^T, by Woodbury's formula, and the force of a measure's
/// multiplier is another column than the measure's gradient. As friction is either fully mobilised or stiff, a step
/// takes it by its secants over that step.
///
/// K may contain pressures, each with a negative eigenvalue of its own: the other eigenvalues have the inertia of the
/// shape with pressures that follow it (Haynsworth 1968).
///
/// source  Nocedal, Wright 2006, Numerical optimization, section 16.2: the Schur complement of the constraints
class Saddle {
 public:
  using Precision = linear::MixedLdlt::Precision;

  /// measures  must outlive the object
  Saddle(const supports::ActuatorMeasures& measures, std::shared_ptr<const Layout> layout, Precision usual);

  /// Sets which measures are active, per actuator.
  void activate(const std::vector<bool>& active);
  /// G, to be written for these before factorise() or couple().
  [[nodiscard]] Eigen::MatrixXd& slopes() { return slopes_; }
  /// C, the same; no rows: 0.
  [[nodiscard]] Eigen::VectorXd& compliance() { return compliance_; }
  /// The forces of the multipliers, a column each; no columns: those of G.
  [[nodiscard]] Eigen::MatrixXd& pulls() { return pulls_; }
  [[nodiscard]] TendonColumns& tendons() { return tendons_; }
  /// The slips at which friction of tendons in the last factorisation is taken; see Balance.
  [[nodiscard]] Eigen::VectorXd& slips() { return slips_; }

  /// The matrix to factorise.
  struct Matrix {
    const std::shared_ptr<const Layout>& layout;
    LargeVector<double>& values;  // of its columns
    double shift;                 // times the mean diagonal, added to the values
    LargeVector<double>* spare;   // memory that may be lost; null: none
  };
  /// step  the balance of a step that is solved for together with the responses, for first_step(); null: none
  void factorise(const Matrix& matrix, const Balance* step, Team& team);
  /// Computes the responses and the Schur complement of the last factorisation with other slopes.
  void couple(Team& team);

  /// Replaces every column by nearly its solution with the last factorisation; for the accuracy see linear::MixedLdlt.
  void solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team);

  /// Newton step of a balance; change: of all multipliers.
  void step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change, Team& team);
  /// Newton step of the balance with which the last factorisation was made.
  void first_step(const Balance& balance, Eigen::VectorXd& step, Eigen::VectorXd& change);
  /// Changes the multipliers as the next step would: G^T K^-1 force needs no solve, except with tendons that have
  /// friction.
  void correct_multipliers(const Balance& balance, Eigen::VectorXd& multipliers, Team& team);

  [[nodiscard]] linear::MixedLdlt& factor() { return factor_; }
  [[nodiscard]] const linear::MixedLdlt& factor() const { return factor_; }
  /// The precision of the next factorisation.
  [[nodiscard]] Precision& precision() { return precision_; }
  /// Constraints of the factorisation.
  [[nodiscard]] const std::vector<Index>& active() const { return active_; }
  /// K^-1 pulls
  [[nodiscard]] const Eigen::MatrixXd& responses() const { return responses_; }
  /// S, which scales the diagonal of the Schur complement to 1.
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }
  /// S (G^T K^-1 pulls + C) S; singular where constraints depend on each other.
  [[nodiscard]] const MinimumNorm& schur() const { return schur_; }

  /// The diagonal and the inertia of the last factorisation.
  struct Spectrum {
    double stiffest = 0;  // the largest of the diagonal [N/mm],
    double mean = 0;      // and their mean
    int negative = 0;     // negative eigenvalues, except those of pressures,
    int unstable = 0;     // and those that remain under the constraints
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
  [[nodiscard]] Eigen::VectorXd requested_of(const Balance& balance, const Eigen::VectorXd& more) const;
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
  /// The contribution of tendons' columns to the responses.
  struct CableFriction {
    Eigen::MatrixXd free{};       // K^-1 of the pulls without these columns,
    Eigen::MatrixXd along{};      // and of their U
    Eigen::MatrixXd stretches{};  // U^T along
    Eigen::MatrixXd rates{};      // V^T is the part by turning angles plus rates U^T
    Eigen::MatrixXd inverse{};    // (1 + V^T along)^-1
  };
  CableFriction friction_;
  Eigen::MatrixXd solutions_;   // of the last factorisation: responses, then the step without constraints
  Eigen::MatrixXd in_columns_;  // right-hand sides in the order of the layout, where it has its own
  Eigen::VectorXd scale_;
  Eigen::MatrixXd schur_matrix_;  // its symmetric part
  MinimumNorm schur_;
  Spectrum spectrum_;
};

}  // namespace softkin::physical
