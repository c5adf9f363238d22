#include <algorithm>
#include <softkin/energy/target_shape_stiffness.hpp>
#include <softkin/model/names.hpp>
#include <softkin/statics/target_shape/element_sets.hpp>
#include <softkin/statics/target_shape/system.hpp>

namespace softkin::target_shape {

using namespace energy;

namespace {

/// 1 where an element's ratio follows its shape, 0 where it is at the minimum.
Pack follows(const Pack& ratio) {
  return select(ratio > min_ratio, pack(1), pack(0));
}

template <int K>
Index elements_of_block(const ActuationSet<K>& set, Index block) {
  return std::min<Index>(lanes, set.count - lanes * block);
}

}  // namespace

bool System::is_gradient() const {
  const auto blended = [](const auto& block) { return block.blended; };
  return std::none_of(sets_.tetrahedra.blocks.begin(), sets_.tetrahedra.blocks.end(), blended) &&
         std::none_of(sets_.prisms.blocks.begin(), sets_.prisms.blocks.end(), blended) &&
         std::none_of(model_.actuators.begin(), model_.actuators.end(),
                      [](const Actuator& a) { return has_measure(a) && a.distribution != Distribution::uniform; });
}

/// Returns by how much a block's ratios, none of which is at the minimum, decrease where sum_j a'_j u_j is `moved`; at
/// fixed positions they increase by as much, over the gain, where the target increases by `moved`.
template <int K>
Pack System::fraction_of_change(const ActuationSet<K>& set, Index block, const Pack& ratio, const Following& following,
                                double moved) const {
  if (!is_proportional(set.actuator)) return moved / set.fraction_sum * set.fraction(block);
  return following.current > 0 ? moved / following.current * ratio : pack(0);
}

/// The derivative of local_ratios: zero for uniform ratios.
template <int K>
void System::ratio_changes(const ActuationSet<K>& set, const Scratch& local, std::size_t index, const Points& nodes,
                           std::vector<Pack>& changes, Team& team) const {
  const std::vector<Pack>& ratios = local.ratios[index];
  const Following& following = local.following[index];
  if (!redistributes(set.actuator)) {
    std::fill(changes.begin(), changes.end(), pack(0));
    return;
  }
  team.pieces(set.block_count(), [&](Index begin, Index end) {
    Shape<K> shape, change;
    for (Index b = begin; b < end; ++b) {
      load<K>(local.nodes, set.nodes[b], shape);
      load<K>(nodes, set.nodes[b], change);
      changes[b] = ratio_change<K>(set.blocks[b], shape, change);
    }
  });
  double moved = 0;
  for (Index e = 0; e < set.count; ++e)
    moved += changes[e / lanes][e % lanes] * set.blocks[e / lanes].measure[e % lanes];
  for (Index b = 0; b < set.block_count(); ++b)
    changes[b] =
        follows(ratios[b]) * (following.gain * changes[b] - fraction_of_change<K>(set, b, ratios[b], following, moved));
}

/// kernel(set, index of the set, block, centred shape, its change, pull), over all blocks; out.nodes is the change.
template <class Kernel>
void System::each_change(const Scratch& local, Scratch& out, Team& team, const Kernel& kernel) const {
  std::size_t index = 0;
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    team.pieces(set.block_count(), [&](Index begin, Index end) {
      Shape<K> shape, change, pull;
      for (Index b = begin; b < end; ++b) {
        load<K>(local.nodes, set.nodes[b], shape);
        load<K>(out.nodes, set.nodes[b], change);
        center<K>(shape);
        kernel(set, index, b, shape, change, pull);
        store<K>(pull, set.first_slot + K * lanes * b, std::min<Index>(lanes, set.count - lanes * b), out.pulls.data());
      }
    });
    ++index;
  });
  gather(out.pulls, out.residual, team);
}

void System::residual_change(const Scratch& local, const Points& change, Scratch& out, Team& team) const {
  spread(change, out.nodes);
  std::size_t index = 0;
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    if constexpr (!std::is_same_v<Block, BodyBlock<K>>)
      ratio_changes<K>(set, local, index, out.nodes, out.ratios[index], team);
    ++index;
  });
  const auto kernel = [&]<int K, class Block>(const ElementSet<K, Block>& set, std::size_t i, Index b,
                                              const Shape<K>& shape, const Shape<K>& moved, Shape<K>& pull) {
    const PackRotation& rotation = local.rotations[i][b];
    if constexpr (std::is_same_v<Block, BodyBlock<K>>)
      pull_change_of_body<K>(set.blocks[b], shape, rotation, moved, pull);
    else
      pull_change_of_actuation<K>(set.blocks[b], local.ratios[i][b], out.ratios[i][b], shape, rotation, moved, pull);
  };
  each_change(local, out, team, kernel);
}

