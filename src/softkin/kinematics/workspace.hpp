#pragma once

#include <optional>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/model/workspace_sample.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// Which samples are solved, and which from which: a chain begins at rest, and each further sample of it from the last
/// one that converged. Chains know nothing of each other, so that any number of threads and processes can share them.
struct WorkspacePlan {
  Actuations actuations;
  std::vector<std::vector<Index>> chains;  // sample numbers, each sample in one chain

  [[nodiscard]] Index samples() const { return static_cast<Index>(actuations.rows()); }
};

/// Samples of a chain: long enough that its first solve, from rest, costs little in the mean, and short enough that
/// there are chains for everyone.
constexpr Index chain_length = 32;

/// throws  InvalidInput as sample_actuations does
[[nodiscard]] WorkspacePlan plan_workspace(const Model& model, const SamplingOptions& options);

/// Where a chain stands: all that its next sample depends on.
struct ChainState {
  Index chain = 0;
  Index next = 0;  // place in the chain of the sample to be solved next
  State last;      // equilibrium to start from
};

/// The beginning of a chain.
[[nodiscard]] ChainState begin_chain(const Statics& statics, Index chain);

/// Solves the next sample of a chain and moves the chain on. A sample that is not reached from its neighbour is tried
/// once more from rest.
///
/// options  threads and reuse_factor are set here: the result is a function of the other arguments alone
/// returns  nothing where progress stopped it; the chain stands where it stood
[[nodiscard]] std::optional<WorkspaceSample> solve_next(const Model& model, const Statics& statics,
                                                        const WorkspacePlan& plan, const StaticsOptions& options,
                                                        ChainState& state, const ProgressCallback& progress = {});

/// Hands out chains and keeps what is made of them. Asked by several threads at once.
class ChainDesk {
 public:
  virtual ~ChainDesk() = default;
  /// A chain that nobody has, where it stands; nothing where none is left.
  [[nodiscard]] virtual std::optional<ChainState> take() = 0;
  /// state: of the chain after the sample.
  virtual void keep(const ChainState& state, const WorkspaceSample& sample) = 0;
};

/// Solves chains of the desk on so many threads until none is left or progress, which is called on any of them,
/// returns false. Rethrows the first exception of a thread.
void solve_chains(const Model& model, const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options,
                  int threads, ChainDesk& desk, const ProgressCallback& progress = {});

}  // namespace softkin
