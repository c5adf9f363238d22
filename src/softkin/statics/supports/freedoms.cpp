#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/statics/supports/freedoms.hpp>
#include <softkin/statics/supports/reduced_matrix.hpp>

namespace softkin::supports {

Freedoms::Freedoms(const Model& model, const linear::BlockPattern& pattern, std::vector<Index> scalars)
    : rest_(model.rest),
      held_(model.held.at),
      fixed_(model.held.fixed),
      scalars_(std::move(scalars)),
      region_of_(model.rest.rows(), -1) {
  find_regions(model);
  number(model, pattern);
}

Freedoms::Freedoms(const Freedoms& like, const Model& model) : Freedoms(like) {
  held_ = model.held.at;
  std::vector<std::array<bool, 3>> fixed = model.held.fixed;
  std::vector<RigidBody> bodies = movable_bodies(model, fixed, held_);
  for (std::size_t i = 0; i < bodies.size(); ++i) static_cast<RigidBody&>(regions_[i]) = std::move(bodies[i]);
}

void Freedoms::find_regions(const Model& model) {
  for (RigidBody& body : movable_bodies(model, fixed_, held_)) {
    Region region{std::move(body), {}, {}};
    region.reach = region.offsets.rowwise().norm().maxCoeff();
    for (int axis = 0; axis < 3; ++axis) {
      if (region.slides[axis]) region.slide_axes.push_back(axis);
      if (region.turns[axis]) region.turn_axes.push_back(axis);
    }
    for (const Index v : region.vertices) {
      region_of_[v] = regions_.size();
      fixed_[v] = {true, true, true};  // no unknowns of its own
    }
    regions_.push_back(std::move(region));
  }
}

/// Per node, those of the ends of the edge that it stands in the middle of; -1: none.
std::vector<std::array<Index, 2>> Freedoms::ends_of(const Model& model) const {
  const Index count = 1 + *std::max_element(node_of_.begin(), node_of_.end());
  std::vector<std::array<Index, 2>> ends(count, {-1, -1});
  for (std::size_t t = 0; t < model.elements.edge_nodes.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const Index middle = model.elements.edge_nodes[t][e];
      if (node_of_[middle] < 0 || region_of_[middle] >= 0) continue;
      for (int i = 0; i < 2; ++i)
        ends[node_of_[middle]][i] = node_of_[model.elements.tetrahedra[t][tetrahedron_edges[e][i]]];
    }
  return ends;
}

void Freedoms::number(const Model& model, const linear::BlockPattern& pattern) {
  node_of_.assign(rest_.rows(), -1);
  std::vector<Index> vertex_of;
  for (Index v = 0; v < rest_.rows(); ++v)
    if (fixed_[v] != std::array<bool, 3>{true, true, true}) {
      node_of_[v] = vertex_of.size();
      vertex_of.push_back(v);
    }
  const Index vertex_nodes = vertex_of.size();
  const Index count = vertex_nodes + std::ssize(regions_);
  for (Index v = 0; v < rest_.rows(); ++v)
    if (region_of_[v] >= 0) node_of_[v] = vertex_nodes + region_of_[v];
  const Eigen::SparseMatrix<double> graph = node_graph(pattern, node_of_, count);
  const linear::Ordering ordering = ordering_of(model, graph);
  pieces_ = ordering.pieces;

  std::vector<Index> place(count);
  for (Index k = 0; k < count; ++k) place[ordering.order[k]] = k;
  for (Index& node : node_of_)
    if (node >= 0) node = place[node];
  first_unknown_.assign(rest_.rows(), -1);
  for (Index k = 0; k < count; ++k) {
    const Index node = ordering.order[k], first = unknowns_.back();
    Index width = 0;
    if (node < vertex_nodes) {
      const Index v = vertex_of[node];
      vertex_of_.push_back(v);
      first_unknown_[v] = first;
      for (int axis = 0; axis < 3; ++axis) width += !fixed_[v][axis];
      if (is_scalar(v)) scalar_unknowns_.push_back(first);
    } else {
      Region& region = regions_[node - vertex_nodes];
      vertex_of_.push_back(-1);
      region.node = k;
      width = region.slide_axes.size() + region.turn_axes.size();
    }
    unknowns_.push_back(first + width);
  }
}

std::vector<Index> Freedoms::vertex_order() const {
  std::vector<Index> order;
  for (const Index v : vertex_of_)
    if (v >= 0) order.push_back(v);
  return order;
}

std::vector<Vec3> Freedoms::centers(const Points& positions) const {
  std::vector<Vec3> all;
  for (const Region& region : regions_) all.push_back(center_of(region, positions));
  return all;
}

/// Rows of T of a vertex, over the unknowns of its node.
Eigen::Matrix<double, 3, Eigen::Dynamic> Freedoms::tangent(Index vertex, const std::vector<Vec3>& centers,
                                                           const Points& positions) const {
  if (const Index r = region_of_[vertex]; r >= 0) {
    const Region& region = regions_[r];
    Eigen::Matrix<double, 3, Eigen::Dynamic> t(3, width(region.node));
    Index column = 0;
    for (const int axis : region.slide_axes) t.col(column++) = Vec3::Unit(axis);
    const Vec3 arm = (positions.row(vertex).transpose() - centers[r]) / region.reach;
    for (const int axis : region.turn_axes) t.col(column++) = Vec3::Unit(axis).cross(arm);
    return t;
  }
  Index free = 0;
  for (int axis = 0; axis < 3; ++axis) free += !fixed_[vertex][axis];
  Eigen::Matrix<double, 3, Eigen::Dynamic> t = Eigen::MatrixXd::Zero(3, free);
  Index column = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (!fixed_[vertex][axis]) t(axis, column++) = 1;
  return t;
}

void Freedoms::reduce(const Points& vectors, const Points& positions, Eigen::Ref<Eigen::VectorXd> out) const {
  for (Index v = 0; v < rest_.rows(); ++v) {
    Index u = first_unknown_[v];
    if (u < 0) continue;
    for (int axis = 0; axis < 3; ++axis)
      if (!fixed_[v][axis]) out[u++] = vectors(v, axis);
  }
  for (const Region& region : regions_) {
    const Vec3 middle = center_of(region, positions);
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (const Index v : region.vertices) {
      const Vec3 vector = vectors.row(v).transpose();
      force += vector;
      torque += (positions.row(v).transpose() - middle).cross(vector);
    }
    Index u = unknowns_[region.node];
    for (const int axis : region.slide_axes) out[u++] = force[axis];
    for (const int axis : region.turn_axes) out[u++] = torque[axis] / region.reach;
  }
}

double Freedoms::largest(const Eigen::VectorXd& reduced) const {
  double square = 0;
  const auto count = [&square](double value) {
    if (!(value <= square)) square = value;  // also where it is not a number
  };
  for (Index node = 0; node < nodes(); ++node)
    if (vertex_of_[node] >= 0) count(reduced.segment(unknowns_[node], width(node)).squaredNorm());
  for (const Region& region : regions_) {
    const Index slides = region.slide_axes.size(), first = unknowns_[region.node];
    const Index turns = width(region.node) - slides;
    count(reduced.segment(first, slides).squaredNorm());
    if (turns > 0)
      count(reduced.segment(first + slides, turns).squaredNorm() / region.offsets.rowwise().squaredNorm().maxCoeff());
  }
  return std::sqrt(square);
}

void Freedoms::expand(const Eigen::Ref<const Eigen::VectorXd>& unknowns, const Points& positions, Points& out) const {
  out.resize(rest_.rows(), 3);
  for (Index v = 0; v < rest_.rows(); ++v) {
    Index u = first_unknown_[v];
    for (int axis = 0; axis < 3; ++axis) out(v, axis) = u >= 0 && !fixed_[v][axis] ? unknowns[u++] : 0;
  }
  for (const Region& region : regions_) {
    const Vec3 middle = center_of(region, positions);
    Vec3 slide = Vec3::Zero(), turn = Vec3::Zero();
    Index u = unknowns_[region.node];
    for (const int axis : region.slide_axes) slide[axis] = unknowns[u++];
    for (const int axis : region.turn_axes) turn[axis] = unknowns[u++] / region.reach;
    for (const Index v : region.vertices)
      out.row(v) = (slide + turn.cross(positions.row(v).transpose() - middle)).transpose();
  }
}

void Freedoms::move(const Eigen::Ref<const Eigen::VectorXd>& unknowns, double scale, Points& positions) const {
  for (Index v = 0; v < rest_.rows(); ++v) {
    Index u = first_unknown_[v];
    if (u < 0) continue;
    for (int axis = 0; axis < 3; ++axis)
      if (!fixed_[v][axis]) positions(v, axis) += scale * unknowns[u++];
  }
  for (const Region& region : regions_) {
    const Vec3 middle = center_of(region, positions);
    Vec3 slide = Vec3::Zero(), turn = Vec3::Zero();
    Index u = unknowns_[region.node];
    for (const int axis : region.slide_axes) slide[axis] = scale * unknowns[u++];
    for (const int axis : region.turn_axes) turn[axis] = scale * unknowns[u++] / region.reach;
    const Mat3 rotation = rotation_about(turn);
    for (const Index v : region.vertices)
      positions.row(v) = (middle + slide + rotation * (positions.row(v).transpose() - middle)).transpose();
  }
}

/// Second derivative in the turns: x turns to second order by w x (w x arm) / 2.
Mat3 Freedoms::bend_of(const Region& region, const Points& gradient, const Points& positions) {
  const Vec3 middle = center_of(region, positions);
  Mat3 bend = Mat3::Zero();
  for (const Index v : region.vertices) {
    const Vec3 arm = positions.row(v).transpose() - middle, force = gradient.row(v).transpose();
    bend += 0.5 * (force * arm.transpose() + arm * force.transpose()) - force.dot(arm) * Mat3::Identity();
  }
  return bend / (region.reach * region.reach);
}

Freedoms::Size Freedoms::size_of(const Eigen::Ref<const Eigen::VectorXd>& unknowns, const Points& positions) const {
  Points moves;
  expand(unknowns, positions, moves);
  double largest = 0, sum = 0;
  const Index count = moves.rows() - std::ssize(scalars_);
  for (Index v = 0; v < count; ++v) {
    const double square = moves.row(v).squaredNorm();
    if (!(square <= largest)) largest = square;  // also where it is not a number
    sum += square;
  }
  return {std::sqrt(largest), std::sqrt(sum / static_cast<double>(count))};
}

void Freedoms::add_turning(const Points& gradient, const Points& positions,
                           const Eigen::Ref<const Eigen::VectorXd>& unknowns, Eigen::Ref<Eigen::VectorXd> out) const {
  for (const Region& region : regions_) {
    const Mat3 bend = bend_of(region, gradient, positions);
    const Index first = unknowns_[region.node] + std::ssize(region.slide_axes);
    for (std::size_t i = 0; i < region.turn_axes.size(); ++i)
      for (std::size_t k = 0; k < region.turn_axes.size(); ++k)
        out[first + static_cast<Index>(i)] +=
            bend(region.turn_axes[i], region.turn_axes[k]) * unknowns[first + static_cast<Index>(k)];
  }
}

void Freedoms::hold(double load_factor, Points& positions) const {
  for (Index v = 0; v < rest_.rows(); ++v)
    if (region_of_[v] < 0)
      for (int axis = 0; axis < 3; ++axis)
        if (fixed_[v][axis]) positions(v, axis) = rest_(v, axis) + load_factor * (held_(v, axis) - rest_(v, axis));
  for (const Region& region : regions_) {
    Vec3 middle = center_of(region, positions);
    const Mat3 rotation = rotation_of(region, positions, middle);
    for (int axis = 0; axis < 3; ++axis)
      if (!region.slides[axis]) middle[axis] = region.rest_center[axis] + load_factor * region.displacement[axis];
    for (Index i = 0; i < region.offsets.rows(); ++i)
      positions.row(region.vertices[i]) = (middle + rotation * region.offsets.row(i).transpose()).transpose();
  }
}

}  // namespace softkin::supports
