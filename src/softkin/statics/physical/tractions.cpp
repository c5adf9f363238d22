#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/tractions.hpp>

namespace softkin::physical {

namespace {

using Plane = Eigen::Matrix<double, 3, 2>;

constexpr double megapascals = 1e-3;  // in a kPa

}  // namespace

/// Load on a place per area at rest [MPa]: J (R t - p n), with J the area over that at rest.
///
/// With the surface's deformation F = [f g] over the frame at rest, C = F^T F and s^2 = tr C + 2 J, the stretch is
/// U = (C + J) / s and J R t = F (s - U) t in the plane; J n = f x g.
class Tractions::Load {
 public:
  Load(const Face& face, const Place& place, const Points& positions)
      : along_(place.along_MPa), outwards_(place.outwards_MPa - face.pressure_MPa) {
    const SurfaceEdges edges(*place.point, face.nodes, positions);
    Plane both;
    both << edges.u, edges.v;
    deformation_ = both * place.to_frame;
    metric_ = deformation_.transpose() * deformation_;
    normal_ = deformation_.col(0).cross(deformation_.col(1));
    area_ = normal_.norm();
    root_ = std::sqrt(metric_.trace() + 2 * area_);
    turned_ = root_ * along_ - (metric_ * along_ + area_ * along_) / root_;
  }

  [[nodiscard]] Vec3 whole() const { return outwards_ * normal_ + deformation_ * turned_; }
  /// Returns the load without the pressure.
  [[nodiscard]] Vec3 traction(double pressure_MPa) const { return whole() + pressure_MPa * normal_; }
  /// Returns the area vector per area at rest.
  [[nodiscard]] const Vec3& normal() const { return normal_; }

  /// Returns the derivative of the load along a change of the deformation.
  [[nodiscard]] Vec3 change(const Plane& by) const {
    const Vec3 normal = by.col(0).cross(deformation_.col(1)) + deformation_.col(0).cross(by.col(1));
    const Eigen::Matrix2d half = deformation_.transpose() * by, metric = half + half.transpose();
    const double area = area_ > 0 ? normal_.dot(normal) / area_ : 0;
    const double root = (metric.trace() + 2 * area) / (2 * root_);
    const Eigen::Vector2d turned = root * along_ - (metric * along_ + area * along_) / root_ +
                                   root / (root_ * root_) * (metric_ * along_ + area_ * along_);
    return outwards_ * normal + by * turned_ + deformation_ * turned;
  }

 private:
  Eigen::Vector2d along_;
  double outwards_;
  Plane deformation_;
  Eigen::Matrix2d metric_;
  Vec3 normal_;
  double area_, root_;
  Eigen::Vector2d turned_;
};

bool Tractions::act(const Model& model) {
  return std::any_of(model.loads.tractions.begin(), model.loads.tractions.end(),
                     [](const FollowingTraction& traction) { return traction.deeper_MPa_mm.isZero(0); });
}

Tractions::Tractions(const Model& model) : model_(model) {
  std::vector<Index> commands(model.loads.tractions.size(), -1);
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const auto* pressure = model.actuators[a].as<PressureCommand>())
      commands[pressure->traction] = static_cast<Index>(a);
  double count = 0;
  for (std::size_t t = 0; t < model.loads.tractions.size(); ++t) {
    const FollowingTraction& traction = model.loads.tractions[t];
    if (!traction.deeper_MPa_mm.isZero(0)) continue;  // see Hydrostatics
    grows_ = grows_ || commands[t] < 0;
    for (const LoadedFace& loaded : traction.faces) {
      Face face{commands[t] < 0 ? traction.pressure_MPa : megapascals, commands[t], nodes_of(loaded.face), {}};
      for (const Index v : face.nodes) middle_ += vertex_at(model.rest, v);
      count += static_cast<double>(face.nodes.size());
      for (const TrianglePoint& point : triangle_points(face.nodes.size())) {
        const SurfaceEdges edges(point, face.nodes, model.rest);
        const Vec3 normal = edges.u.cross(edges.v).normalized(), first = edges.u.normalized();
        Plane both, frame;
        both << edges.u, edges.v;
        frame << first, normal.cross(first);
        const Eigen::Matrix2d edges_in_frame = frame.transpose() * both;
        face.places.push_back({&point, loaded.fraction * point.weight * edges_in_frame.determinant(),
                               edges_in_frame.inverse(), frame.transpose() * traction.traction_MPa,
                               normal.dot(traction.traction_MPa)});
      }
      faces_.push_back(std::move(face));
    }
  }
  middle_ /= count;
}

