#include <algorithm>
#include <cmath>
#include <numeric>
#include <softkin/core/dense.hpp>
#include <softkin/statics/electric_layer.hpp>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/load_block.hpp>

namespace softkin::physical {

using namespace energy;

namespace {

/// Elements along a curve through space that keeps neighbours together: their vertices share cache lines.
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

void set_law(LawBlock& block, int lane, const ElasticLaw& law) {
  block.law = law.law;
  block.mu[lane] = law.mu;
  block.lambda[lane] = law.lambda;
  block.c10[lane] = law.c10;
  block.c01[lane] = law.c01;
  block.c20[lane] = law.c20;
  block.c30[lane] = law.c30;
  block.bulk[lane] = law.bulk;
  block.jm[lane] = law.jm;
}

void set_lane(Pack3& vector, int lane, const Vec3& value) {
  vector.x[lane] = value[0];
  vector.y[lane] = value[1];
  vector.z[lane] = value[2];
}

Vec3 lane_of(const Pack3& vector, int lane) {
  return {vector.x[lane], vector.y[lane], vector.z[lane]};
}

Mat3 lane_of(const Pack33& matrix, int lane) {
  Mat3 one;
  for (int r = 0; r < 3; ++r) one.row(r) = lane_of(matrix.row[r], lane).transpose();
  return one;
}

double von_mises(const Mat3& stress) {
  const Mat3 deviator = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

}  // namespace

/// Adds the pressures of an element to a set, into its lane and in advance into those behind.
template <int K, int Q>
void Body::set_pressures(Set<K, Q>& set, const ElasticLaw& law, const std::array<Index, 4>& vertices, int first_lane) {
  if (first_lane == 0) {
    set.compliance.emplace_back();
    set.pressures.emplace_back();
  }
  const SplitLaw parts = split(law, K == 10);
  for (int l = first_lane; l < lanes; ++l) {
    set_law(set.blocks.back().law, l, parts.law);
    set.compliance.back().softness[l] = parts.softness;
    set.compliance.back().smoothing[l] = parts.smoothing;
    for (std::size_t i = 0; i < 4; ++i) set.pressures.back()[i][l] = vertices[i];
  }
}

/// In a shape [MPa].
template <int K, int Q>
CornerPressure Body::pressure_of(const Set<K, Q>& set, Index block, const Points& positions) const {
  CornerPressure pressure = set.compliance[block];
  for (std::size_t i = 0; i < 4; ++i)
    for (int l = 0; l < lanes; ++l) pressure.at[i][l] = pressure_unit_ * positions(set.pressures[block][i][l], 0);
  return pressure;
}

template <int K, int Q>
void Body::store_miss(const Set<K, Q>& set, Index block, const PressureMiss& miss, Scratch& scratch) const {
  const Index count = std::min<Index>(lanes, set.count - lanes * block);
  double* out = scratch.pulls.data() + 3 * static_cast<std::ptrdiff_t>(set.first_miss + 4 * lanes * block);
  for (Index l = 0; l < count; ++l)
    for (const Pack& at : miss.at) {
      out[0] = pressure_unit_ * at[l];
      out[1] = out[2] = 0;
      out += 3;
    }
}

/// Behind the slots of the nodes among themselves.
template <int K, int Q>
void Body::store_coupling(const Set<K, Q>& set, Index block, const PressureCoupling<K>& coupling,
                          LargeVector<double>& slots) const {
  const int own = K * (K + 1) / 2, all = set.matrices();
  const double unit = pressure_unit_;
  const Index count = std::min<Index>(lanes, set.count - lanes * block);
  for (Index l = 0; l < count; ++l) {
    double* slot = slots.data() + 9 * (set.first_slot + static_cast<std::int64_t>(all) * (lanes * block + l) + own);
    std::fill(slot, slot + 9 * (all - own), 0.0);
    for (int i = 0, ij = 0; i < 4; ++i) {
      for (int a = 0; a < K; ++a, slot += 9) {
        slot[0] = unit * coupling.node[i][a].x[l];
        slot[1] = unit * coupling.node[i][a].y[l];
        slot[2] = unit * coupling.node[i][a].z[l];
      }
      for (int j = 0; j <= i; ++j, ++ij, slot += 9) slot[0] = unit * unit * coupling.own[ij][l];
    }
  }
}

template <int K, int Q, class Element>
void Body::add(std::vector<Set<K, Q>>& sets, const Model& model, const ElementRole& role, Index element,
               const Element& nodes, const Pressures* pressures) {
  const Material& material = model.materials[role.material];
  const Law law = material.elastic.law;
  const auto branches = static_cast<int>(material.viscosity.size());
  const bool mixed = pressures && material.mixed;
  auto set = std::find_if(sets.begin(), sets.end(), [&](const Set<K, Q>& s) {
    return s.law == law && s.actuator == role.actuator && s.branches == branches && s.mixed == mixed;
  });
  if (set == sets.end()) {
    set = sets.insert(sets.end(), Set<K, Q>{});
    set->law = law;
    set->branches = branches;
    set->mixed = mixed;
    set->actuator = role.actuator;
    if (role.actuator >= 0) {
      set->charged = under_voltage(model.actuators[role.actuator]);
      set->prestretch = model.actuators[role.actuator].prestretch;
    }
  }
  Eigen::Matrix<double, K, 3> rest;
  for (int i = 0; i < K; ++i) rest.row(i) = model.rest.row(nodes[i]);
  const ElasticRest<K, Q> shape = elastic_rest(rest);
  const int lane = set->count % lanes;
  if (lane == 0) {
    set->blocks.emplace_back();
    set->nodes.emplace_back();
    set->frames.emplace_back();
    set->moduli.resize(set->moduli.size() + material.viscosity.size());
    set->times.resize(set->moduli.size());
  }
  ElasticBlock<K, Q>& block = set->blocks.back();
  for (int l = lane; l < lanes; ++l) {  // later elements overwrite the lanes that this one fills in advance
    set_law(block.law, l, material.elastic);
    for (std::size_t i = 0, at = set->moduli.size() - material.viscosity.size(); i < material.viscosity.size(); ++i) {
      set->moduli[at + i][l] = material.viscosity[i].modulus_MPa;
      set->times[at + i][l] = material.viscosity[i].time_s;
    }
    for (int q = 0; q < Q; ++q) {
      for (int i = 0; i < K; ++i) set_lane(block.slope[q][i], l, shape.slope[q].row(i).transpose());
      block.volume[q][l] = l == lane ? shape.volume[q] : 0;
    }
    for (int i = 0; i < K; ++i) set->nodes.back()[i][l] = nodes[i];
  }
  if constexpr (K == 6)
    set->frames.back()[lane] = layer_frame(rest);
  else if (mixed)
    set_pressures(*set, material.elastic, pressures->of[static_cast<std::size_t>(element)], lane);
  set->elements.push_back(element);
  ++set->count;
}

Body::Body(const Model& model, const Pressures* pressures)
    : vertices_(static_cast<Index>(model.rest.rows())), pressure_unit_(pressures ? pressures->unit : 1) {
  for (const Index e : spatial_order(model.rest, model.tetrahedra)) {
    const ElementRole& role = model.tetrahedron_roles[e];
    const Tetrahedron& t = model.tetrahedra[e];
    if (model.edge_nodes.empty()) {
      add(linear_, model, role, e, t, pressures);
    } else {
      std::array<Index, 10> nodes;
      std::copy(t.begin(), t.end(), nodes.begin());
      std::copy(model.edge_nodes[e].begin(), model.edge_nodes[e].end(), nodes.begin() + 4);
      add(quadratic_, model, role, e, nodes, pressures);
    }
  }
  for (const Index e : spatial_order(model.rest, model.prisms))
    add(prisms_, model, model.prism_roles[e], static_cast<Index>(model.tetrahedra.size()) + e, model.prisms[e],
        nullptr);
  for (auto& set : prisms_)
    if (set.charged) add_field(model, set);
  for (Index a = 0; a < static_cast<Index>(model.actuators.size()); ++a)
    if (model.actuators[a].kind == ActuatorKind::dea)
      (under_voltage(model.actuators[a]) ? voltages_ : ratios_).push_back(a);
  each_set([&]<int K, int Q>(Set<K, Q>& set) {
    set.first_pull = pulls_;
    pulls_ += K * set.count;
    blocks_ += set.blocks.size();
    set.first_branch = branches_;
    set.first_strain = strains_;
    branches_ += set.moduli.size();
    set.first_begun = begun_;
    strains_ += set.strains_each() * set.blocks.size();
    begun_ += set.begun_each() * set.blocks.size();
  });
  each_set([&]<int K, int Q>(Set<K, Q>& set) {
    set.first_miss = pulls_ + misses_;
    if (set.mixed) misses_ += 4 * set.count;
  });
  const auto each_pull = [&](const auto& visit) {
    each_set([&]<int K, int Q>(Set<K, Q>& set) {
      for (Index e = 0; e < set.count; ++e)
        for (int i = 0; i < K; ++i) visit(set.nodes[e / lanes][i][e % lanes], set.first_pull + K * e + i);
      for (Index e = 0; set.mixed && e < set.count; ++e)
        for (int i = 0; i < 4; ++i) visit(set.pressures[e / lanes][i][e % lanes], set.first_miss + 4 * e + i);
    });
  };
  pull_starts_.assign(static_cast<std::size_t>(vertices_) + 1, 0);
  each_pull([&](Index vertex, Index) { ++pull_starts_[vertex + 1]; });
  std::partial_sum(pull_starts_.begin(), pull_starts_.end(), pull_starts_.begin());
  pull_order_.resize(static_cast<std::size_t>(pulls_ + misses_));
  std::vector<Index> next(pull_starts_.begin(), pull_starts_.end() - 1);
  each_pull([&](Index vertex, Index pull) { pull_order_[next[vertex]++] = pull; });
}

/// The permittivities of a set under voltage, whose elements are there.
void Body::add_field(const Model& model, Set<6, 6>& set) {
  const std::vector<double> permittivity = layer_permittivity(model, set.actuator);
  const auto tetrahedra = static_cast<Index>(model.tetrahedra.size());
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
  for (const auto& set : prisms_)
    if (set.actuator >= 0) {
      scratch.layers.push_back(set.blocks);
      scratch.layer_ratios.push_back(0);
    }
  return scratch;
}

bool Body::prestretched() const {
  return std::any_of(prisms_.begin(), prisms_.end(),
                     [](const auto& set) { return set.charged && set.prestretch != 1; });
}

/// F_a = diag(sqrt(ratio), sqrt(ratio), 1 / ratio) in the layer's frame: slopes become F_a^-T times those at rest.
void Body::stretch_layers(const Demand& demand, Scratch& scratch) const {
  std::size_t layer = 0;
  for (const auto& set : prisms_) {
    if (set.actuator < 0) continue;
    const std::size_t index = layer++;
    const double ratio = set.charged ? 1 + demand.share * (set.prestretch - 1) : demand.actuation[set.actuator];
    if (scratch.layer_ratios[index] == ratio) continue;
    scratch.layer_ratios[index] = ratio;
    const Vec3 inverse(1 / std::sqrt(ratio), 1 / std::sqrt(ratio), ratio);
    for (std::size_t b = 0; b < set.blocks.size(); ++b)
      for (int l = 0; l < lanes; ++l) {
        const Index e = std::min<Index>(set.count - 1, static_cast<Index>(b) * lanes + l);
        const Mat3& frame = set.frames[e / lanes][e % lanes];
        const Mat3 shrink = frame * inverse.asDiagonal() * frame.transpose();
        for (int q = 0; q < 6; ++q)
          for (int i = 0; i < 6; ++i)
            set_lane(scratch.layers[index][b].slope[q][i], l, shrink * lane_of(set.blocks[b].slope[q][i], l));
      }
  }
}

template <int K, int Q>
void Body::store(const Set<K, Q>& set, Index block, const Shape<K>& pull, Scratch& scratch) const {
  const Index count = std::min<Index>(lanes, set.count - lanes * block);
  double* out = scratch.pulls.data() + 3 * static_cast<std::ptrdiff_t>(set.first_pull + K * lanes * block);
  for (Index l = 0; l < count; ++l)
    for (int i = 0; i < K; ++i, out += 3) {
      out[0] = pull[i].x[l];
      out[1] = pull[i].y[l];
      out[2] = pull[i].z[l];
    }
}

/// Adds what the elements pull with at every vertex.
void Body::add_pulls(const Scratch& scratch, Points& sums, Team& team) const {
  team.pieces(vertices_, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) {
      double total[3] = {};
      for (Index i = pull_starts_[v]; i < pull_starts_[v + 1]; ++i) {
        const double* pull = scratch.pulls.data() + 3 * static_cast<std::ptrdiff_t>(pull_order_[i]);
        for (int c = 0; c < 3; ++c) total[c] += pull[c];
      }
      for (int c = 0; c < 3; ++c) sums(v, c) += total[c];
    }
  });
}

