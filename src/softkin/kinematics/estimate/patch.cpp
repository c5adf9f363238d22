#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <softkin/kinematics/estimate/patch.hpp>

namespace softkin::estimate {

namespace {

/// Radius of a spot, relative to the longest edge of a face: it contains at least the corners of the face at its
/// middle.
constexpr double spot = 1.5;

std::vector<Triangle> triangles_of(const std::vector<CavityFace>& faces) {
  std::vector<Triangle> triangles;
  for (const CavityFace& face : faces) triangles.push_back(face.corners);
  return triangles;
}

/// In the order of CavityFace: corners, then the nodes on the edges 01, 12, 20.
Eigen::VectorXd shape_of(std::size_t nodes, const Place& place) {
  const double u = place.u, v = place.v, w = 1 - u - v;
  Eigen::VectorXd shape(nodes);
  if (nodes == 3)
    shape << w, u, v;
  else
    shape << w * (2 * w - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * w * u, 4 * u * v, 4 * v * w;
  return shape;
}

/// A node of a spot: its weight, (1 - r^2 / R^2)^3, with its derivatives along both tangents as the spot moves, and
/// (1, x / R, y / R) in the tangent plane.
struct SpotNode {
  double weight;
  Eigen::Vector2d slope;
  Vec3 basis;

  SpotNode(const Vec3& arm, const Eigen::Matrix<double, 3, 2>& tangents, double radius) {
    const Eigen::Vector2d along = tangents.transpose() * arm / radius;
    const double left = 1 - arm.squaredNorm() / (radius * radius);
    weight = left * left * left;
    slope = 6 * left * left / radius * along;
    basis << 1, along;
  }
};

}  // namespace

Patch::Patch(const Model& model, std::vector<CavityFace> faces)
    : model_(model), faces_(std::move(faces)), tree_(model.rest, triangles_of(faces_)) {
  for (const CavityFace& face : faces_)
    for (const Index v : nodes_of(face)) nodes_.push_back(v);
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  for (const CavityFace& face : faces_) {
    std::vector<Index>& own = of_face_.emplace_back();
    for (const Index v : nodes_of(face))
      own.push_back(std::lower_bound(nodes_.begin(), nodes_.end(), v) - nodes_.begin());
  }
  measure();
}

/// By the corners; of a triangle, the second moment about the origin is A / 12 (sum of x x^T + 9 m m^T).
void Patch::measure() {
  double longest = 0;
  Mat3 second = Mat3::Zero();
  for (const CavityFace& face : faces_) {
    const Vec3 a = vertex_at(model_.rest, face.corners[0]), b = vertex_at(model_.rest, face.corners[1]),
               c = vertex_at(model_.rest, face.corners[2]), m = (a + b + c) / 3;
    longest = std::max({longest, (b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double own = (b - a).cross(c - a).norm() / 2;
    area_ += own;
    middle_ += own * m;
    second += own / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + 9 * m * m.transpose());
  }
  radius_ = spot * longest;
  middle_ /= area_;
  covariance_ = second / area_ - middle_ * middle_.transpose();
}

Eigen::Matrix<double, 3, 2> Patch::tangents(const Place& place) const {
  const Triangle& t = faces_[place.face].corners;
  const Vec3 a = vertex_at(model_.rest, t[0]), along = vertex_at(model_.rest, t[1]) - a,
             across = vertex_at(model_.rest, t[2]) - a;
  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = along.normalized();
  tangents.col(1) = (across - across.dot(tangents.col(0)) * tangents.col(0)).normalized();
  return tangents;
}

Patch::Fractions Patch::fractions(const Place& place) const {
  Fractions found{{}, {}, {}, tangents(place)};
  const Vec3 there = at(place, model_.rest);
  std::vector<SpotNode> near;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Vec3 arm = vertex_at(model_.rest, nodes_[i]) - there;
    if (arm.squaredNorm() >= radius_ * radius_) continue;
    near.emplace_back(arm, found.tangents, radius_);
    found.nodes.push_back(i);
  }
  Mat3 moments = Mat3::Zero();
  std::array<Mat3, 2> changes{Mat3::Zero(), Mat3::Zero()};
  for (const SpotNode& node : near) {
    moments += node.weight * node.basis * node.basis.transpose();
    for (int t = 0; t < 2; ++t) {
      const Vec3 change = -Vec3::Unit(t + 1) / radius_;
      changes[t] += node.slope[t] * node.basis * node.basis.transpose() +
                    node.weight * (change * node.basis.transpose() + node.basis * change.transpose());
    }
  }
  const Mat3 inverse = moments.inverse();
  const Vec3 fit = inverse.col(0);
  found.fractions.resize(near.size());
  found.slopes.resize(near.size(), 2);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const SpotNode& node = near[i];
    const Index row = i;
    found.fractions[row] = node.weight * node.basis.dot(fit);
    for (int t = 0; t < 2; ++t)
      found.slopes(row, t) = node.slope[t] * node.basis.dot(fit) - node.weight * fit[t + 1] / radius_ -
                             node.weight * node.basis.dot(inverse * changes[t] * fit);
  }
  return found;
}

Vec3 Patch::at(const Place& place, const Points& positions) const {
  const std::vector<Index>& nodes = of_face_[place.face];
  const Eigen::VectorXd shape = shape_of(nodes.size(), place);
  Vec3 point = Vec3::Zero();
  for (std::size_t i = 0; i < nodes.size(); ++i) point += shape[i] * vertex_at(positions, nodes_[nodes[i]]);
  return point;
}

Place Patch::nearest(const Vec3& at_rest) const {
  Place place;
  const Vec3 point = tree_.nearest(at_rest, &place.face);
  const Triangle& t = faces_[place.face].corners;
  const Vec3 a = vertex_at(model_.rest, t[0]), e = vertex_at(model_.rest, t[1]) - a,
             f = vertex_at(model_.rest, t[2]) - a, normal = e.cross(f), arm = point - a;
  place.u = std::clamp(arm.cross(f).dot(normal) / normal.squaredNorm(), 0.0, 1.0);
  place.v = std::clamp(e.cross(arm).dot(normal) / normal.squaredNorm(), 0.0, 1 - place.u);
  return place;
}

std::vector<Place> Patch::spread(std::size_t most) const {
  std::vector<Vec3> middles;
  for (const CavityFace& face : faces_)
    middles.push_back((vertex_at(model_.rest, face.corners[0]) + vertex_at(model_.rest, face.corners[1]) +
                       vertex_at(model_.rest, face.corners[2])) /
                      3);
  std::vector<double> apart(middles.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  for (std::size_t f = 0; f < middles.size(); ++f)
    if ((middles[f] - middle_).squaredNorm() < (middles[next] - middle_).squaredNorm()) next = f;
  std::vector<Place> places;
  while (places.size() < std::min(most, middles.size())) {
    places.push_back({static_cast<Index>(next)});
    for (std::size_t f = 0; f < middles.size(); ++f)
      apart[f] = std::min(apart[f], (middles[f] - middles[next]).squaredNorm());
    next = std::max_element(apart.begin(), apart.end()) - apart.begin();
  }
  return places;
}

}  // namespace softkin::estimate
