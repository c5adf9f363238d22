#include "workspace_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>

#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

constexpr double sync_every = 1;  // [s]

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
  throw InvalidInput({path.string()}, why);
}

/// Refuses to replace a workspace that has not all its samples: hours may be in it.
void check_replaceable(const fs::path& path) {
  if (!fs::exists(path)) return;
  const std::string text = read_file(path);
  if (!text.starts_with("# softkin workspace: ")) return;
  constexpr std::string_view key = "\n# samples: ";
  const std::size_t at = text.find(key);
  std::int64_t samples = 0;
  if (at == std::string::npos ||
      !parse_integer(std::string_view(text).substr(at + key.size(), text.find('\n', at + 1) - at - key.size()),
                     samples))
    return;
  std::int64_t rows = -1;  // the columns' line is none
  for (std::size_t line = 0; line < text.size(); line = text.find('\n', line) + 1) {
    if (text.find('\n', line) == std::string::npos) break;
    rows += text[line] != '#';
  }
  if (rows >= samples) return;
  refuse(path, "is an unfinished workspace, " + std::to_string(rows) + " of " + std::to_string(samples) +
                   " samples: add --resume to go on with it, or remove it");
}

}  // namespace

WorkspaceFile::WorkspaceFile(fs::path path, const WorkspaceHead& head, const WorkspaceColumns& columns,
                             const WorkspacePlan& plan, bool resume)
    : path_(std::move(path)),
      header_(workspace_header(head, columns)),
      columns_(columns),
      rows_(static_cast<std::size_t>(plan.samples())),
      known_(rows_.size()) {
  const bool goes_on = resume && fs::exists(path_);
  if (!goes_on) {
    check_replaceable(path_);
    write_file(path_, header_);
  }
  open_to_append();
  try {
    read(head, plan);
  } catch (...) {
    ::close(file_);
    throw;
  }
}

WorkspaceFile::~WorkspaceFile() {
  ::close(file_);
}

void WorkspaceFile::open_to_append() {
  file_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (file_ < 0) refuse(path_, std::string("cannot be written: ") + std::strerror(errno));
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;  // a disk may know no locks
  ::close(file_);
  refuse(path_, "another softkin is at work on it");
}

void WorkspaceFile::read(const WorkspaceHead& head, const WorkspacePlan& plan) {
  const WorkspaceTable table = read_workspace(path_, columns_);
  const auto cannot = [&](const std::string& why) {
    refuse(path_, "--resume cannot go on with this workspace: " + why);
  };
  for (std::size_t i = 0; i < head.size(); ++i) {
    const auto& [key, value] = head[i];
    const std::string found = i < table.head.size() && table.head[i].first == key ? table.head[i].second : "";
    if (found == value) continue;
    if (key == "robot") cannot("it is of another robot, or the scene or its mesh has changed");
    cannot("its " + key + " is '" + found + "', not '" + value + "'");
  }
  for (std::size_t i = 0; i < table.samples.size(); ++i) {
    const WorkspaceSample& sample = table.samples[i];
    if (sample.number >= plan.samples() || plan.actuations.row(sample.number).transpose() != sample.actuation)
      cannot("sample " + std::to_string(sample.number) + " is of another actuation");
    note(sample.number, sample.status, table.rows[i]);
  }
  torn_ = table.torn;
  if (torn_ && ::ftruncate(file_, static_cast<off_t>(table.whole_bytes)) != 0)
    refuse(path_, std::string("cannot be written: ") + std::strerror(errno));
}

void WorkspaceFile::note(Index sample, Status status, std::string row) {
  rows_[static_cast<std::size_t>(sample)] = std::move(row);
  known_[static_cast<std::size_t>(sample)] = status;
  ++done_;
}

Index WorkspaceFile::count(Status status) const {
  return static_cast<Index>(
      std::count_if(known_.begin(), known_.end(), [&](const auto& known) { return known && *known == status; }));
}

void WorkspaceFile::add(const WorkspaceSample& sample) {
  if (known(sample.number)) return;
  std::string row = workspace_row(sample, columns_);
  const off_t before = ::lseek(file_, 0, SEEK_END);
  ssize_t written = -1;
  do {
    written = ::write(file_, row.data(), row.size());
  } while (written < 0 && errno == EINTR);
  if (written != static_cast<ssize_t>(row.size())) {
    const std::string why = written < 0 ? std::strerror(errno) : "no room left";
    if (before >= 0 && ::ftruncate(file_, before) != 0) refuse(path_, "a row could not be written whole: " + why);
    refuse(path_, "cannot be written: " + why);
  }
  note(sample.number, sample.status, std::move(row));
  if (const double now = seconds_now(); now - last_sync_ > sync_every) {
    (void)::fdatasync(file_);
    last_sync_ = now;
  }
}

void WorkspaceFile::finish() {
  std::string text = header_;
  for (const std::string& row : rows_) text += row;
  write_file(path_, text);
}

}  // namespace softkin::cli
