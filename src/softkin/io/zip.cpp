#include <zlib.h>

#include <cstdint>
#include <softkin/core/error.hpp>
#include <softkin/io/zip.hpp>

namespace softkin {

namespace {

constexpr std::uint16_t zip_version = 20, first_of_1980 = 0x21;  // the earliest day that a zip can represent

void append_number(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i, value >>= 8) bytes += static_cast<char>(value & 255);
}

std::uint64_t crc_of(const std::string& content) {
  return crc32_z(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(content.data()), content.size());
}

/// The fields that the file's header and the directory have in common.
std::string entry_of(const std::string& name, const std::string& content) {
  std::string bytes;
  append_number(bytes, zip_version, 2);
  append_number(bytes, 0x800, 2);  // names are UTF-8
  append_number(bytes, 0, 4);      // stored; at midnight
  append_number(bytes, first_of_1980, 2);
  append_number(bytes, crc_of(content), 4);
  append_number(bytes, content.size(), 4);
  append_number(bytes, content.size(), 4);
  append_number(bytes, name.size(), 2);
  append_number(bytes, 0, 2);  // no extra field
  return bytes;
}

}  // namespace

std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string bytes, directory;
  for (const auto& [name, content] : files) {
    const std::string entry = entry_of(name, content);
    directory += "PK\x01\x02";
    append_number(directory, zip_version, 2);
    directory += entry;
    append_number(directory, 0, 10);  // no comment; disk 0; no attributes
    append_number(directory, bytes.size(), 4);
    directory += name;
    bytes += "PK\x03\x04" + entry + name + content;
  }
  if (files.size() > 65535 || bytes.size() + directory.size() > 0xFFFFFFF0U)
    throw InvalidInput("that is too much for a zip archive");
  const std::size_t at = bytes.size();
  bytes += directory + "PK\x05\x06";
  append_number(bytes, 0, 4);  // disk 0
  append_number(bytes, files.size(), 2);
  append_number(bytes, files.size(), 2);
  append_number(bytes, directory.size(), 4);
  append_number(bytes, at, 4);
  append_number(bytes, 0, 2);  // no comment
  return bytes;
}

}  // namespace softkin
