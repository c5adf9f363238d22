#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/core/memory.hpp>
#include <softkin/linear/front_kernel.hpp>
#include <softkin/linear/front_tree.hpp>

namespace softkin::linear {

namespace {

/// Columns of nodes [begin, end) and the nodes below them.
struct Group {
  Index begin, end;
  std::vector<Index> below;
  Index parent = -1;  // group
  double zeros = 0;   // entries stored in vain
  Index joined = -1;  // group that took it in
};

class Symbolic {
 public:
  Symbolic(const BlockColumns& pattern, Fill fill) : pattern_(pattern), fill_(fill), mark_(pattern.nodes(), -1) {
    find_groups();
    amalgamate();
  }

  [[nodiscard]] std::vector<Group> groups() && {
    std::vector<Group> kept;
    for (Group& group : groups_)
      if (group.joined < 0) kept.push_back(std::move(group));
    return kept;
  }

 private:
  [[nodiscard]] double unknowns(Index begin, Index end) const {
    return pattern_.unknowns[end] - pattern_.unknowns[begin];
  }
  [[nodiscard]] double unknowns(const std::vector<Index>& nodes) const {
    double count = 0;
    for (const Index node : nodes) count += pattern_.width(node);
    return count;
  }

  [[nodiscard]] bool begins_piece(Index node) const {
    return std::binary_search(pattern_.pieces.begin(), pattern_.pieces.end(), node);
  }

  /// Rows of column j below its diagonal: its own entries and what its children leave.
  std::vector<Index> column(Index j, const std::vector<Index>& children) {
    std::vector<Index> rows;
    const auto add = [&](Index node) {
      if (node <= j || mark_[node] == j) return;
      mark_[node] = j;
      rows.push_back(node);
    };
    // the longest of the sorted lists is most of the rows
    const auto longest = std::max_element(children.begin(), children.end(), [&](Index a, Index b) {
      return groups_[a].below.size() < groups_[b].below.size();
    });
    if (longest != children.end())
      for (const Index node : groups_[*longest].below) add(node);
    const std::ptrdiff_t sorted = rows.size();
    for (Index e = pattern_.starts[j]; e < pattern_.starts[j + 1]; ++e) add(pattern_.rows[e]);
    for (const Index child : children)
      for (const Index node : groups_[child].below) add(node);
    std::sort(rows.begin() + sorted, rows.end());
    std::inplace_merge(rows.begin(), rows.begin() + sorted, rows.end());
    return rows;
  }

  /// Maximal runs of columns of the same structure.
  void find_groups() {
    std::vector<std::vector<Index>> waiting(pattern_.nodes());  // groups whose first row below is the node
    for (Index j = 0; j < pattern_.nodes(); ++j) {
      std::vector<Index> rows = column(j, waiting[j]);
      Group* last = groups_.empty() ? nullptr : &groups_.back();
      const bool joins = last && !last->below.empty() && last->below.front() == j &&
                         last->below.size() == rows.size() + 1 && !begins_piece(j);
      if (joins) {
        last->end = j + 1;
        // it waited for j, and now waits for its new first row
        for (const Index child : waiting[j])
          if (child != std::ssize(groups_) - 1) groups_[child].parent = std::ssize(groups_) - 1;
        last->below = std::move(rows);
      } else {
        for (const Index child : waiting[j]) groups_[child].parent = groups_.size();
        groups_.push_back({j, j + 1, std::move(rows)});
      }
      const Index current = std::ssize(groups_) - 1;
      if (!groups_[current].below.empty()) waiting[groups_[current].below.front()].push_back(current);
      waiting[j] = {};
    }
  }

