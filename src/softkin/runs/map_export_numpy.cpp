#include <bit>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/zip.hpp>
#include <softkin/runs/map_export_parts.hpp>

namespace softkin::runs {

namespace {

static_assert(std::endian::native == std::endian::little, "arrays of numpy are little-endian");

/// The arrays of an .npz, each a .npy of format 1.0.
class NumpyArrays {
 public:
  template <class Scalar>
  void add(const std::string& name, const Scalar* values, const std::vector<Eigen::Index>& shape) {
    Eigen::Index count = 1;
    for (const Eigen::Index size : shape) count *= size;
    add_bytes(name, type_of(Scalar{}), shape,
              std::string(reinterpret_cast<const char*>(values), static_cast<std::size_t>(count) * sizeof(Scalar)));
  }
  void add(const std::string& name, const std::vector<double>& values) { add(name, values.data(), {size_of(values)}); }
  void add(const std::string& name, const std::vector<Index>& values) {
    const std::vector<std::int64_t> wide(values.begin(), values.end());
    add(name, wide.data(), {size_of(wide)});
  }
  void add(const std::string& name, const Eigen::VectorXd& values) { add(name, values.data(), {values.size()}); }

  /// UTF-32, of the length of the longest.
  void add(const std::string& name, const std::vector<std::string>& texts) {
    std::size_t longest = 1;
    for (const std::string& text : texts) longest = std::max(longest, characters(text));
    std::string bytes;
    for (const std::string& text : texts) {
      const std::size_t end = bytes.size() + 4 * longest;
      append_utf32(on_one_line(text), bytes);
      bytes.resize(end, '\0');
    }
    add_bytes(name, "<U" + std::to_string(longest), {size_of(texts)}, bytes);
  }
  [[nodiscard]] std::string bytes() const { return zip_of(files_); }

 private:
  template <class Values>
  static Eigen::Index size_of(const Values& values) {
    return values.size();
  }
  static std::string type_of(double) { return "<f8"; }
  static std::string type_of(float) { return "<f4"; }
  static std::string type_of(std::int64_t) { return "<i8"; }
  static std::string type_of(std::int16_t) { return "<i2"; }
  static std::string type_of(std::uint8_t) { return "|u1"; }

  static void append_utf32(std::string_view text, std::string& bytes) {
    while (!text.empty()) {
      const std::size_t length = character_length(text);
      std::uint32_t character = static_cast<unsigned char>(text[0]);
      if (length > 1) character &= 0xFFU >> (length + 1);
      for (std::size_t k = 1; k < length; ++k)
        character = character << 6 | (static_cast<unsigned char>(text[k]) & 0x3FU);
      for (int k = 0; k < 4; ++k) bytes += static_cast<char>(character >> (8 * k) & 255);
      text.remove_prefix(length);
    }
  }