/// What every element pulls with, into the scratch.
Body::Result Body::pull(const Demand& demand, const Points& positions, Scratch& scratch, Team& team) const {
  stretch_layers(demand, scratch);
  std::size_t first = 0;
  Result result;
  each(scratch, [&]<int K, int Q>(const Set<K, Q>& set, const std::vector<ElasticBlock<K, Q>>& blocks) {
    const bool pulls = set.branches > 0 && scratch.pulls_viscously();
    team.pieces(static_cast<Index>(blocks.size()), [&](Index begin, Index end) {
      Shape<K> shape;
      ElasticForce<K> out;
      for (Index b = begin; b < end; ++b) {
        load<K>(positions, set.nodes[b], shape);
        elastic_force<K, Q>(blocks[b], shape, out);
        if constexpr (K != 6)
          if (set.mixed) {
            PressureMiss miss;
            add_pressure_force<K, Q>(blocks[b], pressure_of(set, b, positions), shape, out, miss);
            store_miss(set, b, miss, scratch);
          }
        if (pulls) {
          add_viscous_force<K, Q>(blocks[b], branches_of(set, b, scratch), shape, out);
          out.forbidden |= out.inverted;
        }
        if constexpr (K == 6)  // the field is that in the layer itself, whatever its active stretch
          if (set.charged)
            add_dielectric_force(set.blocks[b], set.permittivity[b], demand.actuation[set.actuator], shape, out);
        scratch.energies[first + b] = out.energy;
        scratch.inverted[first + b] = out.inverted;
        scratch.forbidden[first + b] = out.forbidden;
        store(set, b, out.gradient, scratch);
      }
    });
    first += blocks.size();
  });
  Pack energy{};
  PackMask inverted{}, forbidden{};
  for (std::size_t b = 0; b < blocks_; ++b) {
    energy += scratch.energies[b];
    inverted |= scratch.inverted[b];
    forbidden |= scratch.forbidden[b];
  }
  result.energy = sum(energy);
  result.inverted = any(inverted);
  result.forbidden = any(forbidden);
  return result;
}

