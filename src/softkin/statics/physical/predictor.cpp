#include <softkin/statics/physical/predictor.hpp>

namespace softkin::physical {

double predict(const System& system, const Demand& here, const Demand& there, const std::vector<bool>& active,
               System::Workspace& work, Team& team, Iterate& at) {
  System::Balance balance;
  Eigen::VectorXd step, change;
  system.upset(at, here, there, active, work, balance, team);
  system.step(balance, work, step, change, team);
  const Points before = at.positions;
  if (step.allFinite() && change.allFinite()) {
    system.advance(step, 1, work, at.positions, team);
    at.multipliers += change;
  }
  system.freedoms().hold(there.share, at.positions);
  for (Index a = 0; a < system.actuators(); ++a)
    if (!system.constrains(a) && system.measures().measures(a)) at.multipliers[a] = system.unit(a) * there.actuation[a];
  return (at.positions - before).rowwise().norm().maxCoeff();
}

Predictor::Predictor(const System& system, System::Workspace& work, const State& at, Team& team)
    : system_(system),
      work_(work),
      at_(at),
      iterate_{at.positions, at.multipliers},
      active_(static_cast<std::size_t>(system.actuators())) {
  for (Index a = 0; a < system.actuators(); ++a) {
    iterate_.multipliers[a] *= system.unit(a);
    // chambers are held always, cables where they pull
    active_[a] = system.constrains(a) && (system.sign(a) < 0 || iterate_.multipliers[a] > 0);
  }
  System::Balance balance;
  const Demand demand{at.actuation, at.share};
  system.evaluate(iterate_, demand, active_, work_, balance, team);
  (void)system.factorise(iterate_, demand, active_, System::Stiffness::exact, 0, work_, team);
}

State Predictor::predict(const Actuation& actuation, Team& team) {
  Iterate there = iterate_;
  (void)physical::predict(system_, {at_.actuation, at_.share}, {actuation, 1}, active_, work_, team, there);
  if (!there.positions.allFinite() || !there.multipliers.allFinite()) return at_;
  State state{std::move(there.positions), actuation, std::move(there.multipliers), 1};
  for (Index a = 0; a < system_.actuators(); ++a) {
    state.multipliers[a] /= system_.unit(a);
    // no cable pushes
    if (system_.constrains(a) && system_.sign(a) > 0) state.multipliers[a] = std::max(0.0, state.multipliers[a]);
  }
  return state;
}

}  // namespace softkin::physical
