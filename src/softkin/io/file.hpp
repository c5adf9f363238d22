#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace softkin {

/// The whole file. Throws InvalidInput when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// Writes beside the file and renames, so that a reader never sees half a file. Throws InvalidInput on failure.
void write_file(const std::filesystem::path& path, std::string_view content);
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

}  // namespace softkin
