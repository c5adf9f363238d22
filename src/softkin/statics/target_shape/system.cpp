#include <softkin/statics/target_shape/element_sets.hpp>
#include <softkin/statics/target_shape/system.hpp>

namespace softkin::target_shape {

using namespace energy;

namespace {

/// Runs kernel(block, shape, rotation, out) over a set and stores the results.
template <int K, class Block, class Kernel>
void run(const ElementSet<K, Block>& set, const Points& nodes, std::vector<PackRotation>& rotations, double* pulls,
         Pack* energies, Team& team, const Kernel& kernel) {
  team.pieces(set.block_count(), [&](Index begin, Index end) {
    Shape<K> shape;
    ElementPull<K> out;
    for (Index b = begin; b < end; ++b) {
      load<K>(nodes, set.nodes[b], shape);
      kernel(b, shape, rotations[b], out);
      store<K>(out.pull, set.first_slot + K * lanes * b, std::min<Index>(lanes, set.count - lanes * b), pulls);
      energies[b] = out.energy;
    }
  });
}

}  // namespace

System::System(const Model& model) : model_(model), sets_(make_element_sets(model)) {
  const Index nodes = model.rest.rows() + std::ssize(sets_.points);
  const auto each_slot = [&](const auto& visit) {
    sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
      for (Index e = 0; e < set.count; ++e)
        for (int i = 0; i < K; ++i) visit(set.nodes[e / lanes][i][e % lanes], set.first_slot + K * e + i);
    });
  };
  slot_starts_.assign(nodes + 1, 0);
  each_slot([&](Index node, Index) { ++slot_starts_[node + 1]; });
  for (Index v = 0; v < nodes; ++v) slot_starts_[v + 1] += slot_starts_[v];
  slots_.resize(slot_starts_.back());
  std::vector<Index> next(slot_starts_.begin(), slot_starts_.end() - 1);
  each_slot([&](Index node, Index slot) { slots_[next[node]++] = slot; });
}

System::Scratch System::make_scratch() const {
  Scratch scratch;
  std::size_t blocks = 0;
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    scratch.rotations.emplace_back(set.block_count());
    scratch.ratios.emplace_back(set.actuator >= 0 ? set.block_count() : 0);
    scratch.following.emplace_back();
    blocks += set.blocks.size();
  });
  scratch.energies.resize(blocks);
  scratch.pulls.resize(3 * static_cast<std::size_t>(sets_.slots));
  scratch.nodes.resize(model_.rest.rows() + std::ssize(sets_.points), 3);
  scratch.residual.resize(model_.rest.rows(), 3);
  return scratch;
}

/// Least norm: the least change from the current ratios that meets Eqs. (6)-(8),
/// a_i = a_i^cur + s_i (a U - sum_j a_j^cur u_j) / sum_j s_j u_j with weights s_i = u_i, or 1 where the mesh must not
/// matter; for a cable, a U counts the gaps only. Proportional: a_i = c a_i^cur with c = a U / sum_j a_j^cur u_j; where
/// the current measures sum to nothing, uniform.
template <int K>
void System::local_ratios(const ActuationSet<K>& set, double requested, const Points& nodes, std::vector<Pack>& ratios,
                          Following& following, Team& team) const {
  const Actuator& actuator = model_.actuators[set.actuator];
  const double target = requested * actuator.rest_measure - (actuator.rest_measure - set.measure_sum);
  following = {.target = target};
  const auto all_alike = [&] {
    std::fill(ratios.begin(), ratios.end(), pack(std::max(min_ratio, target / set.measure_sum)));
  };
  if (actuator.distribution == Distribution::uniform) return all_alike();
  team.pieces(set.block_count(), [&](Index begin, Index end) {
    Shape<K> shape;
    for (Index b = begin; b < end; ++b) {
      load<K>(nodes, set.nodes[b], shape);
      ratios[b] = current_ratio<K>(set.blocks[b], shape);
    }
  });
  double current = 0;
  for (Index e = 0; e < set.count; ++e)
    current += ratios[e / lanes][e % lanes] * set.blocks[e / lanes].measure[e % lanes];
  if (actuator.distribution == Distribution::proportional) {
    following.current = current;
    following.gain = current > 0 ? target / current : 0;
    if (!(current > 0)) return all_alike();
    for (Pack& ratio : ratios) ratio = max(pack(min_ratio), following.gain * ratio);
    return;
  }
  const double change = (target - current) / set.fraction_sum;
  for (Index b = 0; b < set.block_count(); ++b) ratios[b] = max(pack(min_ratio), ratios[b] + change * set.fraction(b));
}

