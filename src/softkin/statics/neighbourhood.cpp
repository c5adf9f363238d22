#include <softkin/core/error.hpp>
#include <softkin/statics/physical/workspace_handle.hpp>
#include <softkin/statics/statics_parts.hpp>

namespace softkin {

struct Neighbourhood::Parts {
  Parts(const Model& robot, const State& centre, TeamPool::Lent lent)
      : model(robot), at(centre), team(std::move(lent)) {}
  const Model& model;
  State at;
  TeamPool::Lent team;
  const physical::Equilibria* equilibria = nullptr;
  std::optional<physical::Equilibria::WorkspaceHandle> handle;
  std::optional<physical::Predictor> physical;
};

Neighbourhood::Neighbourhood(const Statics& statics, const State& at, int threads) {
  const Model& model = statics.parts_->model;
  StaticsOptions options;
  options.threads = threads;
  check_start(model, at, options);
  if (!at.knows(model.actuators.size()))
    throw InvalidInput("predictions around a shape need the actuation of which it is the equilibrium");
  parts_ = std::make_unique<Parts>(model, at, statics.parts_->lender.lend(options));
  const physical::Equilibria* physical = statics.parts_->equilibria();
  if (!physical || at.multipliers.size() == 0) return;
  parts_->equilibria = physical;
  const physical::Equilibria::Inside inside(*physical, at, *parts_->team);
  parts_->handle.emplace(*physical, inside->positions, false, SolverOptions{});
  parts_->physical.emplace(physical->system(), parts_->handle->work(), *inside, *parts_->team);
}

Neighbourhood::~Neighbourhood() = default;
Neighbourhood::Neighbourhood(Neighbourhood&&) noexcept = default;
Neighbourhood& Neighbourhood::operator=(Neighbourhood&&) noexcept = default;

State Neighbourhood::predict(const Actuation& actuation) {
  check_actuation(parts_->model, actuation);
  if (!parts_->physical) return parts_->at;
  State predicted = parts_->physical->predict(actuation, *parts_->team);
  parts_->equilibria->outside(predicted);
  return predicted;
}

}  // namespace softkin