  /// Joins a group to the one right before it, its child, where that stores few zeros.
  void amalgamate() {
    std::vector<Index> stack;  // groups that are kept so far
    for (Index g = 0; g < std::ssize(groups_); ++g) {
      while (!stack.empty() && parent_of(stack.back()) == g && groups_[stack.back()].end == groups_[g].begin &&
             !begins_piece(groups_[g].begin) && worthwhile(groups_[stack.back()], groups_[g])) {
        const Index child = stack.back();
        stack.pop_back();
        groups_[g].begin = groups_[child].begin;
        groups_[g].zeros = zeros_together_;
        groups_[child].joined = g;
      }
      stack.push_back(g);
    }
  }

  [[nodiscard]] Index parent_of(Index group) const {
    Index parent = groups_[group].parent;
    while (parent >= 0 && groups_[parent].joined >= 0) parent = groups_[parent].joined;
    return parent;
  }

  bool worthwhile(const Group& child, const Group& parent) {
    const double narrow = unknowns(child.begin, child.end), wide = unknowns(parent.begin, parent.end);
    const double below = unknowns(parent.below), width = narrow + wide;
    const double missing = wide + below - unknowns(child.below);
    zeros_together_ = child.zeros + parent.zeros + narrow * missing;
    const double fraction = zeros_together_ / (width * (0.5 * width + below));
    if (fill_ == Fill::for_solves) return zeros_together_ <= 8 || fraction < 0.1;
    return width <= 16 || (width <= 48 && fraction < 0.4) || (width <= 144 && fraction < 0.12) || fraction < 0.05;
  }

  const BlockColumns& pattern_;
  Fill fill_;
  std::vector<Group> groups_;
  std::vector<Index> mark_;
  double zeros_together_ = 0;
};

/// Where fronts wait for their parents: first fit into what is free.
class Arena {
 public:
  std::int64_t take(std::int64_t size) {
    for (auto gap = free_.begin(); gap != free_.end(); ++gap)
      if (gap->second - gap->first >= size) {
        const std::int64_t at = gap->first;
        gap->first += size;
        if (gap->first == gap->second) free_.erase(gap);
        return at;
      }
    if (!free_.empty() && free_.back().second == size_) {  // the last gap grows
      const std::int64_t at = free_.back().first;
      free_.pop_back();
      size_ = at + size;
      return at;
    }
    size_ += size;
    return size_ - size;
  }

  void give(std::int64_t at, std::int64_t size) {
    if (size == 0) return;
    auto next = std::lower_bound(free_.begin(), free_.end(), std::pair{at, at + size});
    next = free_.insert(next, {at, at + size});
    if (next + 1 != free_.end() && next->second == (next + 1)->first) {
      next->second = (next + 1)->second;
      free_.erase(next + 1);
    }
    if (next != free_.begin() && (next - 1)->second == next->first) {
      (next - 1)->second = next->second;
      free_.erase(next);
    }
  }

  [[nodiscard]] std::int64_t size() const { return size_; }