Body::Result Body::force(const Demand& demand, const Points& positions, Scratch& scratch, Points& gradient,
                         Team& team) const {
  const Result result = pull(demand, positions, scratch, team);
  gradient.setZero(vertices_, 3);
  add_pulls(scratch, gradient, team);
  return result;
}

void Body::evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  const Result result = pull(demand, at.positions, own, team);
  sum.energy += result.energy;
  sum.inverted = sum.inverted || result.inverted;
  sum.forbidden = sum.forbidden || result.forbidden;
  add_pulls(own, sum.gradient, team);
}

void Body::add_change(const Demand& from, const Demand& to, const Points& positions, Term::Scratch& scratch,
                      Points& force, Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  Points before, after;
  for (const Index a : voltages_) {
    const double change = to.actuation[a] - from.actuation[a];
    if (change == 0) continue;
    field_force(a, 1, positions, own, after, team);  // at 1 kV
    force += change * (to.actuation[a] + from.actuation[a]) * after;
  }
  const bool stretched =
      std::any_of(ratios_.begin(), ratios_.end(), [&](Index a) { return from.actuation[a] != to.actuation[a]; }) ||
      (from.share != to.share && prestretched());
  if (!stretched) return;
  constexpr double reach = 1e-4;  // of a central difference, over the change
  Demand low = from, high = from;
  low.actuation -= reach * (to.actuation - from.actuation);
  high.actuation += reach * (to.actuation - from.actuation);
  for (const Index a : voltages_) low.actuation[a] = high.actuation[a] = from.actuation[a];  // the field was counted
  low.share -= reach * (to.share - from.share);
  high.share += reach * (to.share - from.share);
  (void)this->force(low, positions, own, before, team);
  (void)this->force(high, positions, own, after, team);
  force += (after - before) / (2 * reach);
}

