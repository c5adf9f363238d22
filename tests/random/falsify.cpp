#include <cstdio>
#include <limits>

#include "random/confirm.hpp"
#include "random/generator.hpp"
#include "random/runs.hpp"

namespace softkin::random_robots {

namespace {

/// A vertex with an axis along which it is free, or held.
struct Place {
  Index vertex = -1;
  int axis = 0;
};

Place find_place(const Model& model, bool held) {
  std::vector<bool> of_rigid(model.elements.used.size());
  for (const RigidRegion& region : model.rigid)
    for (const Index v : region.vertices) of_rigid[v] = true;
  for (Index v = 0; v < model.rest.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (model.elements.used[v] && !of_rigid[v] && model.held.fixed[v][axis] == held) return {v, axis};
  return {};
}

struct Lie {
  const char* name;
  Equilibrium answer;
};

std::vector<Lie> lies_about(const Model& model, const Equilibrium& truth) {
  std::vector<Lie> lies;
  const auto moved = [&](const char* name, const Place& place, double by) {
    if (place.vertex < 0) return;
    lies.push_back({name, truth});
    lies.back().answer.state.positions(place.vertex, place.axis) += by;
  };
  moved("a free vertex moved", find_place(model, false), 1e-4 * model.diagonal_mm);
  moved("a held vertex moved", find_place(model, true), 1e-6 * model.diagonal_mm);
  moved("a coordinate that is none", find_place(model, false), std::numeric_limits<double>::quiet_NaN());
  for (Index a = 0; a < truth.state.multipliers.size(); ++a)
    if (model.actuators[a].control == Control::load) {
      lies.push_back({"another load", truth});
      lies.back().answer.state.multipliers[a] += 1e-6 * (1 + std::abs(truth.state.multipliers[a]));
    } else if (const Filling* filling = filling_of(model.actuators[a]);
               filling && filling->yields() && !filling->liquid) {
      lies.push_back({"another pressure of a gas", truth});
      lies.back().answer.state.multipliers[a] += 1e-5 * (1e3 * filling->atmosphere_MPa + truth.state.multipliers[a]);
    } else if (model.actuators[a].is<CableDrive>() && model.formulation == Formulation::physical) {
      lies.push_back({"a cable that pushes", truth});
      lies.back().answer.state.multipliers[a] = -1e-6;
    }
  lies.push_back({"a limit without a remark", truth});
  lies.back().answer.report.status = Status::limit;
  lies.back().answer.report.remark.clear();
  return lies;
}

}  // namespace

int count_unnoticed_lies(std::uint64_t first, std::uint64_t count) {
  int described = 0, unnoticed = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const RandomCase robot = make_case(seed);
    if (!robot.sensible) continue;
    try {
      const Model model = compile(robot.spec);
      const Statics statics(model);
      const Equilibrium truth = statics.solve(robot.commands[0], statics.rest(), robot.options);
      const State begun = long_rest(model, robot.options);
      const Confirmation of_truth = confirm(model, robot.commands[0], truth, begun);
      if (truth.report.status != Status::converged || of_truth.blurred || !of_truth.faults.empty()) continue;
      for (const Lie& lie : lies_about(model, truth)) {
        ++described;
        if (!confirm(model, robot.commands[0], lie.answer, begun).faults.empty()) continue;
        ++unnoticed;
        std::printf("seed %llu: not noticed: %s\n", static_cast<unsigned long long>(seed), lie.name);
      }
    } catch (const InvalidInput&) {  // nothing to lie about
    }
  }
  std::printf("%d false answers, %d not noticed\n", described, unnoticed);
  return described == 0 ? 1 : unnoticed;
}

}  // namespace softkin::random_robots
