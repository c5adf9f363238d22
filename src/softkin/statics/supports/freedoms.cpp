#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <softkin/linear/ordering.hpp>
#include <softkin/statics/supports/freedoms.hpp>

namespace softkin::supports {

Freedoms::Freedoms(const Model& model, const linear::BlockPattern& pattern)
    : rest_(model.rest), held_(model.held), fixed_(model.fixed), region_of_(model.rest.rows(), -1) {
  find_regions(model);
  number(pattern);
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
      region_of_[v] = static_cast<Index>(regions_.size());
      fixed_[v] = {true, true, true};  // no unknowns of its own
    }
    regions_.push_back(std::move(region));
  }
}

void Freedoms::number(const linear::BlockPattern& pattern) {
  std::vector<Index> node_of(static_cast<std::size_t>(rest_.rows()), -1), vertex_of;
  for (Index v = 0; v < rest_.rows(); ++v)
    if (fixed_[v] != std::array<bool, 3>{true, true, true}) {
      node_of[v] = static_cast<Index>(vertex_of.size());
      vertex_of.push_back(v);
    }
  const Index vertex_nodes = static_cast<Index>(vertex_of.size());
  const Index count = vertex_nodes + static_cast<Index>(regions_.size());
  for (Index v = 0; v < rest_.rows(); ++v)
    if (region_of_[v] >= 0) node_of[v] = vertex_nodes + region_of_[v];

  std::vector<Eigen::Triplet<double>> links;
  for (Index node = 0; node < count; ++node) links.emplace_back(node, node, 1.0);
  pattern.each([&](std::int64_t, Index row, Index column) {
    const Index i = node_of[row], j = node_of[column];
    if (i >= 0 && j >= 0 && i != j) links.emplace_back(std::max(i, j), std::min(i, j), 1.0);
  });
  Eigen::SparseMatrix<double> graph(count, count);
  graph.setFromTriplets(links.begin(), links.end());
  links = {};
  const linear::Ordering ordering = linear::nested_dissection(graph);

  std::vector<Index> place(static_cast<std::size_t>(count));
  for (Index k = 0; k < count; ++k) place[ordering.order[k]] = k;
  for (Index& node : node_of)
    if (node >= 0) node = place[node];
  first_unknown_.assign(static_cast<std::size_t>(rest_.rows()), -1);
  columns_.pieces = ordering.pieces;
  for (Index k = 0; k < count; ++k) {
    const Index node = ordering.order[k], first = columns_.unknowns.back();
    Index width = 0;
    if (node < vertex_nodes) {
      const Index v = vertex_of[node];
      vertex_of_.push_back(v);
      first_unknown_[v] = first;
      for (int axis = 0; axis < 3; ++axis) width += !fixed_[v][axis];
    } else {
      Region& region = regions_[node - vertex_nodes];
      vertex_of_.push_back(-1);
      region.node = k;
      width = static_cast<Index>(region.slide_axes.size() + region.turn_axes.size());
    }
    columns_.unknowns.push_back(first + width);
  }
  std::vector<std::vector<Index>> rows(static_cast<std::size_t>(count));
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
    columns_.starts.push_back(static_cast<Index>(columns_.rows.size()));
  }
  find_sources(pattern, node_of);
}

