#include "random/confirm_loads.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <softkin/model/mesh/triangle_points.hpp>

namespace softkin::random_robots {

void add_tractions(const Model& model, const State& state, Forces& forces) {
  using Real2 = Eigen::Matrix<Real, 3, 2>;
  using Real3 = Eigen::Matrix<Real, 3, 3>;
  for (std::size_t t = 0; t < model.loads.tractions.size(); ++t) {
    const FollowingTraction& traction = model.loads.tractions[t];
    if (!traction.deeper_MPa_mm.isZero(0)) continue;
    Real pressure = static_cast<Real>(state.load_factor) * static_cast<Real>(traction.pressure_MPa);
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      if (const auto* command = model.actuators[a].as<PressureCommand>();
          command && command->traction == static_cast<Index>(t))
        pressure += 1e-3L * static_cast<Real>(state.actuation[a]);
    for (const LoadedFace& loaded : traction.faces) {
      const std::vector<Index> nodes = nodes_of(loaded.face);
      for (const TrianglePoint& point : triangle_points(nodes.size())) {
        Real2 rest = Real2::Zero(), now = Real2::Zero();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          const Eigen::Index k = i;
          const Eigen::Matrix<Real, 1, 2> along(point.along_u[k], point.along_v[k]);
          rest += model.rest.row(nodes[i]).transpose().cast<Real>() * along;
          now += state.positions.row(nodes[i]).transpose().cast<Real>() * along;
        }
        const RealVec3 normal_at_rest = rest.col(0).cross(rest.col(1)), normal = now.col(0).cross(now.col(1));
        Real3 from, to;
        from << rest, normal_at_rest.normalized();
        to << now, normal.normalized();
        const Eigen::JacobiSVD<Real3> parts(to * from.inverse(), Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Real3 turn = parts.matrixU() * parts.matrixV().transpose();
        const RealVec3 force =
            static_cast<Real>(loaded.fraction * point.weight) *
            (static_cast<Real>(state.load_factor) * normal.norm() * (turn * traction.traction_MPa.cast<Real>()) -
             pressure * normal);
        for (std::size_t i = 0; i < nodes.size(); ++i)
          forces.add(nodes[i], -static_cast<Real>(point.shape[i]) * force, sums * rounding_unit * force.norm());
      }
    }
  }
}

namespace {

using FacePlace = std::array<Real, 2>;  // (u, v) of a face's triangle

struct FaceAt {
  Real shape[6], by_u[6], by_v[6];
};
FaceAt face_at(std::size_t nodes, const FacePlace& at) {
  const Real u = at[0], v = at[1], t = 1 - u - v;
  if (nodes == 3) return {{t, u, v}, {-1, 1, 0}, {-1, 0, 1}};
  return {{t * (2 * t - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * t * u, 4 * u * v, 4 * v * t},
          {1 - 4 * t, 4 * u - 1, 0, 4 * (t - u), 4 * v, -4 * v},
          {1 - 4 * t, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (t - v)}};
}

/// The pressure of a liquid on the nodes of a face.
struct PressedFace {
  const std::vector<Index>& nodes;
  const Points& positions;
  RealVec3 deeper, level;
  std::vector<RealVec3> force;

  [[nodiscard]] RealVec3 sum(const Real (&weights)[6]) const {
    RealVec3 at = RealVec3::Zero();
    for (std::size_t i = 0; i < nodes.size(); ++i) at += weights[i] * positions.row(nodes[i]).transpose().cast<Real>();
    return at;
  }
  [[nodiscard]] Real pressure(const FacePlace& at) const {
    return deeper.dot(sum(face_at(nodes.size(), at).shape) - level);
  }
  void add(const FacePlace& a, const FacePlace& b, const FacePlace& c, int halvings) {
    const auto middle = [](const FacePlace& p, const FacePlace& q) {
      return FacePlace{(p[0] + q[0]) / 2, (p[1] + q[1]) / 2};
    };
    const FacePlace ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    int wet = 0;
    for (const FacePlace& at : {a, b, c, ab, bc, ca}) wet += pressure(at) > 0;
    if (wet == 0) return;
    if (wet < 6 && halvings > 0) {
      add(a, ab, ca, halvings - 1);
      add(ab, b, bc, halvings - 1);
      add(ca, bc, c, halvings - 1);
      return add(ab, bc, ca, halvings - 1);
    }
    // four points of Gauss's rule squared, collapsed onto the triangle
    const Real gauss[4] = {0.0694318442029737124L, 0.330009478207571868L, 0.669990521792428132L, 0.930568155797026288L},
               weights[4] = {0.173927422568726929L, 0.326072577431273071L, 0.326072577431273071L,
                             0.173927422568726929L};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const Real s = gauss[i], r = gauss[j] * (1 - s);
        const FacePlace at{a[0] + s * (b[0] - a[0]) + r * (c[0] - a[0]), a[1] + s * (b[1] - a[1]) + r * (c[1] - a[1])};
        const Real doubled = std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        const FaceAt face = face_at(nodes.size(), at);
        const RealVec3 area = sum(face.by_u).cross(sum(face.by_v));
        const Real push = weights[i] * weights[j] * (1 - s) * doubled * std::max<Real>(0, pressure(at));
        for (std::size_t n = 0; n < nodes.size(); ++n) force[n] += push * face.shape[n] * area;
      }
  }
};

}  // namespace

void add_liquid(const Model& model, const State& state, Forces& forces) {
  constexpr int halvings = 7;
  for (const FollowingTraction& liquid : model.loads.tractions) {
    if (liquid.deeper_MPa_mm.isZero(0)) continue;
    for (const LoadedFace& loaded : liquid.faces) {
      const std::vector<Index> nodes = nodes_of(loaded.face);
      PressedFace face{nodes, state.positions, liquid.deeper_MPa_mm.cast<Real>(), liquid.level_mm.cast<Real>(),
                       std::vector<RealVec3>(nodes.size(), RealVec3::Zero())};
      face.add({0, 0}, {1, 0}, {0, 1}, halvings);
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const RealVec3 force = static_cast<Real>(state.load_factor * loaded.fraction) * face.force[i];
        forces.add(nodes[i], force, sums * rounding_unit * force.norm());
      }
    }
  }
}

void add_fibres(const Model& model, const State& state, Forces& forces) {
  for (const Fibre& fibre : model.reinforcement.fibres)
    for (const FibrePlace& place : fibre.places) {
      RealVec3 along = RealVec3::Zero();
      Real fractions = 0;
      for (std::size_t i = 0; i < place.vertices.size(); ++i) {
        along += static_cast<Real>(place.slopes[i]) * state.positions.row(place.vertices[i]).transpose().cast<Real>();
        fractions +=
            std::abs(static_cast<Real>(place.slopes[i])) * state.positions.row(place.vertices[i]).cast<Real>().norm();
      }
      const Real longer = along.norm() - 1, strain = fibre.tension_only ? std::max(Real(0), longer) : longer;
      const Real stiffness = static_cast<Real>(fibre.stiffness_N), length = static_cast<Real>(place.length_mm);
      const RealVec3 pull = length * stiffness * strain / along.norm() * along;
      for (std::size_t i = 0; i < place.vertices.size(); ++i) {
        const Real slope = static_cast<Real>(place.slopes[i]);
        forces.add(place.vertices[i], slope * pull,
                   rounding_unit * std::abs(slope) * length * stiffness * (sums * fractions + 1));
        forces.stiffness[place.vertices[i]] += length * stiffness * slope * slope;
      }
    }
}

}  // namespace softkin::random_robots
