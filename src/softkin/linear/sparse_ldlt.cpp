#include <algorithm>
#include <softkin/linear/front_solve.hpp>
#include <softkin/linear/kernels/front.hpp>
#include <softkin/linear/sparse_ldlt.hpp>
#include <utility>

namespace softkin::linear {

namespace {

/// body(begin, end) over columns, of which threads take pieces where that is worth their start.
template <class Body>
void fraction_columns(Index columns, Index rows, Team& team, const Body& body) {
  constexpr double worthwhile = 1e5;
  if (static_cast<double>(columns) * rows < worthwhile)
    body(Index{0}, columns);
  else
    team.pieces(columns, body);
}

template <class Number>
Index run_pack_rows() {
  SOFTKIN_RUN_KERNEL(pack_rows<Number>());
}
template <class Number>
void run_add_columns(const FrontSum<Number>& sum, const RowPack* pack) {
  SOFTKIN_RUN_KERNEL(add_pack_columns(sum, pack));
}

/// The rows that a front leaves as its parent takes them; no pack has rows on both sides of its last pivot.
void add_packs(const Index* places, Index count, Index parent_pivots, Index rows, std::vector<RowPack>& packs) {
  for (Index r = 0; r < count;) {
    RowPack pack{r, places[r], 0};
    const Index end = pack.to < parent_pivots ? std::min(pack.to + rows, parent_pivots) : pack.to + rows;
    for (; r < count && places[r] < end; ++r) pack.bits |= std::uint32_t{1} << (places[r] - pack.to);
    packs.push_back(pack);
  }
}

/// A block's columns, one after the other, to columns that are `stride` apart.
template <class Number>
void copy_block(const double* block, Index width, Index height, Number* to, std::ptrdiff_t stride) {
  const auto copy = [&](Index columns, Index rows) {
    for (Index c = 0; c < columns; ++c)
      for (Index r = 0; r < rows; ++r) to[c * stride + r] = static_cast<Number>(block[c * rows + r]);
  };
  if (width == 3 && height == 3) return copy(3, 3);  // most are, and loops of known lengths become straight code
  copy(width, height);
}

/// Room for a front's arena; what stood in the memory is lost.
template <class Number>
Number* arena_in(LargeVector<double>& memory, std::int64_t arena_size) {
  const std::size_t bytes = (static_cast<std::size_t>(arena_size) + front_slack) * sizeof(Number);
  const std::size_t needed = (bytes + sizeof(double) - 1) / sizeof(double);
  if (memory.capacity() < needed) LargeVector<double>().swap(memory);  // first, so that the two never stand together
  if (memory.size() < needed) memory.resize(needed);
  return reinterpret_cast<Number*>(memory.data());
}

}  // namespace

template <class Number>
SparseLdltOf<Number>::SparseLdltOf(const BlockColumns& pattern)
    : SparseLdltOf(std::make_shared<const FrontTree>(make_front_tree(pattern))) {}

template <class Number>
SparseLdltOf<Number>::SparseLdltOf(std::shared_ptr<const FrontTree> tree)
    : tree_(std::move(tree)), diagonal_(tree_->pattern.size()), pieces_(tree_->arena_sizes.size()) {}

template <class Number>
void SparseLdltOf<Number>::change(std::shared_ptr<const FrontTree> tree) {
  tree_ = std::move(tree);
  diagonal_.resize(tree_->pattern.size());
  pieces_ = std::vector<Piece>(tree_->arena_sizes.size());
  has_memory_ = false;
}

/// A bench for the time of a piece.
template <class Number>
class SparseLdltOf<Number>::Seat {
 public:
  Seat(SparseLdltOf& owner, std::int64_t arena_size) : owner_(owner) {
    {
      const std::lock_guard lock(owner_.benches_mutex_);
      if (!owner_.benches_.empty()) {
        bench_ = std::move(owner_.benches_.back());  // the one that was used last
        owner_.benches_.pop_back();
      }
    }
    if (!bench_) bench_ = std::make_unique<Bench>();
    bench_->arena = arena_in<Number>(bench_->memory, arena_size);
  }
  ~Seat() {
    const std::lock_guard lock(owner_.benches_mutex_);
    owner_.benches_.push_back(std::move(bench_));
  }
  Seat(const Seat&) = delete;
  Seat& operator=(const Seat&) = delete;
  [[nodiscard]] Bench& bench() { return *bench_; }

