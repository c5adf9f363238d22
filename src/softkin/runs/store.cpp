#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/runs/store.hpp>

namespace softkin::runs {

namespace fs = std::filesystem;

namespace {

constexpr double sync_every = 1;  // [s]
constexpr std::size_t piece = 1 << 15;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Every line of a file from an offset on, without its end, and whether it has one.
void each_line(int file, std::size_t offset, const std::function<bool(std::string_view line, bool whole)>& visit) {
  std::string rest;
  const auto buffer = std::make_unique_for_overwrite<char[]>(piece);
  for (;;) {
    const ssize_t count = ::pread(file, buffer.get(), piece, static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    offset += count;
    std::string_view text(buffer.get(), count);
    for (std::size_t end; (end = text.find('\n')) != std::string_view::npos; text.remove_prefix(end + 1)) {
      rest += text.substr(0, end);
      if (!visit(rest, true)) return;
      rest.clear();
    }
    rest += text;
  }
  if (!rest.empty()) visit(rest, false);
}

}  // namespace

Store::Store(fs::path path, const std::string& head, bool resume) : path_(std::move(path)), head_(head) {
  const bool begin = !resume || path_.empty() || !fs::exists(path_);
  if (!begin) refuse_lfs_pointer(path_);
  open(begin);
  try {
    if (begin || ends_within(head)) {
      cut_off();
      write(head);
    } else {
      measure(std::count(head.begin(), head.end(), '\n'));
    }
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Store::~Store() {
  if (file_ >= 0) ::close(file_);
}

void Store::refuse(const std::string& why) const {
  throw InvalidInput({path_.empty() ? "temporary file" : path_.string()}, why);
}

void Store::open(bool begin) {
  if (path_.empty()) {
    std::string name = (fs::temp_directory_path() / "softkin.XXXXXX").string();
    file_ = ::mkstemp(name.data());
    if (file_ < 0) refuse(std::string("cannot be made: ") + std::strerror(errno));
    ::unlink(name.c_str());
    return;
  }
  file_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | (begin ? O_CREAT : 0), 0666);
  if (file_ < 0) refuse(std::string("cannot be written: ") + std::strerror(errno));
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;  // a disk may know no locks
  ::close(file_);
  refuse("another softkin is at work on it");
}

bool Store::ends_within(const std::string& head) const {
  std::string text(head.size(), '\0');
  const ssize_t count = ::pread(file_, text.data(), text.size(), 0);
  return count >= 0 && static_cast<std::size_t>(count) < head.size() && head.starts_with(text.substr(0, count));
}

void Store::measure(std::size_t head_lines) {
  std::size_t lines = 0;
  std::string head;
  each_line(file_, 0, [&](std::string_view line, bool whole) {
    torn_ = !whole;
    if (!whole) return false;
    bytes_ += line.size() + 1;
    if (lines++ < head_lines) (head += line) += '\n';
    return true;
  });
  head_ = std::move(head);
  size_ = lines - std::min(lines, head_lines);
  tail_ = torn_;
}

void Store::cut_off() {
  if (::ftruncate(file_, static_cast<off_t>(bytes_)) != 0)
    refuse(std::string("cannot be written: ") + std::strerror(errno));
  tail_ = false;
}

void Store::write(std::string_view text) {
  if (tail_) cut_off();
  ssize_t written = -1;
  do {
    written = ::pwrite(file_, text.data(), text.size(), static_cast<off_t>(bytes_));
  } while (written < 0 && errno == EINTR);
  if (written == static_cast<ssize_t>(text.size())) {
    bytes_ += text.size();
    return;
  }
  const std::string why = written < 0 ? std::strerror(errno) : "no room left";
  if (::ftruncate(file_, static_cast<off_t>(bytes_)) != 0) refuse("a row could not be written whole: " + why);
  refuse("cannot be written: " + why);
}

std::size_t Store::size() const {
  const std::lock_guard lock(mutex_);
  return size_;
}

void Store::append(std::string_view record) {
  const std::lock_guard lock(mutex_);
  std::string line(record);
  write(line += '\n');
  ++size_;
  if (const double now = seconds_now(); !path_.empty() && now - last_sync_ > sync_every) {
    (void)::fdatasync(file_);
    last_sync_ = now;
  }
}

void Store::each(const std::function<bool(std::size_t, std::string_view)>& visit) const {
  const std::size_t records = size();
  std::size_t number = 0;
  each_line(file_, head_.size(),
            [&](std::string_view line, bool) { return number < records && visit(number++, line); });
}

void Store::cut(std::size_t records) {
  if (records >= size()) return;
  std::size_t bytes = head_.size();
  each([&](std::size_t number, std::string_view record) {
    if (number < records) bytes += record.size() + 1;
    return number < records;
  });
  const std::lock_guard lock(mutex_);
  bytes_ = bytes;
  size_ = records;
  cut_off();
}

void Store::remove() {
  if (path_.empty()) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
}

}  // namespace softkin::runs
