#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/contact_steps.hpp>
#include <softkin/statics/physical/swelling.hpp>

namespace softkin::physical {

namespace {

/// Of the shape to begin with: strains of half its square.
constexpr double mean_slope = 0.3;
/// How smoothly wrinkles begin, over the square of the strain that the loads call up; and at most. Smoother ones pull
/// the sheet together, sharper ones make the way long.
constexpr double smooth = 50, widest_barrier = 1e-4;
/// By which pressures are to stretch the sheets at first: below it they are too stiff in their plane for their loads.
constexpr double least_strain = 1e-3;
/// Of the first residual, with which its equations are solved.
constexpr double begin_accuracy = 1e-3;
constexpr int begin_rounds = 2000;
/// Where something stands in the way: rounds of going on, and of what is free then how much is gone.
constexpr int way_rounds = 40;
constexpr double of_free = 0.9;

/// What pushes: loads and what chambers are filled with, whatever that takes.
Eigen::VectorXd push_of(const System& system, const Demand& there, const std::vector<bool>& active, const Iterate& at,
                        Workspace& work, Team& team) {
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

/// Moves under an even tension, of sheets alone: what elements hold stays.
class Drum {
 public:
  Drum(const System& system, const Points& positions) : system_(system), positions_(positions) {
    alone_.assign(positions.rows(), false);
    for (const Index v : system.layers()->alone()) alone_[v] = true;
  }

  /// Conjugate gradients.
  [[nodiscard]] Points moves(Eigen::VectorXd left) {
    left = kept(left);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(left.size()), along = left;
    double before = left.squaredNorm();
    const double end = begin_accuracy * begin_accuracy * before;
    for (int round = 0; round < begin_rounds && before > end; ++round) {
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
  /// Of vectors over the unknowns, the part that sheets alone have.
  [[nodiscard]] Eigen::VectorXd kept(const Eigen::VectorXd& unknowns) const { return reduced(expanded(unknowns)); }
  [[nodiscard]] Eigen::VectorXd stiffness(const Eigen::VectorXd& unknowns) const {
    Points forces = Points::Zero(positions_.rows(), 3);
    system_.layers()->add_tension(expanded(unknowns), forces);
    return reduced(std::move(forces));
  }

  const System& system_;
  const Points& positions_;
  std::vector<bool> alone_;
};

/// Moves as far as nothing passes through anything: what comes near something stops there, all else goes on.
void move_clear(const System& system, Points moves, Points& positions, Workspace& work, Team& team) {
  if (!system.contact()) {
    positions += moves;
    return;
  }
  const Contacts& contacts = *system.contacts();
  for (int round = 0; round < way_rounds && !moves.isZero(0); ++round) {
    const double free = contacts.longest_step(positions, positions + moves, *work.contacts, team);
    const double gone = free < 1 ? of_free * free : 1;
    positions += gone * moves;
    moves *= 1 - gone;
    contacts.find(positions, *work.contacts, team);
    for (const ContactPotential::Term& term : work.contacts->terms)
      for (const Index v : term.nodes) moves.row(v).setZero();
  }
}

}  // namespace

std::optional<Swelling> swell(const System& system, const Demand& there, const std::vector<bool>& active, Iterate& at,
                              Workspace& work, Team& team) {
  Iterate begin = at;
  for (Index a = 0; a < system.actuators(); ++a)
    if (!active[a] && system.measures().given_load(a))
      begin.multipliers[a] = system.measures().given(a, there.actuation[a]);
  system.placement().hold(there, begin.positions);
  const Eigen::VectorXd push = push_of(system, there, active, begin, work, team);
  if (push.isZero(0) || !push.allFinite()) return std::nullopt;
  const Points moves = Drum(system, begin.positions).moves(push);
  const double slope = system.layers()->mean_slope(moves);  // at 1 N/mm: the tension at which it were 1
  if (!(slope > 0)) return std::nullopt;
  move_clear(system, mean_slope / slope * moves, begin.positions, work, team);
  at = std::move(begin);
  const double strain = slope / system.layers()->stiffness_N_mm();
  return Swelling{std::min(widest_barrier, smooth * std::pow(std::max(strain, least_strain), 2)),
                  std::max(1.0, least_strain / strain)};
}

}  // namespace softkin::physical