 private:
  SparseLdltOf& owner_;
  std::unique_ptr<Bench> bench_;
};

template <class Number>
void SparseLdltOf<Number>::take_memory() {
  has_memory_ = true;
  std::int64_t values = 0;
  first_value_.clear();
  for (const Front& front : tree_->fronts) {
    first_value_.push_back(values);
    values += own_values<Number>(front.size(), front.pivots());
  }
  lower_.resize(static_cast<std::size_t>(values) + front_slack);
  packs_.clear();
  first_pack_.assign(1, 0);
  for (const Front& front : tree_->fronts) {
    if (front.parent >= 0)
      add_packs(tree_->places.data() + front.first_row, front.below, tree_->fronts[front.parent].pivots(),
                run_pack_rows<Number>(), packs_);
    first_pack_.push_back(static_cast<std::int64_t>(packs_.size()));
  }
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    Index size = 0;
    for (Index f = tree_->pieces[p]; f < tree_->pieces[p + 1]; ++f) size = std::max(size, tree_->fronts[f].size());
    pieces_[p].rows.setZero(size + solve_slack, columns_together);
  }
}

template <class Number>
double SparseLdltOf<Number>::bytes() const {
  double values = static_cast<double>(lower_.size() + diagonal_.size()), own = 0;
  const auto add = [&](const Bench& bench) {
    values += static_cast<double>(bench.work.plain.size() + bench.work.scaled.size());
    own += static_cast<double>(sizeof(double) * bench.memory.size());
  };
  add(top_);
  for (const auto& bench : benches_) add(*bench);
  return own + static_cast<double>(sizeof(Number)) * values +
         4.0 * static_cast<double>(2 * tree_->rows.size() + 3 * packs_.size() + tree_->pattern.rows.size() +
                                   tree_->entry_places.size());
}

template <class Number>
FrontColumns<Number> SparseLdltOf<Number>::lower(Index front) const {
  const Front& own = tree_->fronts[front];
  return {lower_.data() + first_value_[front], front_stride<Number>(own.size()), own.size(), own.pivots()};
}

/// bench  the front's piece's
template <class Number>
FrontPlace<Number> SparseLdltOf<Number>::place_of(Index front, const Bench& bench) {
  const Front& own = tree_->fronts[front];
  Number* arena = (own.parent >= top_front() ? top_ : bench).arena;
  return {lower_.data() + first_value_[front], arena + own.offset + left_head<Number>, own.size(), own.pivots()};
}

/// What the pattern has in the columns of a front's pivots.
template <class Number>
void SparseLdltOf<Number>::assemble(Index index, const LargeVector<double>& values, Number* front, Team& team) const {
  const Front& own = tree_->fronts[index];
  const BlockColumns& pattern = tree_->pattern;
  const std::ptrdiff_t stride = front_stride<Number>(own.size());
  fraction_columns(own.pivots(), own.size(), team, [&](Index begin, Index end) {
    std::fill(front + begin * stride, front + end * stride, Number(0));  // above the diagonal, too: long runs are fast
  });
  for (Index node = own.begin_node; node < own.end_node; ++node) {
    Number* columns = front + (pattern.unknowns[node] - own.begin) * stride;
    for (Index e = pattern.starts[node]; e < pattern.starts[node + 1]; ++e)
      copy_block(values.data() + pattern.offsets[e], pattern.width(node), pattern.width(pattern.rows[e]),
                 columns + tree_->entry_places[e], stride);
  }
}

/// What the children leave in the columns of a front's pivots, or in those below them.
template <class Number>
void SparseLdltOf<Number>::add_children(Index index, bool of_pivots, const FrontPlace<Number>& front,
                                        const Bench& bench, Team& team) const {
  const Front& own = tree_->fronts[index];
  Number* to = of_pivots ? front.own : front.left;
  const Index stride = of_pivots ? front_stride<Number>(own.size()) : left_stride<Number>(own.below);
  for (Index i = tree_->first_child[index]; i >= 0; i = tree_->next_sibling[i]) {
    const Front& child = tree_->fronts[i];
    const Number* update = bench.arena + child.offset + left_head<Number>;
    const RowPack *first = packs_.data() + first_pack_[i], *last = packs_.data() + first_pack_[i + 1];
    const RowPack* below = std::partition_point(first, last, [&](const RowPack& p) { return p.to < own.pivots(); });
    const RowPack *begin = of_pivots ? first : below, *end = of_pivots ? below : last;
    const FrontSum<Number> sum{update, to, left_stride<Number>(child.below), stride, of_pivots ? 0 : own.pivots(),
                               last};
    fraction_columns(end - begin, child.below, team, [&](Index from, Index beyond) {
      for (Index k = from; k < beyond; ++k) run_add_columns(sum, begin + k);
    });
  }
}

/// Returns how many pivots are negative.
template <class Number>
Index SparseLdltOf<Number>::factor(Index index, const LargeVector<double>& values, Number least, Bench& bench,
                                   Team& team) {
  const FrontPlace<Number> front = place_of(index, bench);
  assemble(index, values, front.own, team);
  add_children(index, true, front, bench, team);
  Number* pivots = diagonal_.data() + tree_->fronts[index].begin;
  const Index negative = factor_front(front, least, pivots, bench.work, team);
  add_children(index, false, front, bench, team);
  return negative;
}