 private:
  std::vector<std::pair<std::int64_t, std::int64_t>> free_;
  std::int64_t size_ = 0;
};

/// Of what a front leaves, in values of either precision.
std::int64_t values_left_by(const Front& front) {
  static_assert(left_stride<float>(1) >= left_stride<double>(1));
  return static_cast<std::int64_t>(left_stride<float>(front.below)) * front.below;
}

/// Offsets of what fronts leave. Those of a piece's roots, which outlive the piece, stand in the top's arena.
void plan_arenas(FrontTree& tree) {
  const Index pieces = std::ssize(tree.pieces) - 2;
  const Index top = tree.pieces[pieces];
  Arena above;
  for (Index p = 0; p <= pieces; ++p) {
    Arena own;
    Arena& inside = p < pieces ? own : above;
    for (Index f = tree.pieces[p]; f < tree.pieces[p + 1]; ++f) {
      Front& front = tree.fronts[f];
      Arena& arena = front.parent >= top ? above : inside;
      front.offset = arena.take(values_left_by(front));
      for (Index c = tree.first_child[f]; c >= 0; c = tree.next_sibling[c])
        inside.give(tree.fronts[c].offset, values_left_by(tree.fronts[c]));
    }
    if (p < pieces) tree.arena_sizes.push_back(own.size());
  }
  tree.arena_sizes.push_back(above.size());
}

void place_rows(const BlockColumns& pattern, FrontTree& tree) {
  tree.entry_places.resize(pattern.rows.size());
  std::vector<Index> place(pattern.size());
  const auto place_in = [&](const Front& front) {
    for (Index u = front.begin; u < front.end; ++u) place[u] = u - front.begin;
    for (Index r = 0; r < front.below; ++r) place[tree.rows[front.first_row + r]] = front.pivots() + r;
  };
  tree.places.resize(tree.rows.size());
  for (const Front& front : tree.fronts) {
    if (front.parent >= 0) place_in(tree.fronts[front.parent]);
    for (std::int64_t r = front.first_row; r < front.first_row + front.below; ++r) tree.places[r] = place[tree.rows[r]];
    place_in(front);
    for (Index e = pattern.starts[front.begin_node]; e < pattern.starts[front.end_node]; ++e)
      tree.entry_places[e] = place[pattern.unknowns[pattern.rows[e]]];
  }
}

}  // namespace

FrontTree make_front_tree(BlockColumns columns, Fill fill) {
  FrontTree tree;
  tree.pattern = std::move(columns);
  const BlockColumns& pattern = tree.pattern;
  const std::vector<Group> groups = Symbolic(pattern, fill).groups();
  std::vector<Index> front_of(pattern.nodes());
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (Index node = groups[g].begin; node < groups[g].end; ++node) front_of[node] = g;
  tree.first_child.assign(groups.size(), -1);
  tree.next_sibling.assign(groups.size(), -1);
  for (const Group& group : groups) {
    Front front;
    front.begin_node = group.begin;
    front.end_node = group.end;
    front.begin = pattern.unknowns[group.begin];
    front.end = pattern.unknowns[group.end];
    front.first_row = static_cast<std::int64_t>(tree.rows.size());
    for (const Index node : group.below)
      for (Index u = pattern.unknowns[node]; u < pattern.unknowns[node + 1]; ++u) tree.rows.push_back(u);
    front.below = static_cast<std::int64_t>(tree.rows.size()) - front.first_row;
    if (!group.below.empty()) front.parent = front_of[group.below.front()];
    tree.values += static_cast<std::int64_t>(front.size()) * front.pivots();
    for (Index c = 0; c < front.pivots(); ++c) {
      const double height = front.size() - c;
      tree.flops += height * height;
    }
    tree.fronts.push_back(front);
  }
  for (Index f = std::ssize(tree.fronts) - 1; f >= 0; --f)
    if (const Index parent = tree.fronts[f].parent; parent >= 0) {
      tree.next_sibling[f] = tree.first_child[parent];
      tree.first_child[parent] = f;
    }
  for (const Index node : pattern.pieces)
    tree.pieces.push_back(node < pattern.nodes() ? front_of[node] : static_cast<Index>(groups.size()));
  tree.pieces.push_back(groups.size());
  plan_arenas(tree);
  place_rows(pattern, tree);
  return tree;
}

void require_memory(const FrontTree& tree, std::size_t value_bytes) {
  double values = 0;
  for (const Front& front : tree.fronts)
    values += static_cast<double>(own_values<double>(front.size(), front.pivots()));
  for (const std::int64_t arena : tree.arena_sizes) values += static_cast<double>(arena);
  const double needed = values * static_cast<double>(value_bytes), there = free_memory_bytes();
  if (needed > there)
    throw InvalidInput("the factor of a robot with " + std::to_string(tree.pattern.size()) + " unknowns takes " +
                       memory_text(needed) + " of memory, and " + memory_text(there) +
                       " are free: take a coarser mesh, or order 1");
}

}  // namespace softkin::linear
