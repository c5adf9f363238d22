#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <softkin/io/mesh/gmsh_format.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace softkin::gmsh {

/// Rows of the vertices by their number in the file; numbers may be sparse and unordered.
class NodeNumbers {
 public:
  explicit NodeNumbers(std::size_t expected = 0) : dense_limit_(4 * expected + 1024) {}

  /// False where the number is taken.
  bool insert(std::int64_t number, Index row) {
    if (!is_dense(number)) return sparse_.try_emplace(number, row).second;
    const std::size_t place = number;
    if (place >= dense_.size()) dense_.resize(std::min(dense_limit_, 2 * place + 1), -1);
    if (dense_[place] >= 0) return false;
    dense_[place] = row;
    return true;
  }

  /// -1 where no node has the number.
  [[nodiscard]] Index find(std::int64_t number) const {
    if (is_dense(number)) {
      const std::size_t place = number;
      return place < dense_.size() ? dense_[place] : -1;
    }
    const auto found = sparse_.find(number);
    return found == sparse_.end() ? -1 : found->second;
  }

 private:
  [[nodiscard]] bool is_dense(std::int64_t number) const { return static_cast<std::size_t>(number) < dense_limit_; }

  std::size_t dense_limit_;
  std::vector<Index> dense_;
  std::unordered_map<std::int64_t, Index> sparse_;
};

/// Cells in the order in which they come; those with the same vertices are stored once.
template <std::size_t N>
class CellStore {
 public:
  using Cell = std::array<Index, N>;

  /// Index of the cell, new or known.
  Index add(const Cell& cell) {
    if (2 * (cells_.size() + 1) > slots_.size()) grow();
    Index& slot = slot_of(sorted(cell));
    if (slot < 0) {
      slot = cells_.size();
      cells_.push_back(cell);
    }
    return slot;
  }
  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  std::vector<Cell> take() { return std::move(cells_); }

 private:
  static Cell sorted(Cell cell) {
    std::sort(cell.begin(), cell.end());
    return cell;
  }

  static std::size_t hash(const Cell& key) {
    std::uint64_t value = 0;
    for (const Index i : key) {
      value = (value ^ static_cast<std::uint32_t>(i)) * 0x9E3779B97F4A7C15u;
      value ^= value >> 32;
    }
    return value;
  }

  // Where the cell of these vertices stands, or the free slot (-1) where it belongs.
  Index& slot_of(const Cell& key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t place = hash(key) & mask;
    while (slots_[place] >= 0 && sorted(cells_[slots_[place]]) != key) place = (place + 1) & mask;
    return slots_[place];
  }

  void grow() {
    slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), -1);
    for (std::size_t i = 0; i < cells_.size(); ++i) slot_of(sorted(cells_[i])) = i;
  }

  std::vector<Cell> cells_;
  std::vector<Index> slots_;  // open addressing, at most half full: half the time of a std::unordered_map
};

/// Collects the content of a .msh file and makes a Mesh of it. Reports invalid content as a failure of the source, with
/// its position.
class Builder {
 public:
  explicit Builder(const Source& in) : in_(in) {}

  void begin_nodes(std::size_t count);
  /// Gives the next vertex a number, which must be new.
  void number_node(std::int64_t number);
  void place_node(Index row, const Vec3& position) { positions_.row(row) = position.transpose(); }
  [[nodiscard]] Index node_count() const { return node_count_; }
  /// The vertex of a number that an element names.
  [[nodiscard]] Index vertex(std::int64_t element, std::int64_t number) const;

  /// The physical group of a dimension and tag; the reference stays valid.
  Region& group(int dimension, int tag);
  /// vertices holds shape_of(type).nodes rows.
  void add_element(CellType type, std::span<const Index> vertices, std::span<Region* const> groups);
  void name_group(int dimension, int tag, const std::string& name);
  /// The mesh, once; its groups become named regions.
  Mesh take();

 private:
  using Key = std::pair<int, int>;  // dimension, tag

  void add_volume(CellType type, std::span<const Index> vertices, std::span<Region* const> groups);
  void add_tetrahedron(CellType type, std::span<const Index> vertices, std::span<Region* const> groups);
  void move_to_regions(const Key& key, const std::string& name);
  void make_regions();

  const Source& in_;
  Points positions_;
  Index node_count_ = 0;
  NodeNumbers numbers_;
  CellStore<3> triangles_;
  std::vector<Triangle> loose_;  // in no group: kept where there is no volume
  CellStore<4> quads_, tetrahedra_;
  std::vector<EdgeNodes> edge_nodes_;
  bool has_linear_ = false, has_quadratic_ = false;  // tetrahedra
  CellStore<6> prisms_;
  std::map<Key, Region> groups_;
  std::map<Key, std::string> names_;
  std::set<std::pair<int, std::string>> used_names_;  // with their dimension
  std::vector<Key> named_;                            // in the order of the file
  std::vector<Region> regions_;
};

}  // namespace softkin::gmsh
