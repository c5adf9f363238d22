#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/load_block.hpp>

/// The history of the Maxwell branches of a body, and its change with time.

namespace softkin::physical {

using namespace energy;

namespace {

/// Sets the coefficients lane by lane; a lane with the relaxation time of the lane before copies its values.
void set_fractions(const Pack& time, double elapsed_s, BranchFractions& fractions, Pack& rate) {
  for (int l = 0; l < lanes; ++l) {
    if (l > 0 && time[l] == time[l - 1]) {
      for (Pack* each : {&fractions.remembered, &fractions.begun, &fractions.ended, &rate}) (*each)[l] = (*each)[l - 1];
      continue;
    }
    const double x = elapsed_s / time[l], kept = std::exp(-x), mean = x > 0 ? -std::expm1(-x) / x : 1;
    fractions.remembered[l] = kept;
    fractions.begun[l] = std::max(0.0, mean - kept);
    fractions.ended[l] = 1 - mean;
    rate[l] = std::min(x, 1e12);  // finite
  }
}

}  // namespace

void Body::set_time(std::shared_ptr<const ViscousHistory> history, double elapsed_s, Scratch& scratch,
                    Team& team) const {
  if (!viscous()) return;
  const bool same_step = scratch.elapsed_s == elapsed_s && !scratch.fractions.empty();
  if (same_step && scratch.history == history) return;
  scratch.history = std::move(history);
  scratch.elapsed_s = elapsed_s;
  scratch.fractions.resize(branches_);
  scratch.rates.resize(branches_);
  scratch.begun.resize(begun_);
  each_set([&]<int K, int Q>(const Set<K, Q>& set) {
    if (set.viscous.branches == 0) return;
    team.pieces(set.blocks.size(), [&](Index begin, Index end) {
      for (Index b = begin; b < end; ++b) {
        const auto block = static_cast<std::size_t>(b), first = block * static_cast<std::size_t>(set.viscous.branches);
        for (std::size_t i = first; !same_step && i < first + static_cast<std::size_t>(set.viscous.branches); ++i)
          set_fractions(set.viscous.times[i], elapsed_s, scratch.fractions[set.viscous.first_branch + i],
                        scratch.rates[set.viscous.first_branch + i]);
        begin_step<Q>(branches_of(set, block, scratch),
                      scratch.begun.data() + set.viscous.first_begun + set.begun_each() * block);
      }
    });
  });
}

std::shared_ptr<const ViscousHistory> Body::flow(const LoadState& load_state, const Points& positions, Scratch& scratch,
                                                 double& lost_mJ, Team& team) const {
  auto after = std::make_shared<ViscousHistory>();
  after->strains.resize(strains_);
  change_elements(load_state, scratch, team);
  Pack lost{};
  std::vector<Pack> of_blocks;
  each(scratch, [&]<int K, int Q>(const Set<K, Q>& set, const std::vector<ElasticBlock<K, Q>>& blocks) {
    if (set.viscous.branches == 0) return;
    of_blocks.resize(blocks.size());
    team.pieces(blocks.size(), [&](Index begin, Index end) {
      Shape<K> shape;
      for (Index b = begin; b < end; ++b) {
        load<K>(positions, set.nodes[b], shape);
        const std::size_t block = b;
        double* strains = after->strains.data() + set.viscous.first_strain + set.strains_each() * block;
        const Pack* rates =
            scratch.rates.data() + set.viscous.first_branch + block * static_cast<std::size_t>(set.viscous.branches);
        of_blocks[b] = energy::flow<K, Q>(blocks[b], branches_of(set, block, scratch), rates, shape, strains);
      }
    });
    for (const Pack& part : of_blocks) lost += part;
  });
  lost_mJ = sum(lost);
  return after;
}

}  // namespace softkin::physical
