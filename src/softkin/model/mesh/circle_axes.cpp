#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <softkin/model/mesh/circle_axes.hpp>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin {

namespace {

constexpr std::size_t min_votes = 5;
constexpr std::size_t max_axes = 64;
constexpr double same_axis_direction = 0.01;  // sine of the angle between two directions that count as one
constexpr double same_line = 0.01;            // distance between two lines over the circle's radius

struct CircleVote {
  AxisLine axis;
  double radius = 0;
};

struct AxisCluster {
  AxisLine first;
  Vec3 point_sum{0, 0, 0}, direction_sum{0, 0, 0};
  std::size_t votes = 0;
};

/// The circle through three points, if both chords span at most the widest step.
std::optional<CircleVote> circle_through(const Vec3& a, const Vec3& b, const Vec3& c, double widest_step) {
  const Vec3 u = a - b, v = c - b, cross = u.cross(v);
  const double area = cross.norm(), scale = u.norm() * v.norm();
  if (!(area > 0.02 * scale)) return std::nullopt;  // almost on a line
  const Vec3 to_center = (u.squaredNorm() * v - v.squaredNorm() * u).cross(cross) / (2 * area * area);
  const double radius = to_center.norm();
  const double longest = 2 * radius * std::sin(std::min(0.5 * widest_step, 1.5));
  const double sharpest = std::max(0.0, std::cos(widest_step + 0.02));  // at b the circle turns by a step at most
  if (u.norm() > longest || v.norm() > longest || -u.dot(v) < sharpest * scale) return std::nullopt;
  return CircleVote{{b + to_center, cross / area}, radius};
}

bool is_same_axis(const AxisLine& one, const CircleVote& vote) {
  if (one.direction.cross(vote.axis.direction).norm() > same_axis_direction) return false;
  return (vote.axis.point - one.point).cross(one.direction).norm() <= same_line * vote.radius;
}

void add_vote(std::vector<AxisCluster>& clusters, const CircleVote& vote) {
  auto found = std::find_if(clusters.begin(), clusters.end(),
                            [&](const AxisCluster& cluster) { return is_same_axis(cluster.first, vote); });
  if (found == clusters.end()) {
    if (clusters.size() >= 64 * max_axes) return;
    found = clusters.insert(clusters.end(), {vote.axis, Vec3::Zero(), Vec3::Zero(), 0});
  }
  const AxisLine& first = found->first;
  const Vec3 offset = vote.axis.point - first.point;
  found->point_sum += offset - offset.dot(first.direction) * first.direction;
  found->direction_sum +=
      vote.axis.direction.dot(first.direction) < 0 ? Vec3(-vote.axis.direction) : vote.axis.direction;
  ++found->votes;
}

}  // namespace

std::vector<AxisLine> circle_axes(const Points& vertices, const std::vector<std::array<Index, 2>>& edges,
                                  double widest_step) {
  std::vector<std::array<Index, 2>> both = edges;
  for (const auto& [a, b] : edges) both.push_back({b, a});
  std::sort(both.begin(), both.end());
  std::vector<AxisCluster> clusters;
  for (std::size_t begin = 0, end = 0; begin < both.size(); begin = end) {
    while (end < both.size() && both[end][0] == both[begin][0]) ++end;
    const Vec3 middle = vertex_at(vertices, both[begin][0]);
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = begin; j < i; ++j)
        if (const auto vote =
                circle_through(vertex_at(vertices, both[i][1]), middle, vertex_at(vertices, both[j][1]), widest_step))
          add_vote(clusters, *vote);
  }
  std::erase_if(clusters, [](const AxisCluster& cluster) { return cluster.votes < min_votes; });
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const AxisCluster& a, const AxisCluster& b) { return a.votes > b.votes; });
  if (clusters.size() > max_axes) clusters.resize(max_axes);
  std::vector<AxisLine> axes;
  axes.reserve(clusters.size());
  for (const AxisCluster& cluster : clusters)
    axes.push_back({cluster.first.point + cluster.point_sum / static_cast<double>(cluster.votes),
                    cluster.direction_sum.normalized()});
  return axes;
}

}  // namespace softkin
