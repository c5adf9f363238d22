#pragma once

#include <filesystem>
#include <optional>
#include <softkin/io/table/workspace_table.hpp>
#include <softkin/kinematics/workspace.hpp>

namespace softkin::cli {

/// The samples on disk. While they are solved the file grows, a whole row at a time, in the order in which they come;
/// the rows alone say what has been done. At the end it is put in the order of the samples.
class WorkspaceFile {
 public:
  /// Begins the file, or with resume goes on with what is there: a last line that is torn is cut off.
  ///
  /// throws  InvalidInput where there is an unfinished workspace that is not to be resumed, or one of another robot,
  ///         solver or sampling that is; where another softkin is at work on it; where it cannot be written
  WorkspaceFile(std::filesystem::path path, const WorkspaceHead& head, const WorkspaceColumns& columns,
                const WorkspacePlan& plan, bool resume);
  ~WorkspaceFile();
  WorkspaceFile(const WorkspaceFile&) = delete;
  WorkspaceFile& operator=(const WorkspaceFile&) = delete;

  [[nodiscard]] Index done() const { return done_; }
  [[nodiscard]] bool complete() const { return done_ == static_cast<Index>(rows_.size()); }
  [[nodiscard]] bool was_torn() const { return torn_; }
  /// Samples that ended so.
  [[nodiscard]] Index count(Status status) const;
  [[nodiscard]] const std::optional<Status>& known(Index sample) const {
    return known_[static_cast<std::size_t>(sample)];
  }

  /// Appends the row in one write. It outlives the program at once; once a second rows are made to outlive the machine.
  /// A row that the disk has no room for is taken back, and throws InvalidInput.
  void add(const WorkspaceSample& sample);

  /// Replaces the file by one in the order of the samples. All of them must be done.
  void finish();

 private:
  void read(const WorkspaceHead& head, const WorkspacePlan& plan);
  void open_to_append();
  void note(Index sample, Status status, std::string row);

  std::filesystem::path path_;
  std::string header_;
  const WorkspaceColumns& columns_;
  std::vector<std::string> rows_;  // per sample; empty: not done
  std::vector<std::optional<Status>> known_;
  Index done_ = 0;
  bool torn_ = false;
  int file_ = -1;
  double last_sync_ = 0;  // [s]
};

}  // namespace softkin::cli