void Body::add_derivative(Index command, const Demand& demand, const Points& positions, Term::Scratch& scratch,
                          Points& force, Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  Points there;
  if (loads(command)) {
    field_force(command, 1, positions, own, there, team);  // it goes with the square of the voltage
    force += 2 * demand.actuation[command] * there;
  }
  if (std::find(ratios_.begin(), ratios_.end(), command) == ratios_.end()) return;
  // central difference of fourth order; the force is smooth in the ratio
  const double reach = 1e-3 * demand.actuation[command];
  const auto at_ratio = [&](double change) {
    Demand changed = demand;
    changed.actuation[command] += change;
    (void)this->force(changed, positions, own, there, team);
    return there;
  };
  force += (8 * (at_ratio(reach) - at_ratio(-reach)) - (at_ratio(2 * reach) - at_ratio(-2 * reach))) / (12 * reach);
}

void Body::field_force(Index actuator, double voltage_kV, const Points& positions, Scratch& scratch, Points& gradient,
                       Team& team) const {
  gradient.setZero(vertices_, 3);
  std::fill(scratch.pulls.begin(), scratch.pulls.end(), 0.0);
  for (const auto& set : prisms_)
    if (set.charged && set.actuator == actuator)
      team.pieces(static_cast<Index>(set.blocks.size()), [&](Index begin, Index end) {
        Shape<6> shape;
        for (Index b = begin; b < end; ++b) {
          ElasticForce<6> out{};
          load<6>(positions, set.nodes[b], shape);
          add_dielectric_force(set.blocks[b], set.permittivity[b], voltage_kV, shape, out);
          store(set, b, out.gradient, scratch);
        }
      });
  add_pulls(scratch, gradient, team);
}