template <class Visit>
void Tractions::each_place(const Points& positions, const Visit& visit) const {
  for (const Face& face : faces_)
    for (const Place& place : face.places) visit(face, place, Load(face, place, positions));
}

void Tractions::evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                         Team& /*team*/) const {
  static_cast<Scratch&>(scratch).load_state = load_state;
  double energy = 0;
  each_place(at.positions, [&](const Face& face, const Place& place, const Load& load) {
    const double scale = scale_of(face, load_state);
    const Vec3 force = scale * place.area_mm2 * load.whole();
    Vec3 x = -middle_, move = Vec3::Zero();
    for (std::size_t i = 0; i < face.nodes.size(); ++i) {
      const double shape = place.point->shape[i];
      sum.gradient.row(face.nodes[i]) -= shape * force.transpose();
      x += shape * vertex_at(at.positions, face.nodes[i]);
      move += shape * (vertex_at(at.positions, face.nodes[i]) - vertex_at(model_.rest, face.nodes[i]));
    }
    energy += scale * place.area_mm2 *
              (face.pressure_MPa * load.normal().dot(x) / 3 - load.traction(face.pressure_MPa).dot(move));
  });
  sum.energy += energy;
}

Tractions::Blocks Tractions::slopes(std::size_t number, const Points& positions) const {
  const Face& face = faces_[number];
  Blocks blocks;
  for (auto& row : blocks) row.fill(Mat3::Zero());
  for (const Place& place : face.places) {
    const Load load(face, place, positions);
    Mat3 by[2];
    for (int side = 0; side < 2; ++side)
      for (int axis = 0; axis < 3; ++axis) {
        Plane change = Plane::Zero();
        change(axis, side) = 1;
        by[side].col(axis) = place.area_mm2 * load.change(change);
      }
    const TrianglePoint& point = *place.point;
    for (std::size_t j = 0; j < face.nodes.size(); ++j) {
      const Eigen::Index k = j;
      const Eigen::RowVector2d slope = Eigen::RowVector2d(point.along_u[k], point.along_v[k]) * place.to_frame;
      const Mat3 change = slope[0] * by[0] + slope[1] * by[1];
      for (std::size_t i = 0; i < face.nodes.size(); ++i) blocks[i][j] -= point.shape[i] * change;
    }
  }
  return blocks;
}

void Tractions::add_change(const LoadState& from, const LoadState& to, const Points& positions,
                           Term::Scratch& /*scratch*/, Points& force, Team& /*team*/) const {
  each_place(positions, [&](const Face& face, const Place& place, const Load& load) {
    const double change = scale_of(face, to) - scale_of(face, from);
    if (change == 0) return;
    const Vec3 more = change * place.area_mm2 * load.whole();
    for (std::size_t i = 0; i < face.nodes.size(); ++i)
      force.row(face.nodes[i]) -= place.point->shape[i] * more.transpose();
  });
}

bool Tractions::loads(Index command) const {
  return model_.actuators[command].is<PressureCommand>();
}

void Tractions::add_derivative(Index command, const LoadState& /*load_state*/, const Points& positions,
                               Term::Scratch& /*scratch*/, Points& force, Team& /*team*/) const {
  if (!loads(command)) return;
  each_place(positions, [&](const Face& face, const Place& place, const Load& load) {
    if (face.command != command) return;
    const Vec3 push = place.area_mm2 * load.whole();
    for (std::size_t i = 0; i < face.nodes.size(); ++i)
      force.row(face.nodes[i]) -= place.point->shape[i] * push.transpose();
  });
}

}  // namespace softkin::physical
