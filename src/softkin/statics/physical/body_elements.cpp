#include <algorithm>
#include <numeric>
#include <softkin/statics/electric_layer.hpp>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/lanes.hpp>

namespace softkin::physical {

using namespace energy;

namespace {

/// Returns the elements in the order of a space-filling curve, so that neighbours have vertices in the same cache
/// lines.
template <class Element>
std::vector<Index> spatial_order(const Points& rest, const std::vector<Element>& elements) {
  const Eigen::RowVector3d low = rest.colwise().minCoeff();
  const double extent = std::max((rest.colwise().maxCoeff() - low).maxCoeff(), 1e-300);
  std::vector<std::pair<std::uint64_t, Index>> keys;
  for (const Element& element : elements) {
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (const Index v : element) middle += rest.row(v) / static_cast<double>(element.size());
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<std::uint64_t>((middle[axis] - low[axis]) / extent * 1048575);
      for (int bit = 0; bit < 20; ++bit) key |= (place >> bit & 1) << (3 * bit + axis);
    }
    keys.emplace_back(key, static_cast<Index>(keys.size()));
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Index> order;
  for (const auto& key : keys) order.push_back(key.second);
  return order;
}

}  // namespace

/// Adds the pressures of an element to a set, into its lane and in advance into later lanes.
template <int K, int Q>
void Body::set_pressures(Set<K, Q>& set, const ElasticLaw& law, const std::array<Index, 4>& vertices, int first_lane) {
  if (first_lane == 0) {
    set.corners.compliance.emplace_back();
    set.corners.pressures.emplace_back();
  }
  const SplitLaw parts = split(law, K == 10);
  for (int l = first_lane; l < lanes; ++l) {
    set_law(set.blocks.back().law, l, parts.law);
    set.corners.compliance.back().softness[l] = parts.softness;
    set.corners.compliance.back().smoothing[l] = parts.smoothing;
    for (std::size_t i = 0; i < 4; ++i) set.corners.pressures.back()[i][l] = vertices[i];
  }
}

/// Returns the set of such elements; creates it if there is none yet.
template <int K, int Q>
Body::Set<K, Q>& Body::set_of(std::vector<Set<K, Q>>& sets, const Model& model, const ElementRole& role, Index grower,
                              bool mixed) {
  const Material& material = model.elements.materials[role.material];
  const Law law = material.elastic.law;
  const auto branches = static_cast<int>(material.viscosity.size());
  const auto found = std::find_if(sets.begin(), sets.end(), [&](const Set<K, Q>& s) {
    return s.law == law && s.actuator == role.actuator && s.grower == grower && s.viscous.branches == branches &&
           s.mixed == mixed;
  });
  if (found != sets.end()) return *found;
  Set<K, Q>& set = sets.emplace_back();
  set.law = law;
  set.viscous.branches = branches;
  set.mixed = mixed;
  set.actuator = role.actuator;
  set.grower = grower;
  if (grower >= 0) set.growth = model.growths[grower];
  if (role.actuator >= 0) {
    set.charged = under_voltage(model.actuators[role.actuator]);
    if (const auto* dea = model.actuators[role.actuator].as<DeaDrive>()) set.prestretch = dea->prestretch;
  }
  return set;
}

template <int K, int Q, class Element>
void Body::add(std::vector<Set<K, Q>>& sets, const Model& model, const ElementRole& role, Index element,
               const Element& nodes, const Pressures* pressures, Index grower) {
  const Material& material = model.elements.materials[role.material];
  const bool mixed = pressures && material.mixed;
  Set<K, Q>& set = set_of(sets, model, role, grower, mixed);
  Eigen::Matrix<double, K, 3> rest;
  for (int i = 0; i < K; ++i) rest.row(i) = model.rest.row(nodes[i]);
  const ElasticRest<K, Q> shape = elastic_rest(rest);
  const int lane = set.count % lanes;
  if (lane == 0) {
    set.blocks.emplace_back();
    set.nodes.emplace_back();
    set.frames.emplace_back();
    set.viscous.moduli.resize(set.viscous.moduli.size() + material.viscosity.size());
    set.viscous.times.resize(set.viscous.moduli.size());
  }
  ElasticBlock<K, Q>& block = set.blocks.back();
  for (int l = lane; l < lanes; ++l) {  // later elements overwrite the lanes that this one fills in advance
    set_law(block.law, l, material.elastic);
    for (std::size_t i = 0, at = set.viscous.moduli.size() - material.viscosity.size(); i < material.viscosity.size();
         ++i) {
      set.viscous.moduli[at + i][l] = material.viscosity[i].modulus_MPa;
      set.viscous.times[at + i][l] = material.viscosity[i].time_s;
    }
    for (int q = 0; q < Q; ++q) {
      for (int i = 0; i < K; ++i) set_lane(block.slope[q][i], l, shape.slope[q].row(i).transpose());
      block.volume[q][l] = l == lane ? shape.volume[q] : 0;
    }
    for (int i = 0; i < K; ++i) set.nodes.back()[i][l] = nodes[i];
  }
  if constexpr (K == 6)
    set.frames.back()[lane] = layer_frame(rest);
  else if (mixed)
    set_pressures(set, material.elastic, pressures->of[element], lane);
  set.elements.push_back(element);
  ++set.count;
}

void Body::add_elements(const Model& model, const Pressures* pressures) {
  const Growers growers = growers_of(model);
  const auto grower = [](const std::vector<Index>& of, Index e) { return of.empty() ? -1 : of[e]; };
  for (const Index e : spatial_order(model.rest, model.elements.tetrahedra)) {
    const ElementRole& role = model.elements.tetrahedron_roles[e];
    const Tetrahedron& t = model.elements.tetrahedra[e];
    if (model.elements.edge_nodes.empty()) {
      add(linear_, model, role, e, t, pressures, grower(growers.tetrahedra, e));
    } else {
      std::array<Index, 10> nodes;
      std::copy(t.begin(), t.end(), nodes.begin());
      std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
      add(quadratic_, model, role, e, nodes, pressures, grower(growers.tetrahedra, e));
    }
  }
  for (const Index e : spatial_order(model.rest, model.elements.prisms))
    add(prisms_, model, model.elements.prism_roles[e], std::ssize(model.elements.tetrahedra) + e,
        model.elements.prisms[e], nullptr, grower(growers.prisms, e));
  for (auto& set : prisms_)
    if (set.charged) add_field(model, set);
}

Body::Body(const Model& model, const Pressures* pressures)
    : vertices_(model.rest.rows()), pressure_unit_(pressures ? pressures->unit : 1) {
  add_elements(model, pressures);
  add_directions(model);
  for (Index a = 0; a < std::ssize(model.actuators); ++a) {
    if (model.actuators[a].is<DeaDrive>()) (under_voltage(model.actuators[a]) ? voltages_ : ratios_).push_back(a);
    if (model.actuators[a].is<GrowthDrive>()) growths_.push_back(a);
  }
  number_sets();
  number_pulls();
}

/// Numbers the pulls, blocks and branches of each set among those of all.
void Body::number_sets() {
  each_set([&]<int K, int Q>(Set<K, Q>& set) {
    set.first_pull = pulls_;
    pulls_ += K * set.count;
    blocks_ += set.blocks.size();
    set.viscous.first_branch = branches_;
    set.viscous.first_strain = strains_;
    branches_ += set.viscous.moduli.size();
    set.viscous.first_begun = begun_;
    strains_ += set.strains_each() * set.blocks.size();
    begun_ += set.begun_each() * set.blocks.size();
  });
  each_set([&]<int K, int Q>(Set<K, Q>& set) {
    set.corners.first_miss = pulls_ + misses_;
    if (set.mixed) misses_ += 4 * set.count;
  });
  const auto count_changed = [](auto& sets) {
    Index count = 0;
    for (auto& set : sets)
      if (set.actuator >= 0 || set.grower >= 0) set.changed = count++;
  };
  count_changed(linear_);
  count_changed(quadratic_);
  count_changed(prisms_);
}

/// Lists the pulls at each vertex.
void Body::number_pulls() {
  const auto each_pull = [&](const auto& visit) {
    each_set([&]<int K, int Q>(Set<K, Q>& set) {
      for (Index e = 0; e < set.count; ++e)
        for (int i = 0; i < K; ++i) visit(set.nodes[e / lanes][i][e % lanes], set.first_pull + K * e + i);
      for (Index e = 0; set.mixed && e < set.count; ++e)
        for (int i = 0; i < 4; ++i)
          visit(set.corners.pressures[e / lanes][i][e % lanes], set.corners.first_miss + 4 * e + i);
    });
  };
  pull_starts_.assign(vertices_ + 1, 0);
  each_pull([&](Index vertex, Index) { ++pull_starts_[vertex + 1]; });
  std::partial_sum(pull_starts_.begin(), pull_starts_.end(), pull_starts_.begin());
  pull_order_.resize(pulls_ + misses_);
  std::vector<Index> next(pull_starts_.begin(), pull_starts_.end() - 1);
  each_pull([&](Index vertex, Index pull) { pull_order_[next[vertex]++] = pull; });
}

/// Sets the permittivities of a set under voltage, after its elements.
void Body::add_field(const Model& model, Set<6, 6>& set) {
  const std::vector<double> permittivity = layer_permittivity(model, set.actuator);
  const Index tetrahedra = model.elements.tetrahedra.size();
  set.permittivity.assign(set.blocks.size(), Pack{});
  for (Index e = 0; e < set.count; ++e)
    set.permittivity[e / lanes][e % lanes] = permittivity[set.elements[e] - tetrahedra];
}

Body::Scratch Body::make_scratch() const {
  Scratch scratch;
  scratch.pulls.resize(3 * static_cast<std::size_t>(pulls_ + misses_));
  scratch.energies.resize(blocks_);
  scratch.inverted.resize(blocks_);
  scratch.forbidden.resize(blocks_);
  each_set([&]<int K, int Q>(const Set<K, Q>& set) {
    if (set.changed >= 0) changed_of<K, Q>(scratch).push_back({set.blocks});
  });
  return scratch;
}

void Body::add_cliques(linear::Cliques& cliques) {
  each_set([&]<int K, int Q>(Set<K, Q>& set) {
    set.first_slot = cliques.slots.back();
    std::array<Index, K + 4> nodes;
    for (Index e = 0; e < set.count; ++e) {
      for (int i = 0; i < K; ++i) nodes[i] = set.nodes[e / lanes][i][e % lanes];
      for (int i = 0; set.mixed && i < 4; ++i) nodes[K + i] = set.corners.pressures[e / lanes][i][e % lanes];
      cliques.add(std::span(nodes).first(set.mixed ? K + 4 : K));
    }
  });
}

std::vector<std::int64_t> Body::element_slots() const {
  std::vector<std::int64_t> slots;
  each_set([&]<int K, int Q>(const Set<K, Q>& set) {
    const int matrices = set.matrices();
    for (Index e = 0; e < set.count; ++e) {
      const std::size_t element = set.elements[e];
      if (slots.size() <= element) slots.resize(element + 1);
      slots[element] = set.first_slot + static_cast<std::int64_t>(matrices) * e;
    }
  });
  return slots;
}

Eigen::SparseMatrix<double> Body::laplacian() const {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<bool> stretched(vertices_);
  const auto add_set = [&]<int K, int Q>(const Set<K, Q>& set) {
    for (Index e = 0; e < set.count; ++e) {
      const ElasticBlock<K, Q>& block = set.blocks[e / lanes];
      const int l = e % lanes;
      for (int i = 0; i < K; ++i)
        for (int j = 0; j < K; ++j) {
          const Index row = set.nodes[e / lanes][i][l], column = set.nodes[e / lanes][j][l];
          stretched[row] = true;
          if (row < column) continue;
          double sum = 0;
          for (int q = 0; q < Q; ++q)
            sum += block.volume[q][l] * lane_of(block.slope[q][i], l).dot(lane_of(block.slope[q][j], l));
          entries.emplace_back(row, column, sum);
        }
    }
  };
  for (const auto& set : linear_) add_set(set);
  for (const auto& set : quadratic_) add_set(set);
  for (const auto& set : prisms_) add_set(set);
  for (Index v = 0; v < vertices_; ++v)
    if (!stretched[v]) entries.emplace_back(v, v, 1.0);
  Eigen::SparseMatrix<double> matrix(vertices_, vertices_);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace softkin::physical