template <class Number>
Pivots SparseLdltOf<Number>::factorise(const LargeVector<double>& values, double least, Team& team,
                                       LargeVector<double>* spare) {
  if (!has_memory_) take_memory();
  top_.arena = arena_in<Number>(spare ? *spare : top_.memory, tree_->arena_sizes.back());
  const Index count = std::ssize(pieces_) - 1;
  Team alone(1);
  const auto run = [&](Index p, Bench& bench, Team& helpers) {
    pieces_[p].negative = 0;
    for (Index f = tree_->pieces[p]; f < tree_->pieces[p + 1]; ++f)
      pieces_[p].negative += factor(f, values, static_cast<Number>(least), bench, helpers);
  };
  team.each(count, [&](Index p) {
    Seat seat(*this, tree_->arena_sizes[p]);
    run(p, seat.bench(), alone);
  });
  run(count, top_, team);
  Pivots pivots;
  for (const Piece& piece : pieces_) pivots.negative += piece.negative;
  pivots.replaced = std::count(diagonal_.begin(), diagonal_.end(), static_cast<Number>(-least));
  return pivots;
}

/// `columns` columns of the solution from `begin` on, through a front. What unknowns from `top` on lose stands in the
/// piece's `above`.
template <class Number>
void SparseLdltOf<Number>::forward(Index index, Index begin, Index columns, Piece& piece, Index top) {
  const Front& front = tree_->fronts[index];
  const Index* rows = tree_->rows.data() + front.first_row;
  const Index stride = piece.rows.rows();
  for (Index c = 0; c < columns; ++c) {
    double* y = piece.rows.col(c).data();
    std::copy_n(solution_.col(begin + c).data() + front.begin, front.pivots(), y);
    std::fill_n(y + front.pivots(), front.below, 0.0);
  }
  solve_forward(lower(index), piece.rows.data(), stride, columns);
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

template <class Number>
void SparseLdltOf<Number>::backward(Index index, Index begin, Index columns, Piece& piece) {
  const Front& front = tree_->fronts[index];
  const Index* rows = tree_->rows.data() + front.first_row;
  const Index stride = piece.rows.rows();
  for (Index c = 0; c < columns; ++c) {
    const double* x = solution_.col(begin + c).data();
    double* y = piece.rows.col(c).data();
    for (Index r = 0; r < front.pivots(); ++r) y[r] = x[front.begin + r] / diagonal_[front.begin + r];
    for (Index r = 0; r < front.below; ++r) y[front.pivots() + r] = x[rows[r]];
    std::fill_n(y + front.size(), solve_slack, 0.0);
  }
  solve_backward(lower(index), piece.rows.data(), stride, columns);
  for (Index c = 0; c < columns; ++c)
    std::copy_n(piece.rows.col(c).data(), front.pivots(), solution_.col(begin + c).data() + front.begin);
}

template <class Number>
void SparseLdltOf<Number>::solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team) {
  const Index count = std::ssize(pieces_) - 1, first_top = top_front();
  const Index end = tree_->fronts.size();
  const Index top = first_top < end ? tree_->fronts[first_top].begin : size();
  solution_ = right_sides;
  const auto together = [&](const auto& visit) {
    for (Index c = 0; c < solution_.cols(); c += columns_together)
      visit(c, std::min<Index>(columns_together, static_cast<Index>(solution_.cols()) - c));
  };
  team.each(count, [&](Index p) {
    pieces_[p].above.setZero(size() - top, solution_.cols());
    for (Index f = tree_->pieces[p]; f < tree_->pieces[p + 1]; ++f)
      together([&](Index c, Index columns) { forward(f, c, columns, pieces_[p], top); });
  });
  for (Index p = 0; p < count; ++p) solution_.bottomRows(size() - top) -= pieces_[p].above;
  Piece& last = pieces_.back();
  for (Index f = first_top; f < end; ++f)
    together([&](Index c, Index columns) { forward(f, c, columns, last, size()); });
  for (Index f = end - 1; f >= first_top; --f) together([&](Index c, Index columns) { backward(f, c, columns, last); });
  team.each(count, [&](Index p) {
    for (Index f = tree_->pieces[p + 1] - 1; f >= tree_->pieces[p]; --f)
      together([&](Index c, Index columns) { backward(f, c, columns, pieces_[p]); });
  });
  right_sides = solution_;
}

template class SparseLdltOf<double>;
template class SparseLdltOf<float>;

}  // namespace softkin::linear
