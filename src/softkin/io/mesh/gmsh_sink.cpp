#include <charconv>
#include <softkin/io/mesh/gmsh_write.hpp>

namespace softkin::gmsh {

template <class T>
void Sink::raw(T value) {
  content_.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <class T>
void Sink::word(T value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  content_.append(buffer, result.ptr);
  content_ += ' ';
}

template void Sink::raw(std::int32_t);
template void Sink::raw(std::uint64_t);
template void Sink::raw(double);
template void Sink::word(std::int32_t);
template void Sink::word(std::uint64_t);
template void Sink::word(double);

void Sink::open_section(std::string_view name) {
  content_ += '$';
  content_ += name;
  content_ += '\n';
}

void Sink::close_section(std::string_view name) {
  if (binary_) content_ += '\n';
  content_ += "$End";
  content_ += name;
  content_ += '\n';
}

void Sink::end_record() {
  if (!binary_) content_.back() = '\n';
}

}  // namespace softkin::gmsh
