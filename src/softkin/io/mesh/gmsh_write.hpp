#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <softkin/io/mesh/gmsh_types.hpp>
#include <softkin/model/mesh/element_order.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin::gmsh {

/// Why a mesh cannot be written so that it is read back as it is, or "".
[[nodiscard]] std::string problem_of(const Mesh& mesh);

/// A geometric entity of the file: what physical groups hang on. Its tag is its place in the list, from 1.
struct Entity {
  std::vector<int> groups;  // physical tags: places in mesh.regions, from 1; 0: no region
  Eigen::AlignedBox3d box;
};

/// Consecutive cells of one type in one entity; of order 2 they are placed by their corners.
struct Block {
  CellType type;
  int entity;
  Index first;
  Index count;
};

/// One entity per set of regions that cells are in and dimension; points: one per vertex that a region names.
struct Layout {
  std::array<std::vector<Entity>, 4> entities;         // by dimension
  std::vector<Block> blocks;                           // in runs, so that cells keep their order
  std::vector<QuadraticTriangle> quadratic_triangles;  // mesh.triangles with their edge nodes, where these are known
};
[[nodiscard]] Layout lay_out(const Mesh& mesh);

/// Values of a 4.1 file in memory: words, one record a line, or binary in the byte order of this machine.
class Sink {
 public:
  explicit Sink(bool binary) : binary_(binary) {}

  void text(std::string_view text) { content_ += text; }
  void open_section(std::string_view name);
  void close_section(std::string_view name);
  void int_value(std::int32_t value) { binary_ ? raw(value) : word(value); }
  void size_value(std::uint64_t value) { binary_ ? raw(value) : word(value); }
  /// In text the shortest form that reads back exactly.
  void real(double value) { binary_ ? raw(value) : word(value); }
  void end_record();
  [[nodiscard]] const std::string& content() const { return content_; }

 private:
  template <class T>
  void raw(T value);
  template <class T>
  void word(T value);

  std::string content_;
  bool binary_;
};

}  // namespace softkin::gmsh
