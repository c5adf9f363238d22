#include <algorithm>
#include <softkin/statics/physical/contact_points.hpp>

namespace softkin::physical {

namespace {

constexpr double node_fraction = 4.0 / 3, end_fraction = -1.0 / 6;

}  // namespace

ContactPoints::ContactPoints(const Model& model) : edges_(model.contact.edges) {
  if (are_nodes()) return;
  edge_of_.assign(model.rest.rows(), -1);
  for (std::size_t e = 0; e < edges_.size(); ++e) edge_of_[edges_[e][2]] = e;
}

const Points& ContactPoints::of(const Points& nodes, Points& room) const {
  if (are_nodes()) return nodes;
  room = nodes;
  // as a change, which is 0 in the middle of a straight edge
  for (const auto& [a, b, node] : edges_)
    room.row(node) += 2 * end_fraction * (0.5 * (nodes.row(a) + nodes.row(b)) - nodes.row(node));
  return room;
}

Points ContactPoints::in(const Model& model, const Points& nodes) {
  Points room;
  return ContactPoints(model).of(nodes, room);
}

void ContactPoints::add_forces(Points& on_points, Points& on_nodes) const {
  for (const auto& [a, b, node] : edges_) {
    on_points.row(a) += end_fraction * on_points.row(node);
    on_points.row(b) += end_fraction * on_points.row(node);
    on_points.row(node) *= node_fraction;
  }
  on_nodes += on_points;
}

ContactPoints::Carriers ContactPoints::carriers(const contact::Nodes& points) const {
  Carriers out;
  const auto add = [&](int point, Index node, double fraction) {
    const auto end = out.nodes.begin() + out.count, found = std::find(out.nodes.begin(), end, node);
    const auto k = found - out.nodes.begin();
    if (found == end) out.nodes[out.count++] = node;
    out.fractions(point, k) += fraction;
  };
  for (int i = 0; i < 4; ++i) {
    const Index node = points[i];
    const Index edge = are_nodes() ? -1 : edge_of_[node];
    add(i, node, edge < 0 ? 1 : node_fraction);
    for (int end = 0; edge >= 0 && end < 2; ++end) add(i, edges_[edge][end], end_fraction);
  }
  return out;
}

}  // namespace softkin::physical
