#include <algorithm>
#include <softkin/energy/target_shape_stiffness.hpp>
#include <softkin/statics/target_shape/blocks.hpp>
#include <softkin/statics/target_shape/newton_matrix.hpp>

namespace softkin::target_shape {

using namespace energy;

namespace {

double entry(const Pack33& block, int row, int column, int lane) {
  const Pack3& values = block.row[row];
  return column == 0 ? values.x[lane] : column == 1 ? values.y[lane] : values.z[lane];
}

template <int K>
void copy(const TargetStiffness<K>& stiffness, int lane, double* slots) {
  for (const Pack33& block : stiffness.block)
    for (int r = 0; r < 3; ++r) {
      *slots++ = block.row[r].x[lane];
      *slots++ = block.row[r].y[lane];
      *slots++ = block.row[r].z[lane];
    }
}

}  // namespace

NewtonMatrix::NewtonMatrix(const Model& model, const System& system)
    : system_(system), pattern_(static_cast<Index>(model.rest.rows()), make_cliques(model)) {}

linear::Cliques NewtonMatrix::make_cliques(const Model& model) {
  linear::Cliques cliques;
  const ElementSets& sets = system_.sets();
  const Index vertices = static_cast<Index>(model.rest.rows());
  std::vector<Index> members;
  sets.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    for (Index e = 0; e < set.count; ++e) {
      members.clear();
      Triangle triangle;
      for (int i = 0; i < K; ++i) {
        const Index node = set.nodes[e / lanes][i][e % lanes];
        if (node < vertices) {
          members.push_back(node);
          continue;
        }
        const EmbeddedPoint& point = *sets.points[node - vertices];
        for (std::size_t k = 0; k < point.vertices.size(); ++k) {
          auto found = std::find(members.begin(), members.end(), point.vertices[k]);
          if (found == members.end()) found = members.insert(found, point.vertices[k]);
          if constexpr (K == 3)
            triangle.parts[i].push_back({static_cast<Index>(found - members.begin()), point.weights[k]});
        }
      }
      slots_.push_back(cliques.slots.back());
      cliques.add(members);
      if constexpr (K == 3) triangles_.push_back(std::move(triangle));
    }
  });
  slots_.push_back(cliques.slots.back());
  return cliques;
}

/// Block (a, b) of the clique: the sum of weight_ia weight_jb K_ij over the triangle's points.
void NewtonMatrix::add_triangle(const Triangle& triangle, const TargetStiffness<3>& stiffness, int lane,
                                double* slots) const {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Pack33& block = stiffness.block[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
      Mat3 values;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) values(r, c) = i >= j ? entry(block, r, c, lane) : entry(block, c, r, lane);
      for (const auto& [a, a_weight] : triangle.parts[i])
        for (const auto& [b, b_weight] : triangle.parts[j]) {
          if (b > a) continue;
          double* slot = slots + 9 * (static_cast<std::int64_t>(a) * (a + 1) / 2 + b);
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) slot[3 * r + c] += a_weight * b_weight * values(r, c);
        }
    }
}

void NewtonMatrix::assemble(const System::Scratch& local, bool projected, LargeVector<double>& slots,
                            Team& team) const {
  slots.resize(9 * static_cast<std::size_t>(slots_.back()));
  std::size_t index = 0, element = 0, triangle = 0;
  system_.sets().each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    const auto store_block = [&](const TargetStiffness<K>& stiffness, Index block) {
      const Index count = std::min<Index>(lanes, set.count - lanes * block);
      for (Index l = 0; l < count; ++l) {
        const std::size_t e = element + static_cast<std::size_t>(lanes * block + l);
        double* target = slots.data() + 9 * slots_[e];
        if constexpr (K == 3) {
          std::fill(target, slots.data() + 9 * slots_[e + 1], 0.0);
          add_triangle(triangles_[triangle + static_cast<std::size_t>(lanes * block + l)], stiffness, l, target);
        } else {
          copy<K>(stiffness, l, target);
        }
      }
    };
    team.pieces(set.block_count(), [&](Index begin, Index end) {
      Shape<K> shape;
      TargetStiffness<K> stiffness;
      for (Index b = begin; b < end; ++b) {
        load<K>(local.nodes, set.nodes[b], shape);
        center<K>(shape);
        const PackRotation& rotation = local.rotations[index][b];
        if constexpr (std::is_same_v<Block, BodyBlock<K>>)
          stiffness_of_body<K>(set.blocks[b], shape, rotation, projected, stiffness);
        else
          stiffness_of_actuation<K>(set.blocks[b], local.ratios[index][b], system_.redistributes(set.actuator), shape,
                                    rotation, projected, stiffness);
        store_block(stiffness, b);
      }
    });
    element += static_cast<std::size_t>(set.count);
    if constexpr (K == 3) triangle += static_cast<std::size_t>(set.count);
    ++index;
  });
}

}  // namespace softkin::target_shape
