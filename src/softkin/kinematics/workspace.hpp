#pragma once

#include <functional>
#include <optional>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// Samples in groups of neighbours. A group begins with its middle, which is solved from rest; all others are predicted
/// from there, with one factorisation for all. Groups are independent of each other, so that they can be distributed to
/// any number of threads and processes.
struct WorkspacePlan {
  Actuations actuations;                   // of all samples, in the order of their numbers
  std::vector<std::vector<Index>> groups;  // sample numbers in the order in which they are solved, each in one group

  /// How many there are.
  [[nodiscard]] Index samples() const { return actuations.rows(); }
};

/// Returns the number of samples in a group: a fiftieth of all samples, from 8 to 64. Larger groups spread the cost of
/// the first solve, from rest; smaller ones keep their samples near each other and occupy all threads.
[[nodiscard]] Index group_size(Index samples);

/// throws  InvalidInput as sample_actuations does
[[nodiscard]] WorkspacePlan plan_workspace(const Model& model, const SamplingOptions& options);

/// A group to be solved, or to be continued.
struct GroupTask {
  Index group = 0;                           // of WorkspacePlan::groups
  std::vector<std::optional<Status>> known;  // per sample of the group: how it ended, where that has been done before
};

/// Solves the samples of a group that are not known, in order, and passes each to `give`. A sample that is not reached
/// from the group's middle is tried once more from rest. Each sample depends on the other arguments alone, not on what
/// is known.
///
/// options  threads and reuse_factor are set here
/// returns  false where progress stopped it
bool solve_group(const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options,
                 const GroupTask& task, const std::function<void(const WorkspaceSample&)>& give,
                 const ProgressCallback& progress = {});

/// Distributes groups and stores their samples. Several threads call it at once.
class GroupDesk {
 public:
  virtual ~GroupDesk() = default;
  /// Returns a group that no thread has taken; nothing where none is left.
  [[nodiscard]] virtual std::optional<GroupTask> take() = 0;
  virtual void keep(const WorkspaceSample& sample) = 0;
};

/// Solves groups of the desk on several threads until none is left or progress, which any of them calls, returns false.
/// Rethrows the first exception of a thread.
void solve_groups(const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options, int threads,
                  GroupDesk& desk, const ProgressCallback& progress = {});

}  // namespace softkin
