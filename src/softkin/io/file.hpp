#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace softkin {

/// The whole file. Throws InvalidInput when it cannot be read, or is a pointer that Git LFS left in place of a file.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);
/// At most so many bytes from its beginning.
[[nodiscard]] std::string read_beginning(const std::filesystem::path& path, std::size_t most);
/// Throws InvalidInput where a file is a pointer of Git LFS; for files that read_file does not read.
void refuse_lfs_pointer(const std::filesystem::path& path);

/// Writes next to the file and renames, so that a reader never sees half a file. Throws InvalidInput on failure.
void write_file(const std::filesystem::path& path, std::string_view content);
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// An output file of a command.
struct Output {
  std::string option;          // that names it, for messages
  std::filesystem::path file;  // to be written
  std::size_t shapes = 0;      // a series' .pvd: its shapes are written next to it
  /// Is a file of that name softkin's although it does not say so? Empty: none is.
  std::function<bool(const std::filesystem::path&)> is_own{};
};

/// The file next to an output where a run keeps its results until it is done.
[[nodiscard]] std::filesystem::path journal_of(const std::filesystem::path& output);

/// NAME_0007.vtu next to NAME.pvd.
[[nodiscard]] std::filesystem::path series_file(const std::filesystem::path& pvd, std::size_t step);
/// The shape that a series was stopped at: NAME_stopped.vtu.
[[nodiscard]] std::filesystem::path stopped_file(const std::filesystem::path& pvd);

/// Throws InvalidInput where an output, with all that is written beside it, would replace an input, another output, or
/// what is no plain file; or, but where it may, a file that softkin did not write (own_file.hpp).
void check_outputs(const std::vector<Output>& outputs, const std::vector<std::filesystem::path>& inputs,
                   bool may_replace);

/// Makes the folders of the outputs; at the end removes those of them that stayed empty.
class OutputFolders {
 public:
  /// Throws InvalidInput where a folder cannot be made or written to.
  explicit OutputFolders(const std::vector<Output>& outputs);
  ~OutputFolders();
  OutputFolders(const OutputFolders&) = delete;
  OutputFolders& operator=(const OutputFolders&) = delete;

 private:
  void make(const std::filesystem::path& folder);
  void remove_empty() const;

  std::vector<std::filesystem::path> made_;
};

/// Removes half-written files that a killed run left next to its outputs.
void remove_torn_files(const std::vector<Output>& outputs);

}  // namespace softkin
