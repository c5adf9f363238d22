#pragma once

#include <functional>
#include <optional>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// Samples in groups of neighbours. A group begins with its middle, which is solved from rest; all others are predicted
/// from there, with one factorisation for all. Groups know nothing of each other, so that any number of threads and
/// processes can share them.
struct WorkspacePlan {
  Actuations actuations;                   // of all samples, in the order of their numbers
  std::vector<std::vector<Index>> groups;  // sample numbers in the order in which they are solved, each in one group

  /// How many there are.
  [[nodiscard]] Index samples() const { return actuations.rows(); }
};

/// Samples of a group, of so many samples in all: 8 to 64, a fiftieth. The first solve, from rest, is to cost little in
/// the mean, but the others are to be near, and there are to be groups for everyone.
[[nodiscard]] Index group_size(Index samples);

/// throws  InvalidInput as sample_actuations does
[[nodiscard]] WorkspacePlan plan_workspace(const Model& model, const SamplingOptions& options);

/// A group to be solved, or to be gone on with.
struct GroupTask {
  Index group = 0;                           // of WorkspacePlan::groups
  std::vector<std::optional<Status>> known;  // per sample of the group: how it ended, where that has been done before
};

/// Solves the samples of a group that are not known, in order, and gives each away. A sample that is not reached from
/// the group's middle is tried once more from rest. Each is a function of the other arguments alone, whatever is known.
///
/// options  threads and reuse_factor are set here
/// returns  false where progress stopped it
bool solve_group(const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options,
                 const GroupTask& task, const std::function<void(const WorkspaceSample&)>& give,
                 const ProgressCallback& progress = {});

/// Hands out groups and keeps what is made of them. Asked by several threads at once.
class GroupDesk {
 public:
  virtual ~GroupDesk() = default;
  /// A group that nobody has; nothing where none is left.
  [[nodiscard]] virtual std::optional<GroupTask> take() = 0;
  virtual void keep(const WorkspaceSample& sample) = 0;
};

/// Solves groups of the desk on so many threads until none is left or progress, which is called on any of them,
/// returns false. Rethrows the first exception of a thread.
void solve_groups(const Statics& statics, const WorkspacePlan& plan, const StaticsOptions& options, int threads,
                  GroupDesk& desk, const ProgressCallback& progress = {});

}  // namespace softkin
