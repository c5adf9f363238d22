#include <algorithm>
#include <numeric>
#include <softkin/linear/ordering.hpp>
#include <softkin/statics/supports/reduced_matrix.hpp>

namespace softkin::supports {

Eigen::SparseMatrix<double> node_graph(const linear::BlockPattern& pattern, const std::vector<Index>& node_of,
                                       Index nodes) {
  std::vector<Eigen::Triplet<double>> links;
  for (Index node = 0; node < nodes; ++node) links.emplace_back(node, node, 1.0);
  pattern.each([&](std::int64_t, Index row, Index column) {
    const Index i = node_of[row], j = node_of[column];
    if (i >= 0 && j >= 0 && i != j) links.emplace_back(std::max(i, j), std::min(i, j), 1.0);
  });
  Eigen::SparseMatrix<double> graph(nodes, nodes);
  graph.setFromTriplets(links.begin(), links.end());
  return graph;
}

namespace {

std::vector<Index> as_they_stand(Index nodes) {
  std::vector<Index> order(nodes);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

}  // namespace

ReducedMatrix::ReducedMatrix(const Freedoms& freedoms, const linear::BlockPattern& pattern)
    : ReducedMatrix(freedoms, pattern, node_graph(pattern, freedoms.node_of_, freedoms.nodes()),
                    as_they_stand(freedoms.nodes()), freedoms.pieces_) {}

ReducedMatrix ReducedMatrix::wider(const Freedoms& freedoms, const linear::BlockPattern& pattern) {
  const Eigen::SparseMatrix<double> graph = node_graph(pattern, freedoms.node_of_, freedoms.nodes());
  const linear::Ordering ordering = linear::postordered(graph, as_they_stand(freedoms.nodes()));
  return {freedoms, pattern, graph, ordering.order, ordering.pieces};
}

ReducedMatrix::ReducedMatrix(const Freedoms& freedoms, const linear::BlockPattern& pattern,
                             const Eigen::SparseMatrix<double>& graph, const std::vector<Index>& order,
                             const std::vector<Index>& pieces)
    : freedoms_(&freedoms) {
  const Index count = freedoms.nodes();
  columns_.pieces = pieces;
  std::vector<Index> place(count);
  bool in_order = true;
  for (Index k = 0; k < count; ++k) {
    const Index node = order[k];
    place[node] = k;
    in_order = in_order && node == k;
    vertex_at_.push_back(freedoms.vertex_of_[node]);
    columns_.unknowns.push_back(columns_.unknowns.back() + freedoms.width(node));
  }
  for (Index k = 0; k < count && !in_order; ++k)
    for (Index i = 0; i < columns_.width(k); ++i) unknown_at_.push_back(freedoms.unknowns_[order[k]] + i);
  for (const Freedoms::Region& region : freedoms.regions_) region_nodes_.push_back(place[region.node]);

  std::vector<std::vector<Index>> rows(count);
  for (Index j = 0; j < count; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(graph, j); it; ++it) {
      const Index a = place[it.row()], b = place[j];
      rows[std::min(a, b)].push_back(std::max(a, b));
    }
  for (Index j = 0; j < count; ++j) {
    std::sort(rows[j].begin(), rows[j].end());
    for (const Index row : rows[j]) {
      columns_.rows.push_back(row);
      columns_.offsets.push_back(columns_.offsets.back() +
                                 static_cast<std::int64_t>(columns_.width(row)) * columns_.width(j));
    }
    columns_.starts.push_back(columns_.rows.size());
  }
  find_sources(pattern, place);
}

void ReducedMatrix::find_sources(const linear::BlockPattern& pattern, const std::vector<Index>& place) {
  const Freedoms& f = *freedoms_;
  std::vector<std::pair<std::int64_t, bool>> block_of(columns_.rows.size(), {-1, false});  // and is it the transpose
  pattern.each([&](std::int64_t block, Index row, Index column) {
    if (f.node_of_[row] < 0 || f.node_of_[column] < 0) return;
    const Index i = place[f.node_of_[row]], j = place[f.node_of_[column]];
    const Index low = std::min(i, j), high = std::max(i, j);
    const auto first = columns_.rows.begin() + columns_.starts[low],
               last = columns_.rows.begin() + columns_.starts[low + 1];
    const std::int64_t entry = std::lower_bound(first, last, high) - columns_.rows.begin();
    if (f.region_of_[row] < 0 && f.region_of_[column] < 0)
      block_of[entry] = {block, i < j};
    else
      region_blocks_.push_back({block, entry, row, column, i < j});
  });
  source_starts_.push_back(0);
  for (const auto& [block, flipped] : block_of) {
    if (block >= 0)
      pattern.each_slot(block, [&, other = flipped](std::int64_t slot, bool transposed) {
        sources_.push_back(2 * slot + (transposed != other));
      });
    source_starts_.push_back(static_cast<std::int64_t>(sources_.size()));
  }
}

void ReducedMatrix::to_columns(const Eigen::Ref<const Eigen::MatrixXd>& unknowns, Eigen::MatrixXd& out) const {
  out.resize(unknowns.rows(), unknowns.cols());
  for (std::size_t u = 0; u < unknown_at_.size(); ++u) out.row(u) = unknowns.row(unknown_at_[u]);
}

void ReducedMatrix::to_unknowns(const Eigen::MatrixXd& columns, Eigen::Ref<Eigen::MatrixXd> out) const {
  for (std::size_t u = 0; u < unknown_at_.size(); ++u) out.row(unknown_at_[u]) = columns.row(u);
}

void ReducedMatrix::reduce(const linear::BlockPattern& pattern, const LargeVector<double>& slots,
                           const Points& gradient, const Points& positions, LargeVector<double>& values,
                           Team& team) const {
  reduce_vertices(slots, values, team);
  if (freedoms_->regions_.empty()) return;
  add_regions(pattern, slots, positions, values);
  add_turning(gradient, positions, values);
}

/// All blocks but those of a region, which become zero.
void ReducedMatrix::reduce_vertices(const LargeVector<double>& slots, LargeVector<double>& values, Team& team) const {
  const Freedoms& f = *freedoms_;
  values.resize(columns_.offsets.back());
  const auto sources = static_cast<std::int64_t>(sources_.size());
  team.pieces(columns_.nodes(), [&](Index begin, Index end) {
    constexpr std::int64_t ahead = 12;  // the slots lie all over the memory
    for (Index j = begin; j < end; ++j)
      for (Index e = columns_.starts[j]; e < columns_.starts[j + 1]; ++e) {
        double block[9] = {};
        for (std::int64_t s = source_starts_[e]; s < source_starts_[e + 1]; ++s) {
          const char* next =
              reinterpret_cast<const char*>(slots.data() + 9 * (sources_[std::min(s + ahead, sources - 1)] / 2));
          __builtin_prefetch(next);
          __builtin_prefetch(next + 64);
          linear::BlockPattern::add_slot(slots.data() + 9 * (sources_[s] / 2), sources_[s] % 2 != 0, block);
        }
        double* value = values.data() + columns_.offsets[e];
        if (vertex_at_[j] < 0 || vertex_at_[columns_.rows[e]] < 0) {  // of a region
          std::fill(value, values.data() + columns_.offsets[e + 1], 0.0);
          continue;
        }
        const auto &row_fixed = f.fixed_[vertex_at_[columns_.rows[e]]], &column_fixed = f.fixed_[vertex_at_[j]];
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r)
            if (!row_fixed[r] && !column_fixed[c]) *value++ = block[3 * r + c];
      }
  });
}

void ReducedMatrix::add_regions(const linear::BlockPattern& pattern, const LargeVector<double>& slots,
                                const Points& positions, LargeVector<double>& values) const {
  const Freedoms& f = *freedoms_;
  const std::vector<Vec3> middles = f.centers(positions);
  for (const RegionBlock& part : region_blocks_) {
    double sum[9];
    pattern.sum(slots, part.block, sum);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(sum);
    const Eigen::MatrixXd product =
        f.tangent(part.row, middles, positions).transpose() * block * f.tangent(part.column, middles, positions);
    const bool same_node = f.region_of_[part.row] >= 0 && f.region_of_[part.row] == f.region_of_[part.column];
    const bool flipped = part.transposed && !same_node;
    const Index height = flipped ? static_cast<Index>(product.cols()) : static_cast<Index>(product.rows());
    Eigen::Map<Eigen::MatrixXd> target(values.data() + columns_.offsets[part.entry], height,
                                       flipped ? product.rows() : product.cols());
    if (flipped)
      target += product.transpose();
    else
      target += product;
    if (same_node && part.row != part.column) target += product.transpose();
  }
}

/// Adds the contribution of the gradient for regions that turn.
void ReducedMatrix::add_turning(const Points& gradient, const Points& positions, LargeVector<double>& values) const {
  const Freedoms& f = *freedoms_;
  for (std::size_t r = 0; r < f.regions_.size(); ++r) {
    const Freedoms::Region& region = f.regions_[r];
    const Mat3 bend = Freedoms::bend_of(region, gradient, positions);
    const Index node = region_nodes_[r], width = columns_.width(node), slides = region.slide_axes.size();
    Eigen::Map<Eigen::MatrixXd> target(values.data() + columns_.offsets[columns_.starts[node]], width, width);
    for (Index i = slides; i < width; ++i)
      for (Index k = slides; k < width; ++k)
        target(i, k) += bend(region.turn_axes[i - slides], region.turn_axes[k - slides]);
  }
}

}  // namespace softkin::supports
