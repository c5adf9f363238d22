#include <algorithm>
#include <softkin/linear/front_solve.hpp>
#include <softkin/linear/sparse_ldlt.hpp>
#include <utility>

namespace softkin::linear {

namespace {

/// Columns worth a thread's start.
template <class Body>
void each_column(Index columns, Index rows, Team& team, const Body& body) {
  constexpr double worthwhile = 1e5;
  if (static_cast<double>(columns) * rows < worthwhile) {
    for (Index c = 0; c < columns; ++c) body(c);
  } else {
    team.pieces(columns, [&](Index begin, Index end) {
      for (Index c = begin; c < end; ++c) body(c);
    });
  }
}

}  // namespace

SparseLdlt::SparseLdlt(const BlockColumns& pattern)
    : SparseLdlt(std::make_shared<const FrontTree>(make_front_tree(pattern))) {}

SparseLdlt::SparseLdlt(std::shared_ptr<const FrontTree> tree)
    : tree_(std::move(tree)),
      diagonal_(static_cast<std::size_t>(tree_->pattern.size())),
      pieces_(tree_->arena_sizes.size()) {}

void SparseLdlt::change(std::shared_ptr<const FrontTree> tree) {
  tree_ = std::move(tree);
  diagonal_.resize(static_cast<std::size_t>(tree_->pattern.size()));
  pieces_ = std::vector<Piece>(tree_->arena_sizes.size());
  has_memory_ = false;
}

/// A bench for the time of a piece.
class SparseLdlt::Seat {
 public:
  Seat(SparseLdlt& owner, std::int64_t arena_size) : owner_(owner) {
    {
      const std::lock_guard lock(owner_.benches_mutex_);
      if (!owner_.benches_.empty()) {
        bench_ = std::move(owner_.benches_.back());  // the one that was used last
        owner_.benches_.pop_back();
      }
    }
    if (!bench_) bench_ = std::make_unique<Bench>();
    const std::size_t needed = static_cast<std::size_t>(arena_size) + front_slack;
    if (bench_->arena.size() < needed) bench_->arena.resize(needed);
  }
  ~Seat() {
    const std::lock_guard lock(owner_.benches_mutex_);
    owner_.benches_.push_back(std::move(bench_));
  }
  Seat(const Seat&) = delete;
  Seat& operator=(const Seat&) = delete;
  [[nodiscard]] Bench& bench() { return *bench_; }

 private:
  SparseLdlt& owner_;
  std::unique_ptr<Bench> bench_;
};

void SparseLdlt::take_memory() {
  has_memory_ = true;
  lower_.resize(static_cast<std::size_t>(tree_->values) + solve_slack);
  std::fill(lower_.end() - solve_slack, lower_.end(), 0.0);
  top_.arena.resize(static_cast<std::size_t>(tree_->arena_sizes.back()) + front_slack);
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    Index size = 0;
    for (Index f = tree_->pieces[p]; f < tree_->pieces[p + 1]; ++f) size = std::max(size, tree_->fronts[f].size());
    pieces_[p].rows.setZero(size + solve_slack, columns_together);
  }
}

double SparseLdlt::bytes() const {
  double values = static_cast<double>(lower_.size() + diagonal_.size());
  const auto add = [&](const Bench& bench) {
    values += static_cast<double>(bench.arena.size() + bench.work.plain.size() + bench.work.scaled.size());
  };
  add(top_);
  for (const auto& bench : benches_) add(*bench);
  return 8 * values + 4.0 * static_cast<double>(tree_->rows.size() + 3 * tree_->runs.size() +
                                                tree_->pattern.rows.size() + tree_->entry_places.size());
}

