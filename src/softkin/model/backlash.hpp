#pragma once

#include <algorithm>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <vector>

namespace softkin {

/// Returns the acting value of a command that comes after others, where actuators have backlash. A rising command acts
/// in full; a falling one has no effect until it has fallen by the backlash, and the acting value stays above it by
/// that:
///   acts = min(max(before, reported), reported + backlash)
/// For actuators without backlash it is the command itself.
[[nodiscard]] inline Actuation acting(const Model& model, const Actuation& before, const Actuation& reported) {
  Actuation acts = reported;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Index i = a;
    const double backlash = model.actuators[a].backlash;
    if (backlash > 0) acts[i] = std::min(std::max(before[i], reported[i]), reported[i] + backlash);
  }
  return acts;
}

/// Returns the acting values of a sequence of commands.
///
/// before   acting values before the first command
[[nodiscard]] inline std::vector<Actuation> acting_in_order(const Model& model, Actuation before,
                                                            const std::vector<Actuation>& reported) {
  std::vector<Actuation> all;
  for (const Actuation& each : reported) {
    before = acting(model, before, each);
    all.push_back(before);
  }
  return all;
}

}  // namespace softkin