void System::turned_move(const Scratch& local, const Points& change, Scratch& out, Team& team) const {
  spread(change, out.nodes);
  const auto kernel = [&]<int K, class Block>(const ElementSet<K, Block>& set, std::size_t i, Index b,
                                              const Shape<K>& shape, const Shape<K>& moved, Shape<K>& pull) {
    const PackRotation& rotation = local.rotations[i][b];
    if constexpr (std::is_same_v<Block, BodyBlock<K>>)
      turned_move_of_body<K>(set.blocks[b], shape, rotation, moved, pull);
    else
      turned_move_of_actuation<K>(set.blocks[b], local.ratios[i][b], shape, rotation, moved, pull);
  };
  each_change(local, out, team, kernel);
}

void System::redistributions(const Scratch& local, Scratch& work, std::vector<Redistribution>& out, Team& team) const {
  std::size_t index = 0, count = 0;
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    if constexpr (!std::is_same_v<Block, BodyBlock<K>>) {
      if (redistributes(set.actuator)) {
        if (out.size() == count) out.emplace_back();
        Redistribution& part = out[count++];
        const auto collect = [&](const auto& value_of, Points& sums) {
          std::fill(work.pulls.begin(), work.pulls.end(), 0.0);
          team.pieces(set.block_count(), [&](Index begin, Index end) {
            Shape<K> shape, value;
            RatioCoupling<K> coupling;
            for (Index b = begin; b < end; ++b) {
              load<K>(local.nodes, set.nodes[b], shape);
              center<K>(shape);
              const Pack& ratio = local.ratios[index][b];
              ratio_coupling<K>(set.blocks[b], ratio, shape, local.rotations[index][b], coupling);
              value_of(coupling, b, follows(ratio), value);
              store<K>(value, set.first_slot + K * lanes * b, elements_of_block(set, b), work.pulls.data());
            }
          });
          gather(work.pulls, sums, team);
        };
        part.source.resize(model_.rest.rows(), 3);
        part.target.resize(model_.rest.rows(), 3);
        collect(
            [&](const RatioCoupling<K>& coupling, Index b, const Pack& free, Shape<K>& value) {
              const Pack fraction = fraction_of_change<K>(set, b, local.ratios[index][b], local.following[index], 1);
              for (int i = 0; i < K; ++i) value[i] = (free * fraction) * coupling.pull_slope[i];
            },
            part.source);
        collect(
            [&](const RatioCoupling<K>& coupling, Index b, const Pack&, Shape<K>& value) {
              for (int i = 0; i < K; ++i) value[i] = set.blocks[b].measure * coupling.ratio_slope[i];
            },
            part.target);
      }
    }
    ++index;
  });
}

void System::command_change(const Scratch& local, Index actuator, Scratch& out, Team& team) const {
  const double rest_measure = model_.actuators[actuator].rest_measure;
  std::fill(out.pulls.begin(), out.pulls.end(), 0.0);
  std::size_t index = 0;
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    if constexpr (!std::is_same_v<Block, BodyBlock<K>>) {
      const Following& following = local.following[index];
      const double measure = set.measure_sum;
      team.pieces(set.actuator == actuator ? set.block_count() : 0, [&](Index begin, Index end) {
        Shape<K> shape, still, pull;
        for (Pack3& point : still) point = Pack3{};
        for (Index b = begin; b < end; ++b) {
          load<K>(local.nodes, set.nodes[b], shape);
          center<K>(shape);
          const Pack& ratio = local.ratios[index][b];
          // uniform; proportional: c grows, and the ratios by as much over it
          const Pack each = !redistributes(set.actuator)     ? pack(1 / measure)
                            : !is_proportional(set.actuator) ? fraction_of_change<K>(set, b, ratio, following, 1)
                            : following.current > 0          ? ratio / following.target
                                                             : pack(1 / measure);
          const Pack change = rest_measure * each;
          pull_change_of_actuation<K>(set.blocks[b], ratio, select(ratio > min_ratio, change, pack(0)), shape,
                                      local.rotations[index][b], still, pull);
          store<K>(pull, set.first_slot + K * lanes * b, std::min<Index>(lanes, set.count - lanes * b),
                   out.pulls.data());
        }
      });
    }
    ++index;
  });
  gather(out.pulls, out.residual, team);
}

}  // namespace softkin::target_shape
