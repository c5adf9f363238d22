#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <pugixml.hpp>
#include <softkin/io/mesh/vtk_grid.hpp>
#include <softkin/io/mesh/vtu_bytes.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A .vtu file as XML elements and the values of its arrays.
class VtuDocument {
 public:
  explicit VtuDocument(const std::filesystem::path& path);
  [[nodiscard]] pugi::xml_node grid() const { return grid_; }  // the UnstructuredGrid element

  [[nodiscard]] pugi::xml_node child(pugi::xml_node parent, const char* name) const;
  /// The DataArray of this name below parent.
  [[nodiscard]] pugi::xml_node array(pugi::xml_node parent, const std::string& name) const;
  [[nodiscard]] std::string text(pugi::xml_node node, const char* attribute) const;
  [[nodiscard]] std::int64_t integer(pugi::xml_node node, const char* attribute, std::int64_t low,
                                     std::int64_t high) const;
  /// The attribute NumberOfComponents; 1 where it is not given.
  [[nodiscard]] std::int64_t components(pugi::xml_node array) const;
  /// The type of an array's numbers, or none where it holds strings.
  [[nodiscard]] std::optional<NumberType> type(pugi::xml_node array) const;
  [[nodiscard]] std::vector<double> reals(pugi::xml_node array, std::uint64_t count) const;
  [[nodiscard]] std::vector<std::int64_t> integers(pugi::xml_node array, std::uint64_t count) const;
  [[nodiscard]] std::vector<std::string> strings(pugi::xml_node array) const;
  [[nodiscard]] Origin origin(pugi::xml_node node) const;
  [[noreturn]] void fail(pugi::xml_node node, const std::string& message) const;

 private:
  struct Range {
    std::size_t begin = 0, end = 0;  // in content_
  };
  /// The XML of the file; appended data, which need not be XML, are cut out.
  std::string head_of_file();
  void find_appended_data(std::size_t tag);
  void parse(const std::string& head);
  void read_encoding(pugi::xml_node root);
  [[nodiscard]] Range inline_text(pugi::xml_node array) const;
  [[nodiscard]] std::string decoded(pugi::xml_node array, std::optional<std::uint64_t> expected) const;
  [[nodiscard]] std::string unpacked(const VtuPlace& place, std::optional<std::uint64_t> expected) const;
  [[nodiscard]] bool is_ascii(pugi::xml_node array) const;

  template <class Value>
  [[nodiscard]] std::vector<Value> values(pugi::xml_node array, NumberType type,
                                          std::optional<std::uint64_t> count) const;

  std::string file_, content_;
  pugi::xml_document xml_;
  pugi::xml_node grid_;
  VtuEncoding encoding_;
  mutable std::uint64_t unpacked_ = 0;  // bytes
  bool knows_byte_order_ = false;
  std::optional<Range> appended_;  // after the underscore
  bool appended_base64_ = false;
};

}  // namespace softkin
