#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/swelling.hpp>

namespace softkin::physical {

namespace {

/// Returns the driving forces: the loads, and unit pressures in the chambers whose measures are active.
Eigen::VectorXd push_of(const System& system, const LoadState& there, const std::vector<bool>& active,
                        const Iterate& at, Workspace& work, Team& team) {
  Balance balance;
  system.evaluate(at, there, active, work, balance, team);
  Eigen::VectorXd push = -balance.force, unit(push.size());
  const Imbalance imbalance = system.imbalance(balance, work, team);
  if (imbalance.residual <= imbalance.rounding) push.setZero();
  for (Index a = 0; a < system.actuators(); ++a) {
    if (!active[a] || system.measures().sign(a) > 0) continue;
    system.freedoms().reduce(system.pull(a, at), at.positions, unit);
    push += unit;
  }
  return push;
}

/// Moves of the vertices of sheets alone under a uniform tension. Vertices of elements are fixed.
class Drum {
 public:
  Drum(const System& system, const Points& positions, const WrinklingOptions& options)
      : system_(system), positions_(positions), options_(options) {
    alone_.assign(positions.rows(), false);
    for (const Index v : system.layers()->alone()) alone_[v] = true;
  }

  /// Solves for the moves by conjugate gradients.
  [[nodiscard]] Points moves(Eigen::VectorXd left) {
    left = kept(left);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(left.size()), along = left;
    double before = left.squaredNorm();
    const double end = options_.start_accuracy * options_.start_accuracy * before;
    for (int round = 0; round < options_.start_iterations && before > end; ++round) {
      const Eigen::VectorXd product = stiffness(along);
      const double curvature = along.dot(product);
      if (!(curvature > 0)) break;
      sum += before / curvature * along;
      left -= before / curvature * product;
      const double now = left.squaredNorm();
      along = (left + now / before * along).eval();
      before = now;
    }
    return expanded(sum);
  }

 private:
  [[nodiscard]] Points expanded(const Eigen::VectorXd& unknowns) const {
    Points moves;
    system_.freedoms().expand(unknowns, positions_, moves);
    for (Index v = 0; v < moves.rows(); ++v)
      if (!alone_[v]) moves.row(v).setZero();
    return moves;
  }
  [[nodiscard]] Eigen::VectorXd reduced(Points forces) const {
    for (Index v = 0; v < forces.rows(); ++v)
      if (!alone_[v]) forces.row(v).setZero();
    Eigen::VectorXd out(system_.freedoms().size());
    system_.freedoms().reduce(forces, positions_, out);
    return out;
  }
  /// Returns the part of a vector over the unknowns that belongs to vertices of sheets alone.
  [[nodiscard]] Eigen::VectorXd kept(const Eigen::VectorXd& unknowns) const { return reduced(expanded(unknowns)); }
  [[nodiscard]] Eigen::VectorXd stiffness(const Eigen::VectorXd& unknowns) const {
    Points forces = Points::Zero(positions_.rows(), 3);
    system_.layers()->add_tension(expanded(unknowns), forces);
    return reduced(std::move(forces));
  }

  const System& system_;
  const Points& positions_;
  const WrinklingOptions& options_;
  std::vector<bool> alone_;
};

/// Moves vertices without penetration: a vertex stops when it comes near a surface, while the others continue.
void move_clear(const System& system, Points moves, Points& positions, Workspace& work, Team& team) {
  const WrinklingOptions& options = work.options.wrinkling;
  if (!system.contact()) {
    positions += moves;
    return;
  }
  const Contacts& contacts = *system.contacts();
  for (int round = 0; round < options.motion_rounds && !moves.isZero(0); ++round) {
    const double free = contacts.longest_step(positions, positions + moves, *work.contacts, team);
    const double gone = free < 1 ? options.clear_fraction * free : 1;
    positions += gone * moves;
    moves *= 1 - gone;
    contacts.find(positions, *work.contacts, team);
    for (const ContactPotential::Term& term : work.contacts->terms)
      for (const Index v : term.nodes) moves.row(v).setZero();
  }
}

}  // namespace

std::optional<Swelling> swell(const System& system, const LoadState& there, const std::vector<bool>& active,
                              Iterate& at, Workspace& work, Team& team) {
  const WrinklingOptions& options = work.options.wrinkling;
  Iterate begin = at;
  for (Index a = 0; a < system.actuators(); ++a)
    if (!active[a] && system.measures().given_load(a))
      begin.multipliers[a] = system.measures().given(a, there.actuation[a]);
  system.placement().hold(there, begin.positions);
  const Eigen::VectorXd push = push_of(system, there, active, begin, work, team);
  if (push.isZero(0) || !push.allFinite()) return std::nullopt;
  const Points moves = Drum(system, begin.positions, options).moves(push);
  const double slope = system.layers()->mean_slope(moves);  // under 1 N/mm; the tension for slope 1
  if (!(slope > 0)) return std::nullopt;
  move_clear(system, options.mean_slope / slope * moves, begin.positions, work, team);
  at = std::move(begin);
  const double strain = slope / system.layers()->stiffness_N_mm();
  return Swelling{
      std::min(options.max_smoothing, options.smoothing * std::pow(std::max(strain, options.min_strain), 2)),
      std::max(1.0, options.min_strain / strain)};
}

}  // namespace softkin::physical
