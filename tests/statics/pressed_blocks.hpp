#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>

#include "statics/contact_scenes.hpp"

/// The patch test of contact: blocks whose meshes do not match pressed on each other.

namespace softkin::testing {

/// Stacked blocks that touch evenly.
struct EvenPressure {
  double of_rest = 0, von_mises = 0;  // force per area at rest, and stress [MPa]
};

/// Both are compressed alike, the gap is that at which the barrier balances them.
[[nodiscard]] inline EvenPressure pressure_by_hand(const StackedBlocks& blocks, const Model& model) {
  const ElasticLaw& law = model.elements.materials[0].elastic;
  const auto pressure_at = [&](double stretch) {
    double low = 1, high = blocks.walls ? 1 : 1.5;  // sideways, where nothing pushes but walls
    for (int i = 0; i < 100; ++i) {
      const double side = (low + high) / 2, volume = stretch * side * side;
      (law.mu / volume * side * side + (law.lambda + law.mu) * (volume - 1) - law.mu > 0 ? high : low) = side;
    }
    const double volume = stretch * low * low;
    const double stress = law.mu / volume * stretch * stretch + (law.lambda + law.mu) * (volume - 1) - law.mu;
    return EvenPressure{-stress * low * low, law.mu / volume * (low * low - stretch * stretch)};
  };
  double low = 0.5, high = 1;
  for (int i = 0; i < 100; ++i) {
    const double stretch = (low + high) / 2;
    const double left = 2 * StackedBlocks::size * (1 - stretch) + blocks.gap - blocks.press;
    const double push = push_of_gap(left / blocks.distance) * model.contact.modulus_MPa;
    (push > pressure_at(stretch).of_rest ? high : low) = stretch;
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
  Unevenness out;
  out.report = found.report;
  const EvenPressure even = pressure_by_hand(blocks, model);
  out.force = force / (StackedBlocks::size * StackedBlocks::size * even.of_rest) - 1;
  const std::vector<double> stresses = statics.measured(found.state).stress.von_mises;
  for (std::size_t i = 0; i < stresses.size(); ++i) {
    const double error = stresses[i] / even.von_mises - 1;
    out.largest = std::max(out.largest, std::abs(error));
    out.root_mean += model.elements.tetrahedron_volumes[i] * error * error;
  }
  const std::vector<double>& volumes = model.elements.tetrahedron_volumes;
  out.root_mean = std::sqrt(out.root_mean / std::accumulate(volumes.begin(), volumes.end(), 0.0));
  return out;
}

/// Between walls, with meshes no vertex of which lies over an edge of the other but by chance.
///
/// distance  of contact, over the size of the blocks, which stand 2.5 times as far apart and are pressed 2 mm more
[[nodiscard]] inline StackedBlocks blocks_at(double distance, bool quadratic) {
  const double d = distance * StackedBlocks::size;
  return {d, 2.5 * d, 2.5 * d + 2, quadratic, true, true};
}

}  // namespace softkin::testing
