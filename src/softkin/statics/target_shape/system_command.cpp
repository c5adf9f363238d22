#include <algorithm>
#include <softkin/energy/target_shape_stiffness.hpp>
#include <softkin/statics/target_shape/blocks.hpp>
#include <softkin/statics/target_shape/system.hpp>

namespace softkin::target_shape {

using namespace energy;

void System::command_change(const Scratch& local, Index actuator, Scratch& out, Team& team) const {
  const double rest_measure = model_.actuators[actuator].rest_measure;
  std::fill(out.pulls.begin(), out.pulls.end(), 0.0);
  std::size_t index = 0;
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    if constexpr (!std::is_same_v<Block, BodyBlock<K>>) {
      const bool least_norm = redistributes(set.actuator);
      const double common = rest_measure / (least_norm ? set.measure_squares : set.measure_sum);
      team.pieces(set.actuator == actuator ? set.block_count() : 0, [&](Index begin, Index end) {
        Shape<K> shape, still, pull;
        for (Pack3& point : still) point = Pack3{};
        for (Index b = begin; b < end; ++b) {
          load<K>(local.nodes, set.nodes[b], shape);
          center<K>(shape);
          const Pack& ratio = local.ratios[index][b];
          const Pack change = least_norm ? common * set.blocks[b].measure : pack(common);
          pull_change_of_actuation<K>(set.blocks[b], ratio, select(ratio > least_ratio, change, pack(0)), shape,
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
