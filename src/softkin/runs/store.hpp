#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace softkin::runs {

/// Records on disk while a run makes them: lines of a file that only grows, locked against a second softkin. A record
/// is written whole in one write and outlives the program at once; once a second they are made to outlive the machine.
/// A last line that a kill tore counts for nothing. Adding a record costs the same however many there are.
class Store {
 public:
  /// Begins the file with head, whole lines; or, where resume is set and the file exists, continues it.
  ///
  /// path    empty: a temporary file without a name
  /// throws  InvalidInput where it cannot be written or another softkin is at work on it
  Store(std::filesystem::path path, const std::string& head, bool resume);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// The lines of the head as they are on disk; of a resumed file as many as head has, or all there are.
  [[nodiscard]] const std::string& head() const { return head_; }
  [[nodiscard]] std::size_t size() const;                // records
  [[nodiscard]] bool was_torn() const { return torn_; }  // found so; what is added replaces the torn line

  /// Adds a record, a line without its end. throws InvalidInput where the disk has no room; the file is as before
  void append(std::string_view record);

  /// The records in their order; false ends it early.
  void each(const std::function<bool(std::size_t number, std::string_view record)>& visit) const;

  /// Keeps the first so many records.
  void cut(std::size_t records);

  /// Removes the file.
  void remove();

 private:
  void open(bool begin);
  /// Was it killed before it had written the head?
  [[nodiscard]] bool ends_within(const std::string& head) const;
  void measure(std::size_t head_lines);
  void cut_off();
  [[noreturn]] void refuse(const std::string& why) const;
  void write(std::string_view text);

  mutable std::mutex mutex_;
  std::filesystem::path path_;
  std::string head_;
  int file_ = -1;
  std::size_t size_ = 0, bytes_ = 0;
  bool torn_ = false, tail_ = false;  // tail_: the torn line is still there
  double last_sync_ = 0;              // [s]
};

}  // namespace softkin::runs
