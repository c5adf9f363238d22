#pragma once

#include <Eigen/Core>
#include <random>
#include <set>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/linear/ordering.hpp>
#include <utility>
#include <vector>

namespace softkin::linear::testing {

using Links = std::vector<std::pair<Index, Index>>;

/// Neighbours in a grid of nx x ny x nz nodes, diagonals of the cells too.
inline Links grid_links(int nx, int ny, int nz) {
  Links links;
  const auto at = [&](int i, int j, int k) { return static_cast<Index>(i + nx * (j + ny * k)); };
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int c = 1; c < 8; ++c) {
          const int x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
          if (x < nx && y < ny && z < nz) links.emplace_back(at(i, j, k), at(x, y, z));
        }
  return links;
}

/// A random symmetric block matrix in its elimination order, and the same one dense.
struct Symmetric {
  BlockColumns pattern;
  LargeVector<double> values;
  Eigen::MatrixXd dense;
};

inline void append_column(BlockColumns& pattern, Index column, const std::set<Index>& below) {
  std::vector<Index> rows{column};
  rows.insert(rows.end(), below.begin(), below.end());
  for (const Index row : rows) {
    pattern.rows.push_back(row);
    pattern.offsets.push_back(pattern.offsets.back() +
                              static_cast<std::int64_t>(pattern.width(row)) * pattern.width(column));
  }
  pattern.starts.push_back(pattern.rows.size());
}

inline BlockColumns ordered_pattern(const std::vector<Index>& widths, const Links& links) {
  const Index nodes = widths.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index node = 0; node < nodes; ++node) entries.emplace_back(node, node, 1.0);
  for (const auto& [a, b] : links) entries.emplace_back(std::max(a, b), std::min(a, b), 1.0);
  Eigen::SparseMatrix<double> graph(nodes, nodes);
  graph.setFromTriplets(entries.begin(), entries.end());
  const Ordering ordering = nested_dissection(graph);
  std::vector<Index> place(nodes);
  BlockColumns pattern;
  pattern.pieces = ordering.pieces;
  for (Index k = 0; k < nodes; ++k) {
    place[ordering.order[k]] = k;
    pattern.unknowns.push_back(pattern.unknowns.back() + widths[ordering.order[k]]);
  }
  std::vector<std::set<Index>> below(nodes);
  for (const auto& [a, b] : links)
    if (a != b) below[std::min(place[a], place[b])].insert(std::max(place[a], place[b]));
  for (Index k = 0; k < nodes; ++k) append_column(pattern, k, below[k]);
  return pattern;
}

/// Makes a sample. balance: added to the diagonal, times a sign that is negative for a random fraction of the unknowns
inline Symmetric make_sample(const std::vector<Index>& widths, const Links& links, double negative_fraction,
                             unsigned seed) {
  Symmetric sample;
  sample.pattern = ordered_pattern(widths, links);
  const BlockColumns& p = sample.pattern;
  sample.values.resize(p.offsets.back());
  sample.dense = Eigen::MatrixXd::Zero(p.size(), p.size());
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0, 0.2);
  std::uniform_real_distribution<double> uniform;
  for (Index j = 0; j < p.nodes(); ++j)
    for (Index e = p.starts[j]; e < p.starts[j + 1]; ++e) {
      const Index i = p.rows[e];
      Eigen::MatrixXd block = Eigen::MatrixXd::NullaryExpr(p.width(i), p.width(j), [&] { return normal(engine); });
      if (i == j) {
        block = (block + block.transpose()).eval();
        for (Index k = 0; k < p.width(j); ++k) block(k, k) += uniform(engine) < negative_fraction ? -6 : 6;
      }
      Eigen::Map<Eigen::MatrixXd>(sample.values.data() + p.offsets[e], p.width(i), p.width(j)) = block;
      sample.dense.block(p.unknowns[i], p.unknowns[j], p.width(i), p.width(j)) = block;
      sample.dense.block(p.unknowns[j], p.unknowns[i], p.width(j), p.width(i)) = block.transpose();
    }
  return sample;
}

inline std::vector<Index> mixed_widths(Index nodes, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_int_distribution<Index> width(1, 6);
  std::vector<Index> widths;
  for (Index i = 0; i < nodes; ++i) widths.push_back(width(engine));
  return widths;
}

inline Eigen::MatrixXd random_matrix(Index rows, Index columns) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

inline std::vector<Symmetric> samples(double negative_fraction) {
  Links apart = grid_links(5, 4, 1);
  for (const auto& [a, b] : grid_links(3, 3, 3)) apart.emplace_back(20 + a, 20 + b);
  Links star;  // a hub that touches all
  for (Index i = 1; i < 40; ++i) star.emplace_back(0, i);
  return {make_sample({1}, {}, negative_fraction, 1),
          make_sample({6}, {}, negative_fraction, 2),
          make_sample({3, 2}, {{0, 1}}, negative_fraction, 3),
          make_sample({3, 2, 5}, {}, negative_fraction, 4),  // diagonal
          make_sample(std::vector<Index>(60, 3), grid_links(60, 1, 1), negative_fraction, 5),
          make_sample(std::vector<Index>(180, 3), grid_links(9, 5, 4), negative_fraction, 6),
          make_sample(mixed_widths(180, 1), grid_links(9, 5, 4), negative_fraction, 7),
          make_sample(mixed_widths(47, 2), apart, negative_fraction, 8),
          make_sample(mixed_widths(40, 3), star, negative_fraction, 9)};
}

}  // namespace softkin::linear::testing
