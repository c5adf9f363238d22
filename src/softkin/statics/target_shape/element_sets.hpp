#pragma once

#include <softkin/energy/target_shape.hpp>
#include <softkin/model/model.hpp>

namespace softkin::target_shape {

/// Elements of one kernel, `lanes` to a block. Nodes beyond the mesh's vertices are the model's embedded points.
template <int K, class Block>
struct ElementSet {
  Index count = 0;       // elements; the last block repeats the last one, without weight, to fill its lanes
  Index first_slot = 0;  // of the pulls that this set writes: element e, node i writes slot first_slot + K e + i
  Index actuator = -1;
  double measure_sum = 0;   // of the actuation elements at rest: sum u
  double fraction_sum = 0;  // sum of fraction times measure
  bool even = false;        // a change of all is distributed evenly, whatever an element's measure
  std::vector<Block> blocks;
  std::vector<std::array<std::array<Index, energy::lanes>, K>> nodes;

  [[nodiscard]] Index block_count() const { return blocks.size(); }
  /// How least-norm ratios distribute a change: by measure where sum a^2 is least, which gives more to larger elements;
  /// evenly where sum u a^2 is least, which does not depend on how the mesh divides a chamber.
  [[nodiscard]] energy::Pack fraction(Index block) const { return even ? energy::pack(1) : blocks[block].measure; }
};

template <int K>
using BodySet = ElementSet<K, energy::BodyBlock<K>>;
template <int K>
using ActuationSet = ElementSet<K, energy::ActuationBlock<K>>;

/// Every element of a model, ready for the kernels of the target-shape formulation.
struct ElementSets {
  BodySet<4> tetrahedra;
  BodySet<6> prisms;
  std::vector<ActuationSet<3>> cables;
  std::vector<ActuationSet<4>> pneumatic;
  std::vector<ActuationSet<6>> dea;
  std::vector<const EmbeddedPoint*> points;  // node n_vertices + i
  Index slots = 0;

  template <class Visit>
  void each(Visit&& visit) const {
    visit(tetrahedra);
    visit(prisms);
    for (const auto& set : cables) visit(set);
    for (const auto& set : pneumatic) visit(set);
    for (const auto& set : dea) visit(set);
  }
};

/// The elements of Eq. (9), weighted by w Vol, or according to Model::weights. model must outlive the result.
[[nodiscard]] ElementSets make_element_sets(const Model& model);

/// Local ratios stay above this, where a target shape would vanish or turn over [-].
inline constexpr double min_ratio = 0.01;

/// A block's nodes, lane by lane.
template <int K, class Nodes>
inline void load(const Points& positions, const Nodes& nodes, energy::Shape<K>& shape) {
  for (int i = 0; i < K; ++i)
    for (int l = 0; l < energy::lanes; ++l) {
      const double* p = positions.data() + 3 * static_cast<std::size_t>(nodes[i][l]);
      shape[i].x[l] = p[0];
      shape[i].y[l] = p[1];
      shape[i].z[l] = p[2];
    }
}

/// Puts a block's values into the slots from `first` on.
template <int K>
inline void store(const energy::Shape<K>& values, Index first, Index count, double* pulls) {
  for (Index l = 0; l < count; ++l)
    for (int i = 0; i < K; ++i) {
      double* p = pulls + 3 * static_cast<std::size_t>(first + K * l + i);
      p[0] = values[i].x[l];
      p[1] = values[i].y[l];
      p[2] = values[i].z[l];
    }
}

}  // namespace softkin::target_shape
