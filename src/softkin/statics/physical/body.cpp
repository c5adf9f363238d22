#include <algorithm>
#include <cmath>
#include <numeric>
#include <softkin/core/dense.hpp>
#include <softkin/statics/electric_layer.hpp>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/lanes.hpp>
#include <softkin/statics/physical/load_block.hpp>

namespace softkin::physical {

using namespace energy;

namespace {

double von_mises(const Mat3& stress) {
  const Mat3 deviator = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * deviator.norm();
}

}  // namespace

/// Returns the corner pressures of a block in a shape [MPa].
template <int K, int Q>
CornerPressure Body::pressure_of(const Set<K, Q>& set, Index block, const Points& positions) const {
  CornerPressure pressure = set.corners.compliance[block];
  for (std::size_t i = 0; i < 4; ++i)
    for (int l = 0; l < lanes; ++l)
      pressure.at[i][l] = pressure_unit_ * positions(set.corners.pressures[block][i][l], 0);
  return pressure;
}

template <int K, int Q>
void Body::store_miss(const Set<K, Q>& set, Index block, const PressureMiss& miss, Scratch& scratch) const {
  const Index count = std::min<Index>(lanes, set.count - lanes * block);
  double* out = scratch.pulls.data() + 3 * static_cast<std::ptrdiff_t>(set.corners.first_miss + 4 * lanes * block);
  for (Index l = 0; l < count; ++l)
    for (const Pack& at : miss.at) {
      out[0] = pressure_unit_ * at[l];
      out[1] = out[2] = 0;
      out += 3;
    }
}

/// Stores the coupling behind the slots of the nodes among themselves.
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

bool Body::prestretched() const {
  return std::any_of(prisms_.begin(), prisms_.end(),
                     [](const auto& set) { return set.charged && set.prestretch != 1; });
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

/// Adds the elements' forces at every vertex.
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

/// Computes the forces of every element, into the scratch.
Body::Result Body::pull(const LoadState& load_state, const Points& positions, Scratch& scratch, Team& team) const {
  change_elements(load_state, scratch, team);
  std::size_t first = 0;
  Result result;
  each(scratch, [&]<int K, int Q>(const Set<K, Q>& set, const std::vector<ElasticBlock<K, Q>>& blocks) {
    const bool pulls = set.viscous.branches > 0 && scratch.pulls_viscously();
    team.pieces(blocks.size(), [&](Index begin, Index end) {
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
            add_dielectric_force(set.blocks[b], set.permittivity[b], load_state.actuation[set.actuator], shape, out);
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

Body::Result Body::force(const LoadState& load_state, const Points& positions, Scratch& scratch, Points& gradient,
                         Team& team) const {
  const Result result = pull(load_state, positions, scratch, team);
  gradient.setZero(vertices_, 3);
  add_pulls(scratch, gradient, team);
  return result;
}

void Body::evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                    Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  const Result result = pull(load_state, at.positions, own, team);
  sum.energy += result.energy;
  sum.inverted = sum.inverted || result.inverted;
  sum.forbidden = sum.forbidden || result.forbidden;
  add_pulls(own, sum.gradient, team);
}

void Body::add_change(const LoadState& from, const LoadState& to, const Points& positions, Term::Scratch& scratch,
                      Points& force, Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  Points before, after;
  for (const Index a : voltages_) {
    const double change = to.actuation[a] - from.actuation[a];
    if (change == 0) continue;
    field_force(a, 1, positions, own, after, team);  // at 1 kV
    force += change * (to.actuation[a] + from.actuation[a]) * after;
  }
  const auto changes = [&](Index a) { return from.actuation[a] != to.actuation[a]; };
  const bool stretched = std::any_of(ratios_.begin(), ratios_.end(), changes) ||
                         std::any_of(growths_.begin(), growths_.end(), changes) ||
                         (from.load_factor != to.load_factor && prestretched());
  if (!stretched) return;
  constexpr double reach = 1e-4;  // of a central difference, over the change
  LoadState low = from, high = from;
  low.actuation -= reach * (to.actuation - from.actuation);
  high.actuation += reach * (to.actuation - from.actuation);
  for (const Index a : voltages_) low.actuation[a] = high.actuation[a] = from.actuation[a];  // added above
  low.load_factor -= reach * (to.load_factor - from.load_factor);
  high.load_factor += reach * (to.load_factor - from.load_factor);
  (void)this->force(low, positions, own, before, team);
  (void)this->force(high, positions, own, after, team);
  force += (after - before) / (2 * reach);
}

void Body::add_derivative(Index command, const LoadState& load_state, const Points& positions, Term::Scratch& scratch,
                          Points& force, Team& team) const {
  auto& own = static_cast<Scratch&>(scratch);
  Points there;
  if (charges(command)) {
    field_force(command, 1, positions, own, there, team);  // it goes with the square of the voltage
    force += 2 * load_state.actuation[command] * there;
  }
  const bool grows = std::find(growths_.begin(), growths_.end(), command) != growths_.end();
  if (!grows && std::find(ratios_.begin(), ratios_.end(), command) == ratios_.end()) return;
  // central difference of fourth order; the force is smooth in the stretches, which are extrapolated by their slopes
  const double reach = grows ? 1e-3 / fastest_growth(command, load_state) : 1e-3 * load_state.actuation[command];
  if (!std::isfinite(reach)) return;  // at this temperature nothing grows
  const auto nudged_by = [&](double nudge) {
    own.nudged = command;
    own.nudge = nudge;
    (void)this->force(load_state, positions, own, there, team);
    own.nudged = -1;
    return there;
  };
  force += (8 * (nudged_by(reach) - nudged_by(-reach)) - (nudged_by(2 * reach) - nudged_by(-2 * reach))) / (12 * reach);
}

/// Returns the largest derivative of a stretch by a command, over the stretch [1 per unit].
double Body::fastest_growth(Index command, const LoadState& load_state) const {
  double fastest = 0;
  each_set([&](const auto& set) {
    if (!set.growth || set.growth->actuator != command) return;
    const double at = load_state.actuation[command];
    fastest = std::max(fastest, std::abs(set.growth->slope(at)) / set.growth->stretch(at));
  });
  return fastest;
}

void Body::field_force(Index actuator, double voltage_kV, const Points& positions, Scratch& scratch, Points& gradient,
                       Team& team) const {
  gradient.setZero(vertices_, 3);
  std::fill(scratch.pulls.begin(), scratch.pulls.end(), 0.0);
  for (const auto& set : prisms_)
    if (set.charged && set.actuator == actuator)
      team.pieces(set.blocks.size(), [&](Index begin, Index end) {
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
  std::vector<double> sums(vertices_);
  team.pieces(vertices_, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v)
      for (Index i = pull_starts_[v]; i < pull_starts_[v + 1]; ++i)
        sums[v] +=
            Eigen::Map<const Vec3>(scratch.pulls.data() + 3 * static_cast<std::ptrdiff_t>(pull_order_[i])).norm();
  });
  return *std::max_element(sums.begin(), sums.end());
}

void Body::stress(const LoadState& load_state, const Points& positions, Scratch& scratch, ElementStress& out,
                  Team& team) const {
  change_elements(load_state, scratch, team);
  std::size_t count = 0;
  each(scratch, [&](const auto& set, const auto&) { count += set.elements.size(); });
  out.von_mises.resize(count);
  out.principal.resize(count);
  each(scratch, [&]<int K, int Q>(const Set<K, Q>& set, const std::vector<ElasticBlock<K, Q>>& blocks) {
    team.pieces(blocks.size(), [&](Index begin, Index end) {
      Shape<K> shape;
      Pack33 points[Q];
      for (Index b = begin; b < end; ++b) {
        load<K>(positions, set.nodes[b], shape);
        elastic_stress<K, Q>(blocks[b], shape, points);
        if constexpr (K != 6)
          if (set.mixed) add_pressure_stress<K, Q>(blocks[b], pressure_of(set, b, positions), points);
        if (set.viscous.branches > 0 && scratch.pulls_viscously())
          add_viscous_stress<K, Q>(blocks[b], branches_of(set, b, scratch), shape, points);
        if constexpr (K == 6)
          if (set.charged)
            add_maxwell_stress(set.blocks[b], set.permittivity[b], load_state.actuation[set.actuator], shape, points);
        for (Index l = 0; l < std::min<Index>(lanes, set.count - lanes * b); ++l) {
          const Index e = set.elements[lanes * b + l];
          const auto at_point = [&](int q) {
            const Mat3 own = lane_of(points[q], l);
            return families_ ? Mat3(own + families_->stress(e, q, positions)) : own;
          };
          Mat3 most = at_point(0);
          for (int q = 1; q < Q; ++q)
            if (const Mat3 here = at_point(q); von_mises(here) > von_mises(most)) most = here;
          out.von_mises[e] = von_mises(most);
          const Vec3 values = principal_values(0.5 * (most + most.transpose()));
          out.principal[e] = {values[2], values[1], values[0]};
        }
      }
    });
  });
}

void Body::stiffness(const LoadState& load_state, const Points& positions, bool projected, Scratch& scratch,
                     LargeVector<double>& slots, Team& team) const {
  change_elements(load_state, scratch, team);
  each(scratch, [&]<int K, int Q>(const Set<K, Q>& set, const std::vector<ElasticBlock<K, Q>>& blocks) {
    constexpr int matrices = K * (K + 1) / 2;
    const int others = set.matrices() - matrices;
    team.pieces(blocks.size(), [&](Index begin, Index end) {
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
        if (set.viscous.branches > 0 && scratch.pulls_viscously())
          add_viscous_stiffness<K, Q>(blocks[b], branches_of(set, b, scratch), shape, projected, out);
        if constexpr (K == 6)  // the field's stiffness has hardly any positive part
          if (set.charged && !projected)
            add_dielectric_stiffness(set.blocks[b], set.permittivity[b], load_state.actuation[set.actuator], shape,
                                     out);
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
    team.pieces(set.blocks.size(), [&](Index begin, Index end) {
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

}  // namespace softkin::physical