double Body::largest_pull(const Scratch& scratch, Team& team) const {
  std::vector<double> sums(static_cast<std::size_t>(vertices_));
  team.pieces(vertices_, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      for (Index i = pull_starts_[v]; i < pull_starts_[v + 1]; ++i)
        sums[v] +=
            Eigen::Map<const Vec3>(scratch.pulls.data() + 3 * static_cast<std::ptrdiff_t>(pull_order_[i])).norm();
  });
  return *std::max_element(sums.begin(), sums.end());
}

void Body::stress(const Demand& demand, const Points& positions, Scratch& scratch, ElementStress& out,
                  Team& team) const {
  stretch_layers(demand, scratch);
  std::size_t count = 0;
  each(scratch, [&](const auto& set, const auto&) { count += set.elements.size(); });
  out.von_mises.resize(count);
  out.principal.resize(count);
  each(scratch, [&]<int K, int Q>(const Set<K, Q>& set, const std::vector<ElasticBlock<K, Q>>& blocks) {
    team.pieces(static_cast<Index>(blocks.size()), [&](Index begin, Index end) {
      Shape<K> shape;
      Pack33 points[Q];
      for (Index b = begin; b < end; ++b) {
        load<K>(positions, set.nodes[b], shape);
        elastic_stress<K, Q>(blocks[b], shape, points);
        if constexpr (K != 6)
          if (set.mixed) add_pressure_stress<K, Q>(blocks[b], pressure_of(set, b, positions), points);
        if (set.branches > 0 && scratch.pulls_viscously())
          add_viscous_stress<K, Q>(blocks[b], branches_of(set, b, scratch), shape, points);
        if constexpr (K == 6)
          if (set.charged)
            add_maxwell_stress(set.blocks[b], set.permittivity[b], demand.actuation[set.actuator], shape, points);
        for (Index l = 0; l < std::min<Index>(lanes, set.count - lanes * b); ++l) {
          Mat3 most = lane_of(points[0], l);
          for (int q = 1; q < Q; ++q)
            if (const Mat3 here = lane_of(points[q], l); von_mises(here) > von_mises(most)) most = here;
          const Index e = set.elements[lanes * b + l];
          out.von_mises[e] = von_mises(most);
          const Vec3 values = principal_values(0.5 * (most + most.transpose()));
          out.principal[e] = {values[2], values[1], values[0]};
        }
      }
    });
  });
}

