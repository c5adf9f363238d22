#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <softkin/kinematics/workspace.hpp>
#include <softkin/runs/workspace_file.hpp>
#include <string>

namespace softkin::runs {

/// The processes of mpirun that work on one workspace, or this process alone. Rank 0 distributes groups of samples,
/// keeps the results, and alone reads and writes the files of the workspace.
class Ranks {
 public:
  /// throws  InvalidInput where mpirun has started several copies of a softkin that was built without MPI
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool leads() const { return rank_ == 0; }

  /// All ranks do this part; where it fails on one it fails on all: rank 0 throws InvalidInput or what it has thrown
  /// itself, and the others Silence.
  void together(const std::function<void()>& part) const;

  /// Throws, as a part of together(), where this rank's text is not that of rank 0: it has other files.
  void agree_on(const std::string& text) const;

  /// Solves all groups of the desk, which is that of rank 0, with all ranks. work: solves groups of the desk that it is
  /// given until there are none.
  void distribute(const Model& model, const WorkspacePlan& plan, GroupDesk* desk,
                  const std::function<void(GroupDesk&)>& work) const;

 private:
  int rank_ = 0, size_ = 1;
};

/// The failure of another rank, which reports it.
struct Silence {};

/// Groups that have something left, and the file that keeps what is made of them.
class FileDesk : public GroupDesk {
 public:
  /// All must outlive it. go_on: false ends it before the next group; kept: after every sample, by one thread at a time
  FileDesk(const WorkspacePlan& plan, WorkspaceFile& file, std::function<bool()> go_on, std::function<void()> kept);

  [[nodiscard]] std::optional<GroupTask> take() override;
  void keep(const WorkspaceSample& sample) override;

 private:
  const WorkspacePlan& plan_;
  WorkspaceFile& file_;
  std::function<bool()> go_on_;
  std::function<void()> kept_;
  std::mutex mutex_;
  std::size_t next_ = 0;  // group
};

}  // namespace softkin::runs
