#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/lanes.hpp>

/// The effect of commands on elements at rest: active stretch of layers, and growth.

namespace softkin::physical {

using namespace energy;

namespace {

/// Multiplies the gradients of every element by a matrix of its own, and those of unused lanes by the last one.
template <int K, int Q, class Matrix>
void reshape(const std::vector<ElasticBlock<K, Q>>& from, Index count, std::vector<ElasticBlock<K, Q>>& to,
             const Matrix& matrix, Team& team) {
  team.pieces(from.size(), [&](Index begin, Index end) {
    for (Index b = begin; b < end; ++b)
      for (int l = 0; l < lanes; ++l) {
        const Mat3 shrink = matrix(std::min<Index>(count - 1, lanes * b + l));
        for (int q = 0; q < Q; ++q)
          for (int i = 0; i < K; ++i) set_lane(to[b].slope[q][i], l, shrink * lane_of(from[b].slope[q][i], l));
      }
  });
}

}  // namespace

/// Sets the directions of elements that grow along directions.
void Body::add_directions(const Model& model) {
  for (const auto& each : model.growths) {
    const Growth& growth = *each;
    if (growth.directions.empty()) continue;
    std::vector<Vec3> of(model.elements.tetrahedra.size() + model.elements.prisms.size(), Vec3::UnitX());
    for (std::size_t i = 0; i < growth.directions.size(); ++i) {
      const std::size_t tetrahedra = growth.tetrahedra.size();
      const auto e = i < tetrahedra
                         ? static_cast<std::size_t>(growth.tetrahedra[i])
                         : model.elements.tetrahedra.size() + static_cast<std::size_t>(growth.prisms[i - tetrahedra]);
      of[e] = growth.directions[i];
    }
    each_set([&](auto& set) {
      if (set.growth.get() != &growth) return;
      set.along.resize(set.blocks.size());
      for (Index e = 0; e < set.count; ++e) set.along[e / lanes][e % lanes] = of[set.elements[e]];
    });
  }
}

template <int K, int Q>
double Body::stretch_of(const Set<K, Q>& set, const LoadState& load_state, const Scratch& scratch) const {
  if (set.charged) return 1 + load_state.load_factor * (set.prestretch - 1);
  const Index actuator = set.growth ? set.growth->actuator : set.actuator;
  const double command = load_state.actuation[actuator];
  const double nudge = actuator == scratch.nudged ? scratch.nudge : 0;
  if (!set.growth) return command + nudge;
  return set.growth->stretch(command) + nudge * set.growth->slope(command);
}

/// F = F_e G: gradients become G^-T times those at rest, volumes det(G) times. A layer has G = diag(sqrt(ratio),
/// sqrt(ratio), 1 / ratio) in its frame.
void Body::change_elements(const LoadState& load_state, Scratch& scratch, Team& team) const {
  each_set([&]<int K, int Q>(const Set<K, Q>& set) {
    if (set.changed < 0) return;
    Changed<K, Q>& changed = changed_of<K, Q>(scratch)[set.changed];
    const double stretch = stretch_of(set, load_state, scratch);
    if (changed.stretch == stretch) return;
    changed.stretch = stretch;
    if (set.grower < 0) {
      const Vec3 inverse(1 / std::sqrt(stretch), 1 / std::sqrt(stretch), stretch);
      const auto shrink = [&](Index e) {
        const Mat3& frame = set.frames[e / lanes][e % lanes];
        return Mat3(frame * inverse.asDiagonal() * frame.transpose());
      };
      return reshape<K, Q>(set.blocks, set.count, changed.blocks, shrink, team);
    }
    const GrowthStretch grown = set.growth->at(stretch);
    const auto shrink = [&](Index e) {
      const Mat3 all = Mat3::Identity() / grown.across;
      if (set.along.empty()) return all;
      const Vec3& d = set.along[e / lanes][e % lanes];
      return Mat3(all + (1 / grown.along - 1 / grown.across) * d * d.transpose());
    };
    reshape<K, Q>(set.blocks, set.count, changed.blocks, shrink, team);
    for (std::size_t b = 0; b < set.blocks.size(); ++b)
      for (int q = 0; q < Q; ++q) changed.blocks[b].volume[q] = set.blocks[b].volume[q] * grown.volume();
  });
}

}  // namespace softkin::physical
