#include "random/confirm_floor.hpp"

#include <limits>

namespace softkin::random_robots {

namespace {

/// A face of order 2 makes contact by four flat triangles, whose corners between stand by a third of the arc's height
/// beyond the nodes: they are 4/3 of the node less 1/6 of either end, and distribute their force to these with the same
/// weights.
constexpr double to_node = 4.0 / 3, to_end = -1.0 / 6;

}  // namespace

ConfirmedFloor::ConfirmedFloor(const Model& model, const Points& positions)
    : model_(model),
      of_surface_(model.elements.used.size()),
      near_(model.elements.used.size()),
      beside_(model.elements.used.size()) {
  double floor = 0;
  for (std::size_t t = 0; t < model.contact.triangles.size(); ++t) {
    const bool halfspace = model.contact.parts[model.contact.part_of[t]].halfspace;
    for (const Index v : model.contact.triangles[t]) {
      if (halfspace) floor = model.rest(v, 2);
      of_surface_[v] = of_surface_[v] || !halfspace;
    }
  }
  Eigen::VectorXd height = positions.col(2).array() - floor;
  for (const auto& [a, b, node] : model.contact.edges)
    height[node] = to_node * height[node] + to_end * (height[a] + height[b]);
  depth_ = -std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < near_.size(); ++v) {
    if (!of_surface_[v]) continue;
    near_[v] = height[v] < model.contact.distance_mm;
    depth_ = std::max(depth_, -height[v]);
  }
  for (const auto& [a, b, node] : model.contact.edges)
    if (near_[node]) beside_[a] = beside_[b] = true;
}

void ConfirmedFloor::push(const std::vector<bool>& of_rigid, RealPoints& sum) const {
  std::vector<Real> push(near_.size(), 0), handed(near_.size(), 0);
  std::vector<bool> between(near_.size()), unknown(near_.size());
  const auto bears = [&](Index v, Real lacking) { return near_[v] && lacking > 0 ? lacking : 0; };
  for (const auto& [a, b, node] : model_.contact.edges) {
    between[node] = true;
    const bool held = model_.held.fixed[node][2] || of_rigid[node];
    push[node] = held ? 0 : bears(node, sum(node, 2) / static_cast<Real>(to_node));
    for (const Index end : {a, b}) {
      handed[end] += static_cast<Real>(to_end) * push[node];
      unknown[end] = unknown[end] || (held && near_[node]);
    }
  }
  for (std::size_t v = 0; v < near_.size(); ++v) {
    const Index at = v;
    if (!of_surface_[v] || model_.held.fixed[v][2] || of_rigid[v]) continue;
    if (between[v])
      sum(at, 2) -= static_cast<Real>(to_node) * push[v];
    else if (unknown[v])
      sum(at, 2) = 0;
    else
      sum(at, 2) -= bears(at, sum(at, 2) - handed[v]) + handed[v];
  }
}

}  // namespace softkin::random_robots
