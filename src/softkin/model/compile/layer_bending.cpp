#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/compile/layers.hpp>
#include <softkin/model/mesh/triangle_points.hpp>

namespace softkin {

namespace {

constexpr double seam = -0.5;  // cosine of the angle at rest beyond which an edge turns freely
// of jumps, over rigidity by height: from 1.5 on every sheet is stable (least eigenvalues of regular and irregular
// plates, nu up to 0.49), the more the stiffer is a coarse one; twice that at an edge to what is held
constexpr double jump_penalty = 2, clamp_penalty = 4;

/// The six nodes' second derivatives by u and v: uu, vv, uv.
const Eigen::Matrix<double, 6, 3>& second_derivatives() {
  static const Eigen::Matrix<double, 6, 3> all = [] {
    Eigen::Matrix<double, 6, 3> m;
    m << 4, 4, 4, 4, 0, 0, 0, 4, 0, -8, 0, -4, 0, 0, 4, 0, -8, -4;
    return m;
  }();
  return all;
}

/// A face as it stands at rest at one of its points.
struct FacePoint {
  LayerFrame frame;
  std::vector<Eigen::Matrix<double, 5, 1>> parts;  // of its nodes
  Vec3 curvature = Vec3::Zero();                   // 11, 22, 2 12 [1/mm]

  FacePoint(const LayerSpec& spec, const TrianglePoint& point, const std::vector<Index>& nodes, const Points& rest)
      : frame(spec, point, nodes, rest) {
    std::array<Vec3, 3> second{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Eigen::Index k = i;
      Eigen::Matrix2d by_uv;
      by_uv << second_derivatives()(k, 0), second_derivatives()(k, 2), second_derivatives()(k, 2),
          second_derivatives()(k, 1);
      const Eigen::Matrix2d own = frame.back * by_uv * frame.back.transpose();
      const Eigen::Vector2d slope = frame.back * Eigen::Vector2d(point.along_u[k], point.along_v[k]);
      parts.emplace_back();
      parts.back() << slope, own(0, 0), own(1, 1), own(0, 1);
      for (std::size_t c = 0; c < 3; ++c) second[c] += parts.back()[2 + c] * vertex_at(rest, nodes[i]);
    }
    curvature << frame.normal.dot(second[0]), frame.normal.dot(second[1]), 2 * frame.normal.dot(second[2]);
  }
};

/// A face at an edge between corners: which, where the edge begins in it, and whether with its lower vertex.
struct Beside {
  std::size_t face, corner;
  bool ascending;
};

/// One side of an edge, at one of its points.
struct JointSide {
  LayerJoint::Side side;
  double rigidity = 0;  // across the edge [N mm]
  double moment = 0;    // at rest [N]
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  Vec3 normal = Vec3::Zero(), edge = Vec3::Zero();
  double stretch = 0;  // length of the edge per fraction of it at this point [mm]

  JointSide(const LayerSpec& spec, const Beside& beside, double fraction, const CavityFace& face, const Mat3& bending,
            const Points& rest) {
    std::array<double, 3> at{};
    at[beside.corner] = beside.ascending ? 1 - fraction : fraction;
    at[(beside.corner + 1) % 3] = 1 - at[beside.corner];
    const TrianglePoint point = triangle_point(at[1], at[2], 0);
    side.vertices = nodes_of(face);
    const FacePoint here(spec, point, side.vertices, rest);
    const SurfaceEdges edges(point, side.vertices, rest);
    const std::array<Vec3, 3> directions{edges.u, Vec3(edges.v - edges.u), Vec3(-edges.v)};
    stretch = directions[beside.corner].norm();
    edge = (beside.ascending ? 1 : -1) * directions[beside.corner].normalized();
    along = here.frame.axes.transpose() * edge;
    const Eigen::Vector2d across = Eigen::Vector2d(along.y(), -along.x()).normalized();
    const Vec3 curled(across[0] * across[0], across[1] * across[1], 2 * across[0] * across[1]);
    const Vec3 moments = bending * curled;  // the moment across is this . (k11, k22, 2 k12)
    rigidity = curled.dot(moments);
    moment = moments.dot(here.curvature);
    normal = here.frame.normal;
    for (const auto& parts : here.parts)
      side.parts.emplace_back(parts[0], parts[1],
                              moments[0] * parts[2] + moments[1] * parts[3] + 2 * moments[2] * parts[4]);
  }
};

/// Returns the height of a face above an edge between corners, as if it were flat [mm].
double height_above(const CavityFace& face, std::size_t corner, const Points& rest) {
  const Vec3 a = vertex_at(rest, face.corners[corner]), b = vertex_at(rest, face.corners[(corner + 1) % 3]),
             c = vertex_at(rest, face.corners[(corner + 2) % 3]);
  return (b - a).cross(c - a).norm() / (b - a).norm();
}

/// Adds the joints that keep the angle between two faces, at two points of their edge.
class Joints {
 public:
  Joints(const LayerSpec& spec, const Points& rest, const std::vector<bool>& held, const Mat3& bending, Layer& layer)
      : spec_(spec), rest_(rest), held_(held), bending_(bending), layer_(layer) {}

