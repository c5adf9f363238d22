#pragma once

#include <softkin/linear/block_matrix.hpp>

namespace softkin::linear {

/// Columns that are eliminated together: a dense front of their unknowns and of those below that they touch.
struct Front {
  Index begin = 0, end = 0;  // unknowns eliminated here
  Index begin_node = 0, end_node = 0;
  std::int64_t first_row = 0;  // in FrontTree::rows: unknowns below, ascending
  Index below = 0;             // how many
  Index parent = -1;           // front
  std::int64_t offset = 0;     // of what it leaves in its arena

  [[nodiscard]] Index pivots() const { return end - begin; }
  [[nodiscard]] Index size() const { return pivots() + below; }
};

/// Symbolic factorisation: fronts in postorder, cut into independent pieces.
struct FrontTree {
  BlockColumns pattern;
  std::vector<Front> fronts;
  std::vector<Index> first_child, next_sibling;  // of each front; -1: none
  std::vector<Index> rows;                       // unknowns below each front
  std::vector<Index> places;                     // of those rows in the parent's front
  std::vector<Index> entry_places;               // row of each entry of the pattern in its column's front
  std::vector<Index> pieces;                     // first front of every piece, then of the top, then their number
  std::vector<std::int64_t> arena_sizes;         // values, of every piece, then of the top
  std::int64_t values = 0;                       // of L
  double flops = 0;                              // of a factorisation
};

/// Zeros that are stored to make fronts wider: those that pay where matrices are factorised again and again, or few,
/// where one is solved with far more often.
enum class Fill { for_factors, for_solves };

/// source  supernodes with relaxed amalgamation as in Ashcraft and Grimes 1989; a front joins its parent where the
///         zeros that this stores are few
[[nodiscard]] FrontTree make_front_tree(BlockColumns pattern, Fill fill = Fill::for_factors);

/// value_bytes  of a value of L
/// throws       InvalidInput where the machine has not the memory that a factorisation takes
void require_memory(const FrontTree& tree, std::size_t value_bytes);

}  // namespace softkin::linear
