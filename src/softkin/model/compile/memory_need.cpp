#include <algorithm>
#include <cmath>
#include <softkin/core/memory.hpp>
#include <softkin/model/compile/memory_need.hpp>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

/// The mesh cut into halves, and what their separators cost.
class Dissection {
 public:
  Dissection(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra,
             const std::vector<EdgeNodes>& edge_nodes, const std::vector<Prism>& prisms)
      : eliminated_(vertices.rows(), 0), mark_(vertices.rows(), 0) {
    for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
      Element element = add(vertices, tetrahedra[t]);
      if (!edge_nodes.empty())
        element.end = nodes_.insert(nodes_.end(), edge_nodes[t].begin(), edge_nodes[t].end()) + 6 - nodes_.begin();
      elements_.push_back(element);
    }
    for (const Prism& prism : prisms) elements_.push_back(add(vertices, prism));
  }

  MemoryNeed need() {
    MemoryNeed need;
    need.unknowns = 3 * counts(0, elements_.size()).own;
    const double waiting = dissect(0, elements_.size()).peak;
    need.values = factor_ + waiting;
    return need;
  }

 private:
  struct Element {
    std::size_t begin = 0, end = 0;  // of its nodes
    Vec3 centroid = Vec3::Zero();
  };
  struct Counts {
    double own = 0, boundary = 0;  // vertices: still to be eliminated; of separators around it
  };
  struct Cost {
    double left = 0, peak = 0;  // numbers that wait for its parent; the most that wait while it is eliminated
  };
  static constexpr double leaf = 40;  // vertices: fronts of fewer are joined

  template <class Corners>
  Element add(const Points& vertices, const Corners& corners) {
    Element element{nodes_.size(), nodes_.size() + corners.size()};
    for (const Index v : corners) {
      nodes_.push_back(v);
      element.centroid += vertex_at(vertices, v) / static_cast<double>(corners.size());
    }
    return element;
  }

  template <class Visit>
  void each_node(std::size_t begin, std::size_t end, const Visit& visit) const {
    for (std::size_t e = begin; e < end; ++e)
      for (std::size_t i = elements_[e].begin; i < elements_[e].end; ++i) visit(nodes_[i]);
  }

  Counts counts(std::size_t begin, std::size_t end) {
    Counts found;
    ++stamp_;
    each_node(begin, end, [&](Index v) {
      if (mark_[v] == stamp_) return;
      mark_[v] = stamp_;
      (eliminated_[v] ? found.boundary : found.own) += 1;
    });
    return found;
  }

  std::size_t halve(std::size_t begin, std::size_t end) {
    Bounds bounds;
    for (std::size_t e = begin; e < end; ++e) bounds.extend(elements_[e].centroid);
    Index axis = 0;
    bounds.sizes().maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t e) { return elements_.begin() + static_cast<std::ptrdiff_t>(e); };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Element& a, const Element& b) { return a.centroid[axis] < b.centroid[axis]; });
    return middle;
  }

  /// Vertices that both halves have are eliminated after them. Returns how many.
  double separate(std::size_t begin, std::size_t middle, std::size_t end) {
    ++stamp_;
    each_node(begin, middle, [&](Index v) { mark_[v] = stamp_; });
    double count = 0;
    each_node(middle, end, [&](Index v) {
      if (mark_[v] != stamp_ || eliminated_[v]) return;
      eliminated_[v] = 1;
      ++count;
    });
    return count;
  }

  Cost front(double pivots, double boundary) {
    factor_ += 3 * pivots * (3 * pivots + 3 * boundary);
    const double left = 9 * boundary * boundary;
    return {left, left};
  }

  Cost dissect(std::size_t begin, std::size_t end) {
    const Counts all = counts(begin, end);
    if (all.own <= leaf || end - begin < 2) return front(all.own, all.boundary);
    const std::size_t middle = halve(begin, end);
    const double pivots = separate(begin, middle, end);
    const Cost first = dissect(begin, middle), second = dissect(middle, end);
    Cost cost = front(pivots, all.boundary);
    cost.peak = std::max({first.peak, first.left + second.peak, first.left + second.left + cost.left});
    return cost;
  }

  std::vector<Index> nodes_;
  std::vector<Element> elements_;
  std::vector<char> eliminated_;
  std::vector<Index> mark_;
  Index stamp_ = 0;
  double factor_ = 0;  // its numbers so far
};

}  // namespace

MemoryNeed memory_need(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra,
                       const std::vector<EdgeNodes>& edge_nodes, const std::vector<Prism>& prisms) {
  return Dissection(vertices, tetrahedra, edge_nodes, prisms).need();
}

void refuse_too_large(const Compilation& c) {
  // Below this not even a cube takes a GiB, and the exact number is known soon enough.
  constexpr double small = 150'000;  // unknowns
  // Times too much: what may fit is left to the exact number, which is 1.37 times the estimate for a cube of order 2.
  constexpr double sure = 1.5;
  if (c.model.formulation != Formulation::physical || 3 * c.mesh.vertices.rows() < small) return;
  check_cells(c.mesh, c.origin);
  const MemoryNeed need = memory_need(c.mesh.vertices, c.mesh.tetrahedra, c.mesh.edge_nodes, c.mesh.prisms);
  const double bytes = sizeof(float) * need.values, free = free_memory_bytes();
  if (bytes <= sure * free) return;
  const std::size_t elements = c.mesh.tetrahedra.size() + c.mesh.prisms.size();
  const std::string order = c.mesh.edge_nodes.empty() ? "1" : "2";
  throw InvalidInput(c.spec.mesh_options.origin.file.empty() ? c.origin : c.spec.mesh_options.origin,
                     "a robot of " + std::to_string(elements) + " elements of order " + order + ", " +
                         number(need.unknowns, 3) + " unknowns, takes about " + memory_text(bytes) +
                         " of memory, and " + memory_text(free) + " are free: take a coarser mesh" +
                         (order == "2" ? ", or order 1" : ""));
}

}  // namespace softkin