  void add(const Beside& one, const Beside& other) {
    if (held_[one.face] && held_[other.face]) return;
    if (held_[one.face]) return add(other, one);
    constexpr double gauss = 0.28867513459481287;  // of the edge, from its middle
    for (const double fraction : {0.5 - gauss, 0.5 + gauss}) {
      const JointSide first = side_of(one, fraction), second = side_of(other, fraction);
      LayerJoint joint{{first.side, second.side}, {}};
      BendingJoint& own = joint.joint;
      own.along = first.along;
      own.upwards = {one.ascending ? 1.0 : -1.0, other.ascending ? -1.0 : 1.0};
      const Vec3 above = own.upwards[0] * first.normal, beyond = own.upwards[1] * second.normal;
      if (above.dot(beyond) < seam) return;
      own.angle = std::atan2(beyond.cross(above).dot(first.edge), above.dot(beyond));
      own.length = first.stretch / 2;
      own.moment = {own.upwards[0] * first.moment, own.upwards[1] * second.moment};
      const double one_side = first.rigidity / height_above(layer_.faces[one.face], one.corner, rest_);
      if (held_[other.face]) {
        own.fraction = {1, 0};
        own.penalty = clamp_penalty * one_side;
      } else {
        own.penalty =
            jump_penalty * (one_side + second.rigidity / height_above(layer_.faces[other.face], other.corner, rest_));
      }
      layer_.joints.push_back(std::move(joint));
    }
  }

 private:
  [[nodiscard]] JointSide side_of(const Beside& beside, double fraction) const {
    return {spec_, beside, fraction, layer_.faces[beside.face], bending_, rest_};
  }

  const LayerSpec& spec_;
  const Points& rest_;
  const std::vector<bool>& held_;
  const Mat3& bending_;
  Layer& layer_;
};

void add_places(const LayerSpec& spec, const Points& rest, const CavityFace& face, const Mat3& bending, Layer& layer) {
  const std::vector<Index> nodes = nodes_of(face);
  for (const TrianglePoint& point : strain_points(nodes.size())) {
    const FacePoint here(spec, point, nodes, rest);
    layer.bends.push_back({nodes, here.parts, {here.frame.area_mm2 * bending, here.curvature}});
  }
}

}  // namespace

void add_bending(const LayerSpec& spec, const Points& rest, const std::vector<std::array<bool, 3>>& fixed,
                 Layer& layer) {
  const Mat3 bending = std::pow(layer.thickness_mm, 3) / 12 * layer.law.stiffness;
  std::vector<bool> held;
  std::map<std::pair<Index, Index>, std::vector<Beside>> edges;
  for (std::size_t f = 0; f < layer.faces.size(); ++f) {
    const CavityFace& face = layer.faces[f];
    const std::vector<Index> nodes = nodes_of(face);
    held.push_back(std::all_of(nodes.begin(), nodes.end(), [&](Index v) {
      return fixed[v] == std::array<bool, 3>{true, true, true};
    }));
    if (!held.back()) add_places(spec, rest, face, bending, layer);
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = face.corners[k], b = face.corners[(k + 1) % 3];
      edges[std::minmax(a, b)].push_back({f, k, a < b});
    }
  }
  Joints joints(spec, rest, held, bending, layer);
  for (const auto& [ends, beside] : edges)
    if (beside.size() == 2) joints.add(beside[0], beside[1]);
}

}  // namespace softkin
