#include <algorithm>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/statics/supports/freedoms.hpp>

namespace softkin::supports {

namespace {

using Graph = Eigen::SparseMatrix<double>;

/// Nodes without some: those from first to end - 1, by their place among the others.
struct Others {
  Index first, end;

  [[nodiscard]] bool has(Index node) const { return node < first || node >= end; }
  [[nodiscard]] Index place(Index node) const { return node < first ? node : node - (end - first); }
  [[nodiscard]] Index node(Index place) const { return place < first ? place : place + (end - first); }
};

Graph graph_of(const Graph& graph, const Others& others) {
  std::vector<Eigen::Triplet<double>> links;
  for (Index j = 0; j < graph.cols(); ++j)
    for (Graph::InnerIterator it(graph, j); it; ++it)
      if (const Index i = it.row(); others.has(i) && others.has(j))
        links.emplace_back(others.place(i), others.place(j), 1.0);
  const Index size = graph.cols() - (others.end - others.first);
  Graph result(size, size);
  result.setFromTriplets(links.begin(), links.end());
  return result;
}

/// For every node from first to end - 1, the place of the last of the others that it is linked with; -1: none.
std::vector<Index> last_links(const Graph& graph, const Others& others, const std::vector<Index>& place) {
  std::vector<Index> last(others.end - others.first, -1);
  const auto link = [&](Index scalar, Index node) {
    if (others.has(scalar) || !others.has(node)) return;
    Index& found = last[scalar - others.first];
    found = std::max(found, place[others.place(node)]);
  };
  for (Index j = 0; j < graph.cols(); ++j)
    for (Graph::InnerIterator it(graph, j); it; ++it) {
      link(it.row(), j);
      link(j, it.row());
    }
  return last;
}

}  // namespace

/// An order of elimination. A scalar comes right after its corner and the nodes on all edges that end there: its pivot
/// then is not small, as the moves along edges that are eliminated before it respond to every difference of pressures
/// (which is why Taylor-Hood elements are stable). Of linear elements, whose pressures are smoothed, it comes right
/// after its corner. Where the corner has no unknowns, it comes after all vertices with which it couples.
linear::Ordering Freedoms::ordering_of(const Model& model, const Graph& graph) const {
  const bool quadratic = !model.elements.edge_nodes.empty();
  if (scalars_.empty())
    return quadratic ? linear::nested_dissection(graph, ends_of(model)) : linear::nested_dissection(graph);
  const Index count = scalars_.size();
  const Index end = graph.cols() - std::ssize(regions_);
  const Others others{end - count, end};
  const Graph links = graph_of(graph, others);
  linear::Ordering ordering;
  if (quadratic) {
    const std::vector<std::array<Index, 2>> of_all = ends_of(model);
    std::vector<std::array<Index, 2>> ends(links.cols(), {-1, -1});
    for (Index node = 0; node < std::ssize(of_all); ++node)
      for (std::size_t i = 0; others.has(node) && i < 2; ++i)
        if (const Index at = of_all[node][i]; at >= 0) ends[others.place(node)][i] = others.place(at);
    ordering = linear::nested_dissection(links, ends);
  } else {
    ordering = linear::nested_dissection(links);
  }
  std::vector<Index> place(ordering.order.size());
  for (std::size_t k = 0; k < place.size(); ++k) place[ordering.order[k]] = k;

  std::vector<Index> behind_edges(rest_.rows(), -1);  // by corner
  const auto own_place = [&](Index vertex) {
    const Index node = node_of_[vertex];
    return node < 0 || region_of_[vertex] >= 0 ? -1 : place[others.place(node)];
  };
  for (std::size_t t = 0; t < model.elements.edge_nodes.size(); ++t)
    for (std::size_t e = 0; e < 6; ++e)
      for (const int i : tetrahedron_edges[e]) {
        Index& last = behind_edges[model.elements.tetrahedra[t][i]];
        last = std::max(last, own_place(model.elements.edge_nodes[t][e]));
      }
  const std::vector<Index> behind_all = last_links(graph, others, place);
  std::vector<std::vector<Index>> behind(place.size() + 1);  // what stands behind each place, from -1 on
  for (std::size_t s = 0; s < scalars_.size(); ++s) {
    const Index corner = scalars_[s], edges = behind_edges[corner], own = own_place(corner);
    const bool answered = own >= 0 && (edges >= 0 || !quadratic);
    const Index last = answered ? std::max(edges, own) : behind_all[s];
    behind[last + 1].push_back(others.first + static_cast<Index>(s));
  }
  std::vector<Index> order = behind[0];
  for (std::size_t k = 0; k < place.size(); ++k) {
    order.push_back(others.node(ordering.order[k]));
    order.insert(order.end(), behind[k + 1].begin(), behind[k + 1].end());
  }
  return linear::postordered(graph, order);
}

}  // namespace softkin::supports
