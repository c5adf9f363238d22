#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>

#include "statics/contact_scenes.hpp"

/// The patch test of contact: blocks whose meshes do not match pressed on each other.

namespace softkin::testing {

/// Pressure per area at rest of stacked blocks that touch evenly: both are compressed alike, the gap is that at which
/// the barrier balances them.
[[nodiscard]] inline double pressure_by_hand(const StackedBlocks& blocks, const Model& model) {
  const ElasticLaw& law = model.materials[0].elastic;
  const auto pressure_at = [&](double stretch) {
    double low = 1, high = 1.5;  // sideways, where nothing pushes
    for (int i = 0; i < 100; ++i) {
      const double side = (low + high) / 2, volume = stretch * side * side;
      (law.mu / volume * side * side + (law.lambda + law.mu) * (volume - 1) - law.mu > 0 ? high : low) = side;
    }
    const double volume = stretch * low * low;
    const double stress = law.mu / volume * stretch * stretch + (law.lambda + law.mu) * (volume - 1) - law.mu;
    return -stress * low * low;
  };
  double low = 0.5, high = 1;
  for (int i = 0; i < 100; ++i) {
    const double stretch = (low + high) / 2;
    const double left = 2 * StackedBlocks::size * (1 - stretch) + blocks.gap - blocks.press;
    (push_of_gap(left / blocks.distance) * model.contact.modulus_MPa > pressure_at(stretch) ? high : low) = stretch;
  }
  return pressure_at(low);
}

/// Deviations from a uniform compression.
struct Unevenness {
  double force = 0;                   // from what was found by hand
  double largest = 0, root_mean = 0;  // of von Mises' stress of the elements
  SolveReport report{};
};

[[nodiscard]] inline Unevenness unevenness_of(const StackedBlocks& blocks, const std::array<int, 3>& lower,
                                              const std::array<int, 3>& upper, const StaticsOptions& options) {
  const Model model = compile(blocks.robot(lower, upper));
  const Statics statics(model);
  const Equilibrium found = statics.solve({}, statics.rest(), options);
  const double force = -reaction_of(model, statics, found, 1).z();
  Vec3 wide = Vec3::Zero();
  for (Index v = 0; v < model.robot_vertices(); ++v) wide = wide.cwiseMax(Vec3(found.state.positions.row(v)));
  Unevenness out;
  out.report = found.report;
  out.force = force / (StackedBlocks::size * StackedBlocks::size * pressure_by_hand(blocks, model)) - 1;
  const std::vector<double> stresses = statics.measured(found.state).stress.von_mises;
  for (std::size_t i = 0; i < stresses.size(); ++i) {
    const double error = stresses[i] / (force / (wide.x() * wide.y())) - 1;
    out.largest = std::max(out.largest, std::abs(error));
    out.root_mean += model.tetrahedron_volumes[i] * error * error;
  }
  const std::vector<double>& volumes = model.tetrahedron_volumes;
  out.root_mean = std::sqrt(out.root_mean / std::accumulate(volumes.begin(), volumes.end(), 0.0));
  return out;
}

/// distance  of contact, over the size of the blocks, which stand 2.5 times as far apart and are pressed 2 mm more
[[nodiscard]] inline StackedBlocks blocks_at(double distance, bool quadratic) {
  const double d = distance * StackedBlocks::size;
  return {d, 2.5 * d, 2.5 * d + 2, quadratic};
}

}  // namespace softkin::testing