void Body::add_cliques(linear::Cliques& cliques) {
  each_set([&]<int K, int Q>(Set<K, Q>& set) {
    set.first_slot = cliques.slots.back();
    std::array<Index, K + 4> nodes;
    for (Index e = 0; e < set.count; ++e) {
      for (int i = 0; i < K; ++i) nodes[i] = set.nodes[e / lanes][i][e % lanes];
      for (int i = 0; set.mixed && i < 4; ++i) nodes[K + i] = set.pressures[e / lanes][i][e % lanes];
      cliques.add(std::span(nodes).first(static_cast<std::size_t>(set.mixed ? K + 4 : K)));
    }
  });
}

std::vector<std::int64_t> Body::element_slots() const {
  std::vector<std::int64_t> slots;
  each_set([&]<int K, int Q>(const Set<K, Q>& set) {
    const int matrices = set.matrices();
    for (Index e = 0; e < set.count; ++e) {
      const auto element = static_cast<std::size_t>(set.elements[e]);
      if (slots.size() <= element) slots.resize(element + 1);
      slots[element] = set.first_slot + static_cast<std::int64_t>(matrices) * e;
    }
  });
  return slots;
}

void Body::stiffness(const Demand& demand, const Points& positions, bool projected, Scratch& scratch,
                     LargeVector<double>& slots, Team& team) const {
  stretch_layers(demand, scratch);
  each(scratch, [&]<int K, int Q>(const Set<K, Q>& set, const std::vector<ElasticBlock<K, Q>>& blocks) {
    constexpr int matrices = K * (K + 1) / 2;
    const int others = set.matrices() - matrices;
    team.pieces(static_cast<Index>(blocks.size()), [&](Index begin, Index end) {
      Shape<K> shape;
      ElasticStiffness<K> out;
      for (Index b = begin; b < end; ++b) {
        load<K>(positions, set.nodes[b], shape);
        elastic_stiffness<K, Q>(blocks[b], shape, projected, out);
        if constexpr (K != 6)
          if (set.mixed) {
            PressureCoupling<K> coupling;
            add_pressure_stiffness<K, Q>(blocks[b], pressure_of(set, b, positions), shape, projected, out, coupling);
            store_coupling(set, b, coupling, slots);
          }
        if (set.branches > 0 && scratch.pulls_viscously())
          add_viscous_stiffness<K, Q>(blocks[b], branches_of(set, b, scratch), shape, projected, out);
        if constexpr (K == 6)  // the field's has hardly anything that is positive
          if (set.charged && !projected)
            add_dielectric_stiffness(set.blocks[b], set.permittivity[b], demand.actuation[set.actuator], shape, out);
        const Index count = std::min<Index>(lanes, set.count - lanes * b);
        double* slot = slots.data() + 9 * (set.first_slot + static_cast<std::int64_t>(matrices + others) * lanes * b);
        for (Index l = 0; l < count; ++l, slot += 9 * others)
          for (int m = 0; m < matrices; ++m, slot += 9)
            for (int r = 0; r < 3; ++r) {
              slot[3 * r] = out.block[m].row[r].x[l];
              slot[3 * r + 1] = out.block[m].row[r].y[l];
              slot[3 * r + 2] = out.block[m].row[r].z[l];
            }
      }
    });
  });
}

void Body::turning(const Points& positions, const Points& step, Scratch& scratch, Points& residual, Team& team) const {
  const auto run = [&]<int K, int Q>(const Set<K, Q>& set) {
    team.pieces(static_cast<Index>(set.blocks.size()), [&](Index begin, Index end) {
      Shape<K> current, moves, pull;
      for (Index b = begin; b < end; ++b) {
        load<K>(positions, set.nodes[b], current);
        load<K>(step, set.nodes[b], moves);
        turning_pull<K, Q>(set.blocks[b], current, moves, pull);
        store(set, b, pull, scratch);
      }
    });
  };
  for (const auto& set : linear_) run(set);
  for (const auto& set : quadratic_) run(set);
  for (const auto& set : prisms_) run(set);
  std::fill(scratch.pulls.end() - 3 * static_cast<std::ptrdiff_t>(misses_), scratch.pulls.end(), 0.0);
  residual.setZero(vertices_, 3);
  add_pulls(scratch, residual, team);
}

Eigen::SparseMatrix<double> Body::laplacian() const {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<bool> stretched(static_cast<std::size_t>(vertices_));
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