void SparseLdlt::assemble(Index index, const LargeVector<double>& values, double* front, const Bench& bench,
                          Team& team) const {
  const Front& own = tree_->fronts[index];
  const Index stride = front_stride(own.size());
  each_column(own.size(), stride, team, [&](Index c) {
    double* column = front + static_cast<std::ptrdiff_t>(c) * stride;
    std::fill(column + c / 8 * 8, column + stride, 0.0);
  });
  for (Index node = own.begin_node; node < own.end_node; ++node) {
    const Index width = tree_->pattern.width(node);
    double* columns = front + static_cast<std::ptrdiff_t>(tree_->pattern.unknowns[node] - own.begin) * stride;
    for (Index e = tree_->pattern.starts[node]; e < tree_->pattern.starts[node + 1]; ++e) {
      const Index height = tree_->pattern.width(tree_->pattern.rows[e]);
      const double* block = values.data() + tree_->pattern.offsets[e];
      double* target = columns + tree_->entry_places[e];
      for (Index c = 0; c < width; ++c)
        for (Index r = 0; r < height; ++r) target[static_cast<std::ptrdiff_t>(c) * stride + r] = block[c * height + r];
    }
  }
  for (Index i = tree_->first_child[index]; i >= 0; i = tree_->next_sibling[i]) {
    const Front& child = tree_->fronts[i];
    const Index child_stride = front_stride(child.size()), pivots = child.pivots();
    const double* update =
        bench.arena.data() + child.offset + static_cast<std::ptrdiff_t>(pivots) * child_stride + pivots;
    const RowRun* first = tree_->runs.data() + tree_->first_run[i];
    const RowRun* last = tree_->runs.data() + tree_->first_run[i + 1];
    each_column(static_cast<Index>(last - first), child.below, team, [&](Index k) {
      for (Index c = 0; c < first[k].length; ++c) {
        const Index column = first[k].from + c;
        double* to = front + static_cast<std::ptrdiff_t>(first[k].to + c) * stride;
        const double* from = update + static_cast<std::ptrdiff_t>(column) * child_stride;
        for (Index r = c; r < first[k].length; ++r) to[first[k].to + r] += from[first[k].from + r];
        for (const RowRun* run = first + k + 1; run < last; ++run)
          for (Index r = 0; r < run->length; ++r) to[run->to + r] += from[run->from + r];
      }
    });
  }
}

/// Returns how many pivots are negative.
Index SparseLdlt::factor(Index index, const LargeVector<double>& values, double least, Bench& bench, Team& team) {
  const Front& own = tree_->fronts[index];
  const Index size = own.size(), pivots = own.pivots(), stride = front_stride(size);
  double* front = (own.parent >= top_front() ? top_ : bench).arena.data() + own.offset;
  assemble(index, values, front, bench, team);
  const Index negative = factor_front(front, size, pivots, least, diagonal_.data() + own.begin, bench.work, team);
  const auto column = [&](Index c) { return front + static_cast<std::ptrdiff_t>(c) * stride; };
  each_column(pivots, size, team, [&](Index c) {
    double* to = lower_.data() + own.first_value + static_cast<std::int64_t>(c) * size;
    std::fill_n(to, c, 0.0);
    std::copy(column(c) + c, column(c) + size, to + c);
  });
  return negative;
}

SparseLdlt::Pivots SparseLdlt::factorise(const LargeVector<double>& values, double least, Team& team) {
  if (!has_memory_) take_memory();
  const Index count = static_cast<Index>(pieces_.size()) - 1;
  Team alone(1);
  const auto run = [&](Index p, Bench& bench, Team& helpers) {
    pieces_[p].negative = 0;
    for (Index f = tree_->pieces[p]; f < tree_->pieces[p + 1]; ++f)
      pieces_[p].negative += factor(f, values, least, bench, helpers);
  };
  team.each(count, [&](Index p) {
    Seat seat(*this, tree_->arena_sizes[p]);
    run(p, seat.bench(), alone);
  });
  run(count, top_, team);
  Pivots pivots;
  for (const Piece& piece : pieces_) pivots.negative += piece.negative;
  pivots.replaced = static_cast<Index>(std::count(diagonal_.begin(), diagonal_.end(), -least));
  return pivots;
}

