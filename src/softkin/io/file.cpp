#include <unistd.h>

#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <sstream>

namespace softkin {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::error_code failure;
  if (!fs::exists(path, failure)) throw InvalidInput({path.string()}, "no such file");
  if (fs::is_directory(path, failure)) throw InvalidInput({path.string()}, "is a folder, not a file");
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream content;
  if (!stream || !(content << stream.rdbuf())) {
    if (stream && fs::is_empty(path, failure)) return "";
    throw InvalidInput({path.string()}, "cannot be read");
  }
  return std::move(content).str();
}

void write_file(const fs::path& path, std::string_view content) {
  write_file(path, [content](std::ostream& stream) {
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  });
}

void write_file(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  const fs::path part = path.string() + "." + std::to_string(::getpid()) + ".part";
  std::ofstream stream(part, std::ios::binary);
  write(stream);
  stream.close();
  std::error_code failure;
  if (stream) fs::rename(part, path, failure);
  if (!stream || failure) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw InvalidInput({path.string()}, "cannot be written");
  }
}

}  // namespace softkin
