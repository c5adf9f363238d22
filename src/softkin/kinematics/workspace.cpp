#include <atomic>
#include <exception>
#include <mutex>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/workspace.hpp>
#include <thread>

namespace softkin {

namespace {

WorkspaceSample sample_of(const Model& model, const Equilibrium& found, Index number) {
  WorkspaceSample sample;
  sample.number = number;
  sample.actuation = found.actuation;
  sample.status = found.report.status;
  sample.iterations = found.report.iterations;
  if (sample.status != Status::converged) return sample;
  sample.multipliers = found.state.multipliers;
  sample.markers.resize(static_cast<Index>(model.markers.size()), 3);
  for (std::size_t p = 0; p < model.markers.size(); ++p)
    sample.markers.row(static_cast<Index>(p)) = model.markers[p].point.at(found.state.positions);
  return sample;
}

}  // namespace

WorkspacePlan plan_workspace(const Model& model, const SamplingOptions& options) {
  WorkspacePlan plan;
  plan.actuations = sample_actuations(model, options);
  const std::vector<Index> order = order_of_neighbours(model, options, plan.actuations);
  for (std::size_t begin = 0; begin < order.size(); begin += chain_length) {
    const std::size_t end = std::min(order.size(), begin + chain_length);
    plan.chains.emplace_back(order.begin() + static_cast<std::ptrdiff_t>(begin),
                             order.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return plan;
}

ChainState begin_chain(const Statics& statics, Index chain) {
  return {chain, 0, statics.rest()};
}

std::optional<WorkspaceSample> solve_next(const Model& model, const Statics& statics, const WorkspacePlan& plan,
                                          const StaticsOptions& options, ChainState& state,
                                          const ProgressCallback& progress) {
  const std::vector<Index>& chain = plan.chains.at(static_cast<std::size_t>(state.chain));
  const Index number = chain.at(static_cast<std::size_t>(state.next));
  const Actuation actuation = plan.actuations.row(number);
  StaticsOptions alone = options;
  alone.threads = 1;
  alone.reuse_factor = false;
  alone.keep_history = false;
  Equilibrium found = statics.solve(actuation, state.last, alone, progress);
  const bool from_rest = state.last.positions == model.rest;
  if (found.report.status != Status::converged && found.report.status != Status::interrupted && !from_rest) {
    const int before = found.report.iterations;
    found = statics.solve(actuation, statics.rest(), alone, progress);
    found.report.iterations += before;
  }
  if (found.report.status == Status::interrupted) return std::nullopt;
  WorkspaceSample sample = sample_of(model, found, number);
  ++state.next;
  if (sample.status == Status::converged) state.last = std::move(found.state);
  return sample;
}

void solve_chains(const Model& model, const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options,
                  int threads, ChainDesk& desk, const ProgressCallback& progress) {
  std::atomic<bool> stopped = false;
  std::exception_ptr failure;
  std::mutex mutex;
  const ProgressCallback go_on = [&](const Progress& p) { return !stopped && (!progress || progress(p)); };
  const auto work = [&] {
    try {
      while (!stopped) {
        std::optional<ChainState> state = desk.take();
        if (!state) return;
        const auto size = static_cast<Index>(plan.chains.at(static_cast<std::size_t>(state->chain)).size());
        while (state->next < size) {
          const std::optional<WorkspaceSample> sample = solve_next(model, statics, plan, options, *state, go_on);
          if (!sample) {
            stopped = true;
            return;
          }
          desk.keep(*state, *sample);
        }
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      stopped = true;
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace softkin
