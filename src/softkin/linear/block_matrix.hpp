#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <softkin/core/large_vector.hpp>
#include <softkin/core/team.hpp>
#include <softkin/core/types.hpp>
#include <span>
#include <vector>

namespace softkin::linear {

/// Sets of vertices that a symmetric matrix couples, each all with all: the vertices of an element, of a face of a
/// cavity, behind a segment of a cable. A set of k vertices owns k (k + 1) / 2 slots for its blocks: (a, b), b <= a, of
/// its own numbering at a (a + 1) / 2 + b.
struct Cliques {
  std::vector<std::int64_t> starts{0};  // of each set in vertices, then their number
  std::vector<Index> vertices;          // distinct within a set
  std::vector<std::int64_t> slots{0};   // first of each set, then their number

  void add(std::span<const Index> set);
  [[nodiscard]] Index count() const { return std::ssize(starts) - 1; }
  /// Differs where the sets do (FNV-1a of 64 bits).
  [[nodiscard]] std::uint64_t fingerprint() const;
};

/// Pattern of a symmetric matrix of 3 x 3 blocks, a row per vertex, lower triangle; made once from its cliques.
class BlockPattern {
 public:
  BlockPattern(Index vertices, const Cliques& cliques);

  /// Sums the blocks of all cliques, 9 values a slot by rows, into those of the matrix, 9 an entry by rows.
  void gather(const LargeVector<double>& slots, LargeVector<double>& blocks, Team& team) const;

  /// Block of one entry: the sum of its slots, by rows.
  void sum(const LargeVector<double>& slots, std::int64_t entry, double (&block)[9]) const {
    for (double& value : block) value = 0;
    each_slot(entry, [&](std::int64_t slot, bool transposed) { add_slot(slots.data() + 9 * slot, transposed, block); });
  }
  static void add_slot(const double* slot, bool transposed, double (&block)[9]) {
    if (!transposed) {
      for (int k = 0; k < 9; ++k) block[k] += slot[k];
    } else {
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) block[3 * r + c] += slot[3 * c + r];
    }
  }

  /// result = A x, both 3 values per vertex.
  void multiply(const LargeVector<double>& blocks, const Points& x, Points& result, Team& team) const;

  [[nodiscard]] Index vertices() const { return std::ssize(starts_) - 1; }
  [[nodiscard]] std::int64_t entries() const { return static_cast<std::int64_t>(columns_.size()); }

  /// visit(slot, transposed) for the slots whose sum the block of an entry is.
  template <class Visit>
  void each_slot(std::int64_t entry, const Visit& visit) const {
    for (std::int64_t s = source_starts_[entry]; s < source_starts_[entry + 1]; ++s)
      visit(sources_[s] / 2, sources_[s] % 2 != 0);
  }

  /// visit(entry, row, column), column <= row
  template <class Visit>
  void each(const Visit& visit) const {
    for (Index v = 0; v < vertices(); ++v)
      for (std::int64_t e = starts_[v]; e < starts_[v + 1]; ++e) visit(e, v, columns_[e]);
  }

 private:
  std::vector<std::int64_t> starts_;                    // first entry of each row
  std::vector<Index> columns_;                          // ascending in a row; its last is the diagonal
  std::vector<std::int64_t> source_starts_;             // of each entry in sources_
  std::vector<std::int64_t> sources_;                   // 2 slot, plus 1 where the slot holds the transpose
  std::vector<std::int64_t> across_starts_;             // of each column in across_: its entries below the diagonal
  std::vector<std::pair<std::int64_t, Index>> across_;  // entry, row
};

/// Pattern of a symmetric matrix of dense blocks, lower triangle by block columns: the unknowns of a node (a vertex: up
/// to 3, a rigid region: up to 6) stand together, nodes in elimination order. A block's values are column-major.
struct BlockColumns {
  std::vector<Index> unknowns{0};        // first of each node, then their number
  std::vector<Index> starts{0};          // first entry of each column
  std::vector<Index> rows;               // nodes, ascending; a column's first is its diagonal
  std::vector<std::int64_t> offsets{0};  // of each entry's values, then their number; a diagonal block is square
  std::vector<Index> pieces{0};          // nodes that begin whole, independent subtrees; the last: their ancestors

  [[nodiscard]] Index nodes() const { return std::ssize(unknowns) - 1; }
  [[nodiscard]] Index size() const { return unknowns.back(); }
  [[nodiscard]] Index width(Index node) const { return unknowns[node + 1] - unknowns[node]; }
};

/// left -= A x, columns of the pattern's order of unknowns, the same for any team.
void subtract_product(const BlockColumns& pattern, const LargeVector<double>& values,
                      const Eigen::Ref<const Eigen::MatrixXd>& x, Eigen::MatrixXd& left, Team& team);

}  // namespace softkin::linear
