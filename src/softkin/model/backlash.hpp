#pragma once

#include <algorithm>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <vector>

namespace softkin {

/// What acts of a command that comes after others, where actuators have backlash: a command that rises acts as it is
/// told; one that falls does not act until it has fallen by the backlash, and what acts stands that much above it then:
///   acts = min(max(acts before, told), told + backlash)
/// Of actuators without backlash the command itself.
[[nodiscard]] inline Actuation acting(const Model& model, const Actuation& before, const Actuation& told) {
  Actuation acts = told;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Index i = a;
    const double backlash = model.actuators[a].backlash;
    if (backlash > 0) acts[i] = std::min(std::max(before[i], told[i]), told[i] + backlash);
  }
  return acts;
}

/// Of commands one after another.
///
/// before   what acts before the first
[[nodiscard]] inline std::vector<Actuation> acting_in_order(const Model& model, Actuation before,
                                                            const std::vector<Actuation>& told) {
  std::vector<Actuation> all;
  for (const Actuation& each : told) {
    before = acting(model, before, each);
    all.push_back(before);
  }
  return all;
}

}  // namespace softkin