void Freedoms::find_sources(const linear::BlockPattern& pattern, const std::vector<Index>& node_of) {
  std::vector<std::pair<std::int64_t, bool>> block_of(columns_.rows.size(), {-1, false});  // and is it the transpose
  pattern.each([&](std::int64_t block, Index row, Index column) {
    const Index i = node_of[row], j = node_of[column];
    if (i < 0 || j < 0) return;
    const Index low = std::min(i, j), high = std::max(i, j);
    const auto first = columns_.rows.begin() + columns_.starts[low],
               last = columns_.rows.begin() + columns_.starts[low + 1];
    const std::int64_t entry = std::lower_bound(first, last, high) - columns_.rows.begin();
    if (region_of_[row] < 0 && region_of_[column] < 0)
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
    Eigen::Matrix<double, 3, Eigen::Dynamic> t(3, columns_.width(region.node));
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
    Index u = columns_.unknowns[region.node];
    for (const int axis : region.slide_axes) out[u++] = force[axis];
    for (const int axis : region.turn_axes) out[u++] = torque[axis] / region.reach;
  }
}

double Freedoms::largest(const Eigen::VectorXd& reduced) const {
  double square = 0;
  const auto count = [&square](double value) {
    if (!(value <= square)) square = value;  // also where it is not a number
  };
  for (Index node = 0; node < columns_.nodes(); ++node)
    if (vertex_of_[node] >= 0) count(reduced.segment(columns_.unknowns[node], columns_.width(node)).squaredNorm());
  for (const Region& region : regions_) {
    const Index slides = static_cast<Index>(region.slide_axes.size()), first = columns_.unknowns[region.node];
    const Index turns = columns_.width(region.node) - slides;
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
    Index u = columns_.unknowns[region.node];
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
    Index u = columns_.unknowns[region.node];
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

void Freedoms::add_turning(const Points& gradient, const Points& positions,
                           const Eigen::Ref<const Eigen::VectorXd>& unknowns, Eigen::Ref<Eigen::VectorXd> out) const {
  for (const Region& region : regions_) {
    const Mat3 bend = bend_of(region, gradient, positions);
    const Index first = columns_.unknowns[region.node] + static_cast<Index>(region.slide_axes.size());
    for (std::size_t i = 0; i < region.turn_axes.size(); ++i)
      for (std::size_t k = 0; k < region.turn_axes.size(); ++k)
        out[first + static_cast<Index>(i)] +=
            bend(region.turn_axes[i], region.turn_axes[k]) * unknowns[first + static_cast<Index>(k)];
  }
}

void Freedoms::reduce_matrix(const linear::BlockPattern& pattern, const LargeVector<double>& slots,
                             const Points& gradient, const Points& positions, LargeVector<double>& values,
                             Team& team) const {
  values.resize(static_cast<std::size_t>(columns_.offsets.back()));
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
        if (vertex_of_[j] < 0 || vertex_of_[columns_.rows[e]] < 0) {  // of a region
          std::fill(value, values.data() + columns_.offsets[e + 1], 0.0);
          continue;
        }
        const auto &row_fixed = fixed_[vertex_of_[columns_.rows[e]]], &column_fixed = fixed_[vertex_of_[j]];
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r)
            if (!row_fixed[r] && !column_fixed[c]) *value++ = block[3 * r + c];
      }
  });
  if (regions_.empty()) return;
  const std::vector<Vec3> middles = centers(positions);
  for (const RegionBlock& part : region_blocks_) {
    double sum[9];
    pattern.sum(slots, part.block, sum);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(sum);
    const Eigen::MatrixXd product =
        tangent(part.row, middles, positions).transpose() * block * tangent(part.column, middles, positions);
    const bool same_node = region_of_[part.row] >= 0 && region_of_[part.row] == region_of_[part.column];
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
  for (const Region& region : regions_) {
    const Mat3 bend = bend_of(region, gradient, positions);
    const Index width = columns_.width(region.node), slides = static_cast<Index>(region.slide_axes.size());
    Eigen::Map<Eigen::MatrixXd> target(values.data() + columns_.offsets[columns_.starts[region.node]], width, width);
    for (Index i = slides; i < width; ++i)
      for (Index k = slides; k < width; ++k)
        target(i, k) += bend(region.turn_axes[i - slides], region.turn_axes[k - slides]);
  }
}

void Freedoms::hold(double share, Points& positions) const {
  for (Index v = 0; v < rest_.rows(); ++v)
    if (region_of_[v] < 0)
      for (int axis = 0; axis < 3; ++axis)
        if (fixed_[v][axis]) positions(v, axis) = rest_(v, axis) + share * (held_(v, axis) - rest_(v, axis));
  for (const Region& region : regions_) {
    Vec3 middle = center_of(region, positions);
    const Mat3 rotation = rotation_of(region, positions, middle);
    for (int axis = 0; axis < 3; ++axis)
      if (!region.slides[axis]) middle[axis] = region.rest_center[axis] + share * region.displacement[axis];
    for (Index i = 0; i < region.offsets.rows(); ++i)
      positions.row(region.vertices[i]) = (middle + rotation * region.offsets.row(i).transpose()).transpose();
  }
}

}  // namespace softkin::supports
