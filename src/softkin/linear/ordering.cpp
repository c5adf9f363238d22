#include <metis.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <softkin/linear/ordering.hpp>
#include <stdexcept>

namespace softkin::linear {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

struct Graph {
  std::vector<idx_t> starts, neighbours;  // both directions, no loops
};

Graph graph_of(const Matrix& matrix) {
  Graph graph;
  graph.starts.assign(static_cast<std::size_t>(matrix.cols()) + 1, 0);
  const auto each_edge = [&](const auto& visit) {
    for (Index j = 0; j < matrix.cols(); ++j)
      for (Matrix::InnerIterator it(matrix, j); it; ++it)
        if (it.row() > j) visit(it.row(), j);
  };
  each_edge([&](Index i, Index j) { ++graph.starts[i + 1], ++graph.starts[j + 1]; });
  std::partial_sum(graph.starts.begin(), graph.starts.end(), graph.starts.begin());
  graph.neighbours.resize(graph.starts.back());
  std::vector<idx_t> next(graph.starts.begin(), graph.starts.end() - 1);
  each_edge([&](Index i, Index j) { graph.neighbours[next[i]++] = j, graph.neighbours[next[j]++] = i; });
  return graph;
}

std::vector<Index> dissect(Graph& graph) {
  idx_t count = static_cast<idx_t>(graph.starts.size()) - 1;
  std::vector<idx_t> order(count), place(count);
  std::iota(order.begin(), order.end(), 0);
  // METIS draws from rand() after srand(): two at once would each get a part of one sequence, and another order
  static std::mutex one;
  const std::lock_guard lock(one);
  // up to a seventh less to multiply than METIS' own choice leaves of slender robots
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_UFACTOR] = 400;
  options[METIS_OPTION_NSEPS] = 2;
  if (!graph.neighbours.empty() && METIS_NodeND(&count, graph.starts.data(), graph.neighbours.data(), nullptr, options,
                                                order.data(), place.data()) != METIS_OK)
    throw std::runtime_error("METIS could not order the matrix");
  return {order.begin(), order.end()};
}

/// What is not in the middle of an edge, of a matrix.
struct Corners {
  std::vector<Index> nodes, place;  // of the matrix; in `nodes`, -1: in the middle
  Matrix links;

  Corners(const Matrix& matrix, const std::vector<std::array<Index, 2>>& ends) : place(ends.size(), -1) {
    for (Index node = 0; node < std::ssize(ends); ++node) {
      if (ends[node][0] >= 0 || ends[node][1] >= 0) continue;
      place[node] = nodes.size();
      nodes.push_back(node);
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < matrix.cols(); ++j)
      for (Matrix::InnerIterator it(matrix, j); it; ++it)
        if (const Index a = place[it.row()], b = place[j]; a >= 0 && b >= 0)
          entries.emplace_back(std::max(a, b), std::min(a, b), 1.0);
    links.resize(nodes.size(), nodes.size());
    links.setFromTriplets(entries.begin(), entries.end());
  }
};

/// Nodes in the middle of an edge right before that end which is eliminated first: what separates the corners then
/// separates all.
///
/// order  of the corners
std::vector<Index> with_middles(const Corners& corners, const std::vector<Index>& order,
                                const std::vector<std::array<Index, 2>>& ends) {
  std::vector<Index> when(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) when[order[k]] = k;
  std::vector<std::vector<Index>> middles(order.size());
  for (Index node = 0; node < std::ssize(ends); ++node) {
    if (corners.place[node] >= 0) continue;
    Index first = order.size();
    for (const Index end : ends[node])
      if (end >= 0) first = std::min(first, when[corners.place[end]]);
    middles[first].push_back(node);
  }
  std::vector<Index> all;
  for (std::size_t k = 0; k < order.size(); ++k) {
    all.insert(all.end(), middles[k].begin(), middles[k].end());
    all.push_back(corners.nodes[order[k]]);
  }
  return all;
}

/// Parent of every column in the elimination tree, -1 at roots (Liu's algorithm with path compression).
std::vector<Index> elimination_tree(const Graph& graph, const std::vector<Index>& order) {
  const Index count = order.size();
  std::vector<Index> place(count), parent(count, -1), ancestor(count, -1);
  for (Index k = 0; k < count; ++k) place[order[k]] = k;
  for (Index k = 0; k < count; ++k)
    for (idx_t e = graph.starts[order[k]]; e < graph.starts[order[k] + 1]; ++e) {
      for (Index i = place[graph.neighbours[e]]; i != -1 && i < k;) {
        const Index next = ancestor[i];
        ancestor[i] = k;
        if (next == -1) parent[i] = k;
        i = next;
      }
    }
  return parent;
}

