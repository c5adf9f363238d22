#include "random/confirm_loads.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <softkin/model/mesh/triangle_points.hpp>

namespace softkin::random_robots {

void add_tractions(const Model& model, const State& state, Forces& forces) {
  using Real2 = Eigen::Matrix<Real, 3, 2>;
  using Real3 = Eigen::Matrix<Real, 3, 3>;
  for (const FollowingTraction& traction : model.tractions)
    for (const LoadedFace& loaded : traction.faces) {
      const std::vector<Index> nodes = nodes_of(loaded.face);
      for (const TrianglePoint& point : triangle_points(nodes.size())) {
        Real2 rest = Real2::Zero(), now = Real2::Zero();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
          const auto k = static_cast<Eigen::Index>(i);
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
        const RealVec3 force = static_cast<Real>(state.share * loaded.share * point.weight) *
                               (normal.norm() * (turn * traction.traction_MPa.cast<Real>()) -
                                static_cast<Real>(traction.pressure_MPa) * normal);
        for (std::size_t i = 0; i < nodes.size(); ++i)
          forces.add(nodes[i], -static_cast<Real>(point.shape[static_cast<Eigen::Index>(i)]) * force,
                     sums * rounding_unit * force.norm());
      }
    }
}

void add_fibres(const Model& model, const State& state, Forces& forces) {
  for (const Fibre& fibre : model.fibres)
    for (const FibrePlace& place : fibre.places) {
      RealVec3 along = RealVec3::Zero();
      Real shares = 0;
      for (std::size_t i = 0; i < place.vertices.size(); ++i) {
        along += static_cast<Real>(place.slopes[i]) * state.positions.row(place.vertices[i]).transpose().cast<Real>();
        shares +=
            std::abs(static_cast<Real>(place.slopes[i])) * state.positions.row(place.vertices[i]).cast<Real>().norm();
      }
      const Real longer = along.norm() - 1, strain = fibre.tension_only ? std::max(Real(0), longer) : longer;
      const Real stiffness = static_cast<Real>(fibre.stiffness_N), length = static_cast<Real>(place.length_mm);
      const RealVec3 pull = length * stiffness * strain / along.norm() * along;
      for (std::size_t i = 0; i < place.vertices.size(); ++i) {
        const Real slope = static_cast<Real>(place.slopes[i]);
        forces.add(place.vertices[i], slope * pull,
                   rounding_unit * std::abs(slope) * length * stiffness * (sums * shares + 1));
        forces.stiffness[place.vertices[i]] += length * stiffness * slope * slope;
      }
    }
}

}  // namespace softkin::random_robots