double System::local_step(const Actuation& actuation, const Points& positions, Scratch& scratch, Team& team) const {
  spread(positions, scratch.nodes);
  std::size_t index = 0;
  Pack* energies = scratch.energies.data();
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    const auto kernel = [&](Index b, Shape<K>& shape, PackRotation& rotation, ElementPull<K>& out) {
      if constexpr (std::is_same_v<Block, BodyBlock<K>>)
        pull_of_body<K>(set.blocks[b], shape, rotation, out);
      else
        pull_of_actuation<K>(set.blocks[b], scratch.ratios[index][b], shape, rotation, out);
    };
    if constexpr (!std::is_same_v<Block, BodyBlock<K>>)
      local_ratios<K>(set, actuation[set.actuator], scratch.nodes, scratch.ratios[index], scratch.following[index],
                      team);
    run<K>(set, scratch.nodes, scratch.rotations[index], scratch.pulls.data(), energies, team, kernel);
    energies += set.block_count();
    ++index;
  });
  gather(scratch.pulls, scratch.residual, team);
  Pack energy{};
  for (const Pack& part : scratch.energies) energy += part;
  return sum(energy);
}

/// Embedded points' places, or moves, from the vertices'.
void System::spread(const Points& positions, Points& nodes) const {
  const Index vertices = positions.rows();
  nodes.topRows(vertices) = positions;
  for (std::size_t i = 0; i < sets_.points.size(); ++i)
    nodes.row(vertices + static_cast<Index>(i)) = sets_.points[i]->at(positions).transpose();
}

void System::gather(const std::vector<double>& pulls, Points& residual, Team& team) const {
  const auto pull_at = [&](Index node) {
    Vec3 total = Vec3::Zero();
    for (Index i = slot_starts_[node]; i < slot_starts_[node + 1]; ++i)
      total += Eigen::Map<const Vec3>(pulls.data() + 3 * static_cast<std::size_t>(slots_[i]));
    return total;
  };
  const Index vertices = residual.rows();
  team.pieces(vertices, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) residual.row(v) = pull_at(v).transpose();
  });
  for (std::size_t i = 0; i < sets_.points.size(); ++i) {
    const EmbeddedPoint& point = *sets_.points[i];
    const Vec3 pull = pull_at(vertices + static_cast<Index>(i));
    for (std::size_t k = 0; k < point.vertices.size(); ++k)
      residual.row(point.vertices[k]) += point.weights[k] * pull.transpose();
  }
}

Eigen::SparseMatrix<double> System::global_matrix() const {
  using Part = std::pair<Index, double>;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(3 * static_cast<std::size_t>(sets_.slots));
  const auto expand = [&](Index node, std::vector<Part>& parts) {
    parts.clear();
    if (node < model_.rest.rows()) {
      parts.emplace_back(node, 1.0);
      return;
    }
    const EmbeddedPoint& point = *sets_.points[node - static_cast<Index>(model_.rest.rows())];
    for (std::size_t k = 0; k < point.vertices.size(); ++k) parts.emplace_back(point.vertices[k], point.weights[k]);
  };
  std::vector<Part> a, b;
  sets_.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    for (Index e = 0; e < set.count; ++e)
      for (int i = 0; i < K; ++i)
        for (int j = 0; j < K; ++j) {
          const double n_ij = set.blocks[e / lanes].weight[e % lanes] * ((i == j ? 1.0 : 0.0) - 1.0 / K);
          expand(set.nodes[e / lanes][i][e % lanes], a);
          expand(set.nodes[e / lanes][j][e % lanes], b);
          for (const auto& [row, row_weight] : a)
            for (const auto& [column, column_weight] : b)
              if (row >= column) entries.emplace_back(row, column, n_ij * row_weight * column_weight);
        }
  });
  Eigen::SparseMatrix<double> matrix(model_.rest.rows(), model_.rest.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace softkin::target_shape