/// Entries of every column of L: walks each row's subtree, O(|L|).
std::vector<std::int64_t> column_counts(const Graph& graph, const std::vector<Index>& order,
                                        const std::vector<Index>& parent) {
  const Index count = order.size();
  std::vector<Index> place(count), mark(count, -1);
  std::vector<std::int64_t> counts(count, 1);
  for (Index k = 0; k < count; ++k) place[order[k]] = k;
  for (Index k = 0; k < count; ++k) {
    mark[k] = k;
    for (idx_t e = graph.starts[order[k]]; e < graph.starts[order[k] + 1]; ++e)
      for (Index i = place[graph.neighbours[e]]; i < k && mark[i] != k; i = parent[i]) {
        mark[i] = k;
        ++counts[i];
      }
  }
  return counts;
}

/// Operations of the elimination, over a constant.
double work_of(const Graph& graph, const std::vector<Index>& order) {
  double work = 0;
  for (const std::int64_t count : column_counts(graph, order, elimination_tree(graph, order)))
    work += static_cast<double>(count) * static_cast<double>(count);
  return work;
}

struct Tree {
  std::vector<Index> roots;
  std::vector<std::vector<Index>> children;
  std::vector<std::int64_t> weight;  // of the whole subtree
};

Tree tree_of(const std::vector<Index>& parent, std::vector<std::int64_t> counts) {
  Tree tree;
  tree.children.resize(parent.size());
  tree.weight = std::move(counts);
  for (Index i = 0; i < std::ssize(parent); ++i) {
    if (parent[i] == -1) {
      tree.roots.push_back(i);
    } else {
      tree.children[parent[i]].push_back(i);
      tree.weight[parent[i]] += tree.weight[i];  // children come before their parent
    }
  }
  return tree;
}

void append_postorder(const Tree& tree, Index root, std::vector<Index>& out) {
  std::vector<std::pair<Index, std::size_t>> stack{{root, 0}};
  while (!stack.empty()) {
    auto& [node, next] = stack.back();
    if (next < tree.children[node].size()) {
      const Index child = tree.children[node][next++];
      stack.emplace_back(child, 0);
    } else {
      out.push_back(node);
      stack.pop_back();
    }
  }
}

/// Opens the heaviest subtree until none holds more than an eighth of the work; what is opened joins the top.
void cut(const Tree& tree, std::vector<Index>& subtrees, std::vector<Index>& top) {
  const auto lighter = [&](Index a, Index b) { return tree.weight[a] < tree.weight[b]; };
  std::int64_t total = 0;
  for (const Index root : tree.roots) total += tree.weight[root];
  subtrees = tree.roots;
  std::make_heap(subtrees.begin(), subtrees.end(), lighter);
  while (!subtrees.empty() && tree.weight[subtrees.front()] > total / 8 && !tree.children[subtrees.front()].empty()) {
    std::pop_heap(subtrees.begin(), subtrees.end(), lighter);
    const Index opened = subtrees.back();
    subtrees.pop_back();
    top.push_back(opened);
    for (const Index child : tree.children[opened]) {
      subtrees.push_back(child);
      std::push_heap(subtrees.begin(), subtrees.end(), lighter);
    }
  }
  std::sort(top.begin(), top.end());
  std::sort(subtrees.begin(), subtrees.end(),
            [&](Index a, Index b) { return lighter(b, a) || (!lighter(a, b) && a < b); });
}

Ordering postordered(const Graph& graph, const std::vector<Index>& order) {
  const std::vector<Index> parent = elimination_tree(graph, order);
  const Tree tree = tree_of(parent, column_counts(graph, order, parent));
  std::vector<Index> subtrees, top, places;
  cut(tree, subtrees, top);

  constexpr std::size_t max_pieces = 16;  // the last piece takes the remaining light subtrees
  Ordering result;
  result.pieces.push_back(0);
  for (std::size_t i = 0; i < subtrees.size(); ++i) {
    append_postorder(tree, subtrees[i], places);
    if (i + 1 < max_pieces || i + 1 == subtrees.size()) result.pieces.push_back(places.size());
  }
  places.insert(places.end(), top.begin(), top.end());
  for (const Index place : places) result.order.push_back(order[place]);
  return result;
}

}  // namespace

Ordering nested_dissection(const Matrix& matrix) {
  Graph graph = graph_of(matrix);
  const std::vector<Index> order = dissect(graph);
  return postordered(graph, order);
}

Ordering nested_dissection(const Matrix& matrix, const std::vector<std::array<Index, 2>>& ends) {
  Graph graph = graph_of(matrix);
  const Corners corners(matrix, ends);
  Graph links = graph_of(corners.links);
  const std::vector<Index> alike = dissect(graph), by_corners = with_middles(corners, dissect(links), ends);
  return postordered(graph, work_of(graph, by_corners) < work_of(graph, alike) ? by_corners : alike);
}

Ordering postordered(const Matrix& matrix, const std::vector<Index>& order) {
  return postordered(graph_of(matrix), order);
}

}  // namespace softkin::linear
