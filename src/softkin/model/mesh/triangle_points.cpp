#include <softkin/model/mesh/triangle_points.hpp>

namespace softkin {

namespace {

TrianglePoint middle() {
  TrianglePoint point;
  point.shape << 1.0 / 3, 1.0 / 3, 1.0 / 3, 0, 0, 0;
  point.along_u << -1, 1, 0, 0, 0, 0;
  point.along_v << -1, 0, 1, 0, 0, 0;
  point.weight = 0.5;
  return point;
}

}  // namespace

std::span<const TrianglePoint> triangle_points(std::size_t nodes) {
  static const TrianglePoint flat = middle();
  return nodes == 3 ? std::span(&flat, 1) : std::span<const TrianglePoint>(triangle_rule());
}

SurfaceEdges::SurfaceEdges(const TrianglePoint& point, std::span<const Index> nodes, const Points& positions) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Eigen::Index k = i;
    u += point.along_u[k] * positions.row(nodes[i]).transpose();
    v += point.along_v[k] * positions.row(nodes[i]).transpose();
  }
}

}  // namespace softkin
