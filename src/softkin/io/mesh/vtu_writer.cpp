#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/base64.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/own_file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace softkin {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;  // bytes compressed at a time

bool is_printable(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(),
                                      [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != 0x7F; });
}

template <class T>
void append_little_endian(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

template <class T>
constexpr const char* type_name() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "UInt8";
}

/// Builds the file, whose arrays stand in their elements as base64 text. Appended data would be found by offsets, which
/// meshio replaces one by one as it reads raw data, and finds a new one where it looks for an old one.
class VtuWriter {
 public:
  VtuWriter(std::string file, const VtuContent& content)
      : file_(std::move(file)),
        content_(content),
        points_(content.points.rows()),
        cells_(content.tetrahedra.size() + content.prisms.size() + content.triangles.size() +
               (content.cloud ? points_ : 0)) {}

  std::string build() {
    check();
    xml_ = "<?xml version=\"1.0\"?>\n" + std::string(xml_mark) +
           "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
           "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n";
    write_field_data();
    xml_ +=
        "<Piece NumberOfPoints=\"" + std::to_string(points_) + "\" NumberOfCells=\"" + std::to_string(cells_) + "\">\n";
    write_fields("PointData", content_.point_fields, {});
    write_fields("CellData", content_.cell_fields, content_.cell_regions);
    xml_ += "<Points>\n";
    write_array<double>("Points", 3, content_.points.data(), points_ * 3);
    xml_ += "</Points>\n";
    write_cells();
    xml_ += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    return std::move(xml_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput({file_}, message); }

  void check() const {
    if (points_ == 0) fail("nothing to write: there are no points");
    for (std::size_t i = 0; i < points_; ++i)
      if (!content_.points.row(i).allFinite()) fail("points: point " + std::to_string(i) + " is not finite");
    check_vertices(content_.tetrahedra, "tetrahedron");
    check_vertices(content_.edge_nodes, "tetrahedron");
    check_vertices(content_.prisms, "prism");
    check_vertices(content_.triangles, "triangle");
    const std::string refusal = refusal_of_orders(content_);
    if (!refusal.empty()) fail(refusal);
    check_fields(content_.point_fields, points_, "point field", false);
    check_fields(content_.cell_fields, cells_, "cell field", !content_.cell_regions.empty());
    check_regions();
    check_constants();
  }

  void check_fields(const std::vector<Field>& fields, std::size_t count, const char* kind, bool has_regions) const {
    std::set<std::string> names;
    if (has_regions) names.insert("region");
    for (const Field& field : fields) {
      const std::string subject = std::string(kind) + " '" + field.name + "'";
      if (!is_printable(field.name)) fail(subject + " has an empty or unprintable name");
      if (!names.insert(field.name).second) fail(subject + " stands twice");
      if (field.components < 1) fail(subject + " has " + std::to_string(field.components) + " components");
      if (field.values.size() != count * static_cast<std::size_t>(field.components))
        fail(subject + " has " + std::to_string(field.values.size()) + " values instead of " + std::to_string(count) +
             " x " + std::to_string(field.components));
      const auto bad =
          std::find_if(field.values.begin(), field.values.end(), [](double v) { return !std::isfinite(v); });
      if (bad != field.values.end())
        fail(subject + ": value " + std::to_string(bad - field.values.begin()) + " is not finite");
    }
  }

  void check_regions() const {
    const std::vector<Index>& regions = content_.cell_regions;
    if (!regions.empty() && regions.size() != cells_)
      fail("there are " + std::to_string(regions.size()) + " cell regions for " + std::to_string(cells_) + " cells");
    std::set<std::string> names;
    for (const std::string& name : content_.region_names) {
      if (!is_printable(name)) fail("region '" + name + "' has an empty or unprintable name");
      if (!names.insert(name).second) fail("region '" + name + "' stands twice");
    }
    for (std::size_t i = 0; i < regions.size(); ++i)
      if (regions[i] < -1 || (regions[i] >= 0 && std::cmp_greater_equal(regions[i], content_.region_names.size())))
        fail("cell " + std::to_string(i) + " is of region " + std::to_string(regions[i]) + ", but there are " +
             std::to_string(content_.region_names.size()));
  }

  void check_constants() const {
    std::set<std::string> names;
    if (!content_.cell_regions.empty())
      for (const std::string& name : content_.region_names) names.insert("region_" + name);
    for (const Field& array : content_.arrays) {
      const std::string subject = "array '" + array.name + "'";
      if (!is_printable(array.name)) fail(subject + " has an empty or unprintable name");
      if (!names.insert(array.name).second) fail(subject + " stands twice");
      if (!std::all_of(array.values.begin(), array.values.end(), [](double v) { return std::isfinite(v); }))
        fail(subject + " has a value that is not finite");
    }
    for (const auto& [name, value] : content_.constants) {
      if (!is_printable(name)) fail("constant '" + name + "' has an empty or unprintable name");
      if (!names.insert(name).second) fail("constant '" + name + "' stands twice");
      if (!std::isfinite(value)) fail("constant '" + name + "' is not finite");
    }
  }

  template <class Cells>
  void check_vertices(const Cells& cells, const char* kind) const {
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (const Index vertex : cells[i])
        if (vertex < 0 || std::cmp_greater_equal(vertex, points_))
          fail(std::string(kind) + " " + std::to_string(i) + " has the vertex " + std::to_string(vertex) +
               ", outside 0 to " + std::to_string(points_ - 1));
  }

  /// Numbers only: other readers refuse arrays of strings.
  void write_field_data() {
    const std::size_t regions = content_.cell_regions.empty() ? 0 : content_.region_names.size();
    if (content_.cell_regions.empty() && content_.constants.empty() && content_.arrays.empty()) return;
    xml_ += "<FieldData>\n";
    for (const auto& [name, value] : content_.constants)
      xml_ += "<DataArray type=\"Float64\" Name=\"" + xml_escaped(name) + "\" NumberOfTuples=\"1\" format=\"ascii\">" +
              exact(value) + "</DataArray>\n";
    for (std::size_t i = 0; i < regions; ++i)
      xml_ += "<DataArray type=\"Int32\" Name=\"region_" + xml_escaped(content_.region_names[i]) +
              "\" NumberOfTuples=\"1\" format=\"ascii\">" + std::to_string(i) + "</DataArray>\n";
    for (const Field& array : content_.arrays)
      write_array(array.name, array.components, array.values.data(), array.values.size(),
                  " NumberOfTuples=\"" +
                      std::to_string(array.values.size() / static_cast<std::size_t>(array.components)) + "\"");
    xml_ += "</FieldData>\n";
  }

  void write_fields(const char* element, const std::vector<Field>& fields, const std::vector<Index>& regions) {
    xml_ += std::string("<") + element + ">\n";
    for (const Field& field : fields)
      write_array(field.name, field.components, field.values.data(), field.values.size());
    if (!regions.empty()) write_array("region", 1, regions.data(), regions.size());
    xml_ += std::string("</") + element + ">\n";
  }

  void write_cells() {
    std::vector<Index> connectivity;
    std::vector<std::int64_t> offsets;
    std::vector<std::uint8_t> types;
    const auto append = [&](const auto& vertices) {
      connectivity.insert(connectivity.end(), vertices.begin(), vertices.end());
    };
    const auto end_cell = [&](std::uint8_t type) {
      offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
      types.push_back(type);
    };
    const bool quadratic = !content_.edge_nodes.empty();
    for (std::size_t i = 0; i < content_.tetrahedra.size(); ++i) {
      append(content_.tetrahedra[i]);
      if (quadratic) append(content_.edge_nodes[i]);  // edges in VTK's order
      end_cell(quadratic ? 24 : 10);
    }
    for (const Prism& prism : content_.prisms) {
      append(prism);
      end_cell(13);
    }
    for (const Triangle& triangle : content_.triangles) {
      append(triangle);
      end_cell(5);
    }
    for (std::size_t i = 0; content_.cloud && i < points_; ++i) {
      connectivity.push_back(i);
      end_cell(1);
    }
    xml_ += "<Cells>\n";
    write_array("connectivity", 1, connectivity.data(), connectivity.size());
    write_array("offsets", 1, offsets.data(), offsets.size());
    write_array("types", 1, types.data(), types.size());
    xml_ += "</Cells>\n";
  }

  template <class T>
  void write_array(const std::string& name, int components, const T* values, std::size_t count,
                   const std::string& attributes = "") {
    xml_ += std::string("<DataArray type=\"") + type_name<T>() + "\" Name=\"" + xml_escaped(name) +
            "\" NumberOfComponents=\"" + std::to_string(components) + "\"" + attributes;
    if (count == 0) {  // meshio cannot read the header of no blocks
      xml_ += " format=\"ascii\">\n</DataArray>\n";
      return;
    }
    std::string bytes;
    bytes.reserve(count * sizeof(T));
    for (std::size_t i = 0; i < count; ++i) append_little_endian(bytes, values[i]);
    xml_ += " format=\"binary\">\n";
    append_compressed(bytes);
    xml_ += "\n</DataArray>\n";
  }

  void append_compressed(const std::string& bytes) {
    const std::size_t blocks = (bytes.size() + kBlock - 1) / kBlock;
    std::vector<std::uint64_t> header{blocks, kBlock, bytes.size() % kBlock};
    std::string data;
    for (std::size_t i = 0; i < blocks; ++i) {
      const std::size_t begin = i * kBlock, size = std::min(kBlock, bytes.size() - begin);
      uLongf length = compressBound(size);
      std::string block(length, '\0');
      const int status = compress2(reinterpret_cast<Bytef*>(block.data()), &length,
                                   reinterpret_cast<const Bytef*>(bytes.data() + begin), size, Z_BEST_SPEED);
      if (status != Z_OK) fail("zlib cannot compress the data");
      header.push_back(length);
      data.append(block, 0, length);
    }
    std::string words;
    for (const std::uint64_t word : header) append_little_endian(words, word);
    xml_ += to_base64(words);  // two texts, as VTK reads them
    xml_ += to_base64(data);
  }

  std::string file_;
  const VtuContent& content_;
  std::size_t points_, cells_;
  std::string xml_;
};

}  // namespace

void write_vtu(const std::filesystem::path& path, const VtuContent& content) {
  write_file(path, VtuWriter(path.string(), content).build());
}

void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries) {
  std::string xml = "<?xml version=\"1.0\"?>\n" + std::string(xml_mark) +
                    "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
                    "<Collection>\n";
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string subject = "entry " + std::to_string(i);
    if (!std::isfinite(entries[i].time))
      throw InvalidInput({path.string()}, subject + " has a time that is not finite");
    if (!is_printable(entries[i].file))
      throw InvalidInput({path.string()}, subject + " has an empty or unprintable file name");
    xml += "<DataSet timestep=\"" + exact(entries[i].time) + "\" group=\"\" part=\"0\" file=\"" +
           xml_escaped(entries[i].file) + "\"/>\n";
  }
  write_file(path, xml + "</Collection>\n</VTKFile>\n");
}

}  // namespace softkin