/// `columns` columns of the solution from `begin` on, through a front. What unknowns from `top` on lose stands in the
/// piece's `above`.
void SparseLdlt::forward(const Front& front, Index begin, Index columns, Piece& piece, Index top) {
  const Index* rows = tree_->rows.data() + front.first_row;
  const Index stride = static_cast<Index>(piece.rows.rows());
  for (Index c = 0; c < columns; ++c) {
    double* y = piece.rows.col(c).data();
    std::copy_n(solution_.col(begin + c).data() + front.begin, front.pivots(), y);
    std::fill_n(y + front.pivots(), front.below, 0.0);
  }
  solve_forward(lower_.data() + front.first_value, front.size(), front.pivots(), piece.rows.data(), stride, columns);
  for (Index c = 0; c < columns; ++c) {
    const double* y = piece.rows.col(c).data();
    std::copy_n(y, front.pivots(), solution_.col(begin + c).data() + front.begin);
    for (Index r = 0; r < front.below; ++r) {
      if (rows[r] < top)
        solution_(rows[r], begin + c) += y[front.pivots() + r];
      else
        piece.above(rows[r] - top, begin + c) -= y[front.pivots() + r];
    }
  }
}

void SparseLdlt::backward(const Front& front, Index begin, Index columns, Piece& piece) {
  const Index* rows = tree_->rows.data() + front.first_row;
  const Index stride = static_cast<Index>(piece.rows.rows());
  for (Index c = 0; c < columns; ++c) {
    const double* x = solution_.col(begin + c).data();
    double* y = piece.rows.col(c).data();
    for (Index r = 0; r < front.pivots(); ++r) y[r] = x[front.begin + r] / diagonal_[front.begin + r];
    for (Index r = 0; r < front.below; ++r) y[front.pivots() + r] = x[rows[r]];
    std::fill_n(y + front.size(), solve_slack, 0.0);
  }
  solve_backward(lower_.data() + front.first_value, front.size(), front.pivots(), piece.rows.data(), stride, columns);
  for (Index c = 0; c < columns; ++c)
    std::copy_n(piece.rows.col(c).data(), front.pivots(), solution_.col(begin + c).data() + front.begin);
}

void SparseLdlt::solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team) {
  const Index count = static_cast<Index>(pieces_.size()) - 1, first_top = top_front();
  const Index end = static_cast<Index>(tree_->fronts.size());
  const Index top = first_top < end ? tree_->fronts[first_top].begin : size();
  solution_ = right_sides;
  const auto together = [&](const auto& visit) {
    for (Index c = 0; c < solution_.cols(); c += columns_together)
      visit(c, std::min<Index>(columns_together, static_cast<Index>(solution_.cols()) - c));
  };
  team.each(count, [&](Index p) {
    pieces_[p].above.setZero(size() - top, solution_.cols());
    for (Index f = tree_->pieces[p]; f < tree_->pieces[p + 1]; ++f)
      together([&](Index c, Index columns) { forward(tree_->fronts[f], c, columns, pieces_[p], top); });
  });
  for (Index p = 0; p < count; ++p) solution_.bottomRows(size() - top) -= pieces_[p].above;
  Piece& last = pieces_.back();
  for (Index f = first_top; f < end; ++f)
    together([&](Index c, Index columns) { forward(tree_->fronts[f], c, columns, last, size()); });
  for (Index f = end - 1; f >= first_top; --f)
    together([&](Index c, Index columns) { backward(tree_->fronts[f], c, columns, last); });
  team.each(count, [&](Index p) {
    for (Index f = tree_->pieces[p + 1] - 1; f >= tree_->pieces[p]; --f)
      together([&](Index c, Index columns) { backward(tree_->fronts[f], c, columns, pieces_[p]); });
  });
  right_sides = solution_;
}

}  // namespace softkin::linear
