#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace softkin {

/// The whole file. Throws InvalidInput when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Writes beside the file and renames, so that a reader never sees half a file. Throws InvalidInput on failure.
void write_file(const std::filesystem::path& path, std::string_view content);
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// A file that a command is asked to write.
struct Output {
  std::string option;  // that names it, for messages
  std::filesystem::path file;
  std::size_t shapes = 0;  // a series' .pvd: its shapes are written beside it
};

/// NAME_0007.vtu beside NAME.pvd.
[[nodiscard]] std::filesystem::path series_file(const std::filesystem::path& pvd, std::size_t step);

/// Throws InvalidInput where an output would replace an input, another output, or what is no plain file.
void check_outputs(const std::vector<Output>& outputs, const std::vector<std::filesystem::path>& inputs);

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

/// Removes what a killed run left half written beside its outputs.
void remove_torn_files(const std::vector<Output>& outputs);

}  // namespace softkin