  void add_bytes(const std::string& name, const std::string& type, const std::vector<Eigen::Index>& shape,
                 const std::string& content) {
    constexpr std::size_t before = 10, alignment = 64;
    std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (";
    for (const Eigen::Index size : shape) header += std::to_string(size) + ", ";
    header += ")}";
    header.resize((before + header.size() + 1 + alignment - 1) / alignment * alignment - before - 1, ' ');
    header += '\n';
    std::string file("\x93NUMPY\x01\x00", 8);
    file += static_cast<char>(header.size() & 255);
    file += static_cast<char>(header.size() >> 8);
    files_.emplace_back(name + ".npy", file + header + content);
  }

  std::vector<std::pair<std::string, std::string>> files_;
};

void add_polynomials(const std::string& name, const maps::Polynomials& sums, NumpyArrays& arrays) {
  arrays.add(name + "_degrees", sums.terms().data(), {sums.terms().rows(), sums.terms().cols()});
  arrays.add(name + "_coefficients", sums.coefficients().data(),
             {sums.coefficients().rows(), sums.coefficients().cols()});
}

void add_named(const MapData& data, NumpyArrays& arrays) {
  std::vector<std::string> names, units, output_names, output_units;
  std::vector<double> low, high, accuracy;
  for (const MapInput& input : data.inputs) {
    names.push_back(input.name);
    units.push_back(input.unit);
    low.push_back(input.low);
    high.push_back(input.high);
  }
  for (const MapOutput& output : data.outputs) {
    output_names.push_back(output.name);
    output_units.push_back(output.unit);
    accuracy.push_back(output.accuracy);
  }
  arrays.add("robot", std::vector<std::string>{data.name, data.robot});
  arrays.add("inputs", names);
  arrays.add("input_units", units);
  arrays.add("low", low);
  arrays.add("high", high);
  arrays.add("outputs", output_names);
  arrays.add("output_units", output_units);
  arrays.add("accuracy", accuracy);
  arrays.add("largest_error", data.check.largest);
  arrays.add("mean_error", data.check.mean);
  arrays.add("checked", std::vector<Index>{data.check.points, data.check.outside});
}

void add_cables(const MapData& data, NumpyArrays& arrays) {
  std::vector<Index> inputs, tensions, ratios;
  std::vector<double> commands;
  for (const MapCable& cable : data.cables) {
    inputs.push_back(cable.input);
    tensions.push_back(cable.tension);
    ratios.push_back(cable.ratio);
    commands.push_back(cable.command);
  }
  arrays.add("cable_inputs", inputs);
  arrays.add("cable_commands", commands);
  arrays.add("cable_tensions", tensions);
  arrays.add("cable_ratios", ratios);
}

/// A row per node: input, at, below, above, 0; of a cell -1, 0, 0, 0, its number. The last: outside the map, as where a
/// root is -1.
void add_numpy_trees(const FlatMap& flat, NumpyArrays& arrays) {
  const Index nodes = flat.node_at.size();
  maps::RowMatrix tree(nodes + 1, 5);
  for (Index n = 0; n < nodes; ++n) {
    const std::size_t at = n;
    const auto& [below, above] = flat.node_children[at];
    if (flat.node_inputs[at] < 0)
      tree.row(n) << -1, 0, 0, 0, below;
    else
      tree.row(n) << flat.node_inputs[at], flat.node_at[at], below, above, 0;
  }
  tree.row(nodes) << -1, 0, 0, 0, -1;
  std::vector<Index> roots;
  for (const Index piece : flat.pieces) roots.push_back(piece < 0 ? -1 : flat.roots[piece]);
  arrays.add("roots", roots);
  arrays.add("tree", tree.data(), {tree.rows(), tree.cols()});
}

void add_numpy_cell(const std::string& name, const MapPiece& piece, const MapCell& cell, NumpyArrays& arrays) {
  arrays.add(name + "_inputs", piece.inputs);
  arrays.add(name + "_low", cell.low);
  arrays.add(name + "_high", cell.high);
  add_polynomials(name, cell.outputs, arrays);
  if (cell.modes.count() > 0) add_polynomials(name + "_mode", cell.modes, arrays);
}

}  // namespace

std::string map_npz(const MapData& data) {
  NumpyArrays arrays;
  arrays.add("softkin", std::vector<std::string>{version()});  // the first: by it softkin recognises the file
  add_named(data, arrays);
  add_cables(data, arrays);
  add_numpy_trees(flat_map(data), arrays);
  std::size_t cells = 0;
  for (const MapPiece& piece : data.pieces)
    for (const MapCell& cell : piece.cells) add_numpy_cell("cell" + std::to_string(cells++), piece, cell, arrays);
  if (data.shape) {
    arrays.add("shape_mean", data.shape->mean.data(), {data.shape->mean.size() / 3, 3});
    arrays.add("shape_modes", data.shape->modes.data(), {data.shape->modes.cols(), data.shape->mean.size() / 3, 3});
    arrays.add("shape_units", data.shape->units);
  }
  return arrays.bytes();
}

}  // namespace softkin::runs
