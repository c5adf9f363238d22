#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/energy/elastic.hpp>
#include <softkin/statics/physical/element_shapes.hpp>
#include <softkin/statics/physical/lanes.hpp>
#include <softkin/statics/physical/magnets.hpp>

namespace softkin::physical {

namespace {

using energy::lanes;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Position and magnetic moment of a quadrature point; the moment is (volume / mu_0) F b_r [N mm / mT].
struct Point {
  Vec3 place = Vec3::Zero(), moment = Vec3::Zero();
};

template <int K>
Point point_of(const std::array<Index, K>& nodes, const std::array<double, K>& shapes,
               const std::array<double, K>& poles, const Points& positions) {
  Point point;
  for (int i = 0; i < K; ++i) {
    point.place += shapes[i] * positions.row(nodes[i]).transpose();
    point.moment += poles[i] * positions.row(nodes[i]).transpose();
  }
  return point;
}

/// Returns the points of the elements of a block; the last element of all stands for missing ones.
template <int K, class Set>
std::array<Point, lanes> points_of(const Set& set, Index block, int q, const Points& positions) {
  std::array<Point, lanes> points;
  for (int l = 0; l < lanes; ++l) {
    const Index e = std::min(lanes * block + l, static_cast<Index>(set.nodes.size()) - 1);
    points[l] = point_of<K>(set.nodes[e], set.shapes[q], set.poles[e][q], positions);
  }
  return points;
}

energy::Pack3 places_of(const std::array<Point, energy::lanes>& points) {
  energy::Pack3 places;
  for (int l = 0; l < lanes; ++l) {
    places.x[l] = points[l].place[0];
    places.y[l] = points[l].place[1];
    places.z[l] = points[l].place[2];
  }
  return places;
}

Flux flux_of_lane(const energy::FluxPoint& flux, int lane) {
  return {lane_of(flux.value, lane),
          lane_of(flux.slope, lane),
          {lane_of(flux.second[0], lane), lane_of(flux.second[1], lane), lane_of(flux.second[2], lane)}};
}

/// Second derivative of -moment . b(place) by (moment, place).
Matrix6 second_derivative(const Point& point, const Flux& flux) {
  Matrix6 second;
  second.topLeftCorner<3, 3>().setZero();
  second.topRightCorner<3, 3>() = -flux.slope;
  second.bottomLeftCorner<3, 3>() = -flux.slope.transpose();
  Mat3 of_place = Mat3::Zero();
  for (int i = 0; i < 3; ++i) of_place -= point.moment[i] * flux.second[i];
  second.bottomRightCorner<3, 3>() = of_place;
  return second;
}

/// Returns the nearest positive semidefinite matrix after both halves are scaled to the same unit.
Matrix6 made_positive(Matrix6 second, double length_mm) {
  Eigen::Matrix<double, 6, 1> scale;
  scale << length_mm, length_mm, length_mm, 1, 1, 1;
  second = (scale.asDiagonal() * second * scale.asDiagonal()).eval();
  const SymmetricEigen eigen = symmetric_eigen(second);
  second = eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() * eigen.vectors.transpose();
  return scale.cwiseInverse().asDiagonal() * second * scale.cwiseInverse().asDiagonal();
}

}  // namespace

template <int K, int Q, class Nodes>
void Magnets::add(Set<K, Q>& set, const Model& model, const Nodes& nodes, const Vec3& remanence, std::int64_t slot) {
  Eigen::Matrix<double, K, 3> rest;
  for (int i = 0; i < K; ++i) rest.row(i) = model.rest.row(nodes[i]);
  const energy::ElasticRest<K, Q> shape = energy::elastic_rest(rest);
  auto& poles = set.poles.emplace_back();
  auto& volumes = set.volumes.emplace_back();
  for (int q = 0; q < Q; ++q) {
    volumes[q] = shape.volume[q];
    for (int i = 0; i < K; ++i)
      poles[q][i] = inverse_permeability * shape.volume[q] * shape.slope[q].row(i).dot(remanence.transpose());
  }
  auto& own = set.nodes.emplace_back();
  std::copy(nodes.begin(), nodes.end(), own.begin());
  set.slots.push_back(slot);
}

Magnets::Magnets(const Model& model, const std::vector<std::int64_t>& slots)
    : fields_(model), vertices_(model.rest.rows()), turning_(model, slots) {
  set_shapes(linear_.shapes);
  set_shapes(quadratic_.shapes);
  set_shapes(prisms_.shapes);
  const std::vector<Vec3>& remanence = model.magnetism->remanence;
  const std::size_t tetrahedra = model.elements.tetrahedra.size();
  for (std::size_t e = 0; e < remanence.size(); ++e) {
    if (remanence[e].isZero(0) || model.magnetism->magnetisation[e] != Magnetisation::stretches) continue;
    if (e >= tetrahedra) {
      add(prisms_, model, model.elements.prisms[e - tetrahedra], remanence[e], slots[e]);
    } else if (model.elements.edge_nodes.empty()) {
      add(linear_, model, model.elements.tetrahedra[e], remanence[e], slots[e]);
    } else {
      std::array<Index, 10> nodes;
      std::copy(model.elements.tetrahedra[e].begin(), model.elements.tetrahedra[e].end(), nodes.begin());
      std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
      add(quadratic_, model, nodes, remanence[e], slots[e]);
    }
  }
  for (Index a = 0; a < std::ssize(model.actuators); ++a)
    if (model.actuators[a].is<MagneticDrive>()) commands_.push_back(a);
  std::vector<double> sums(vertices_);
  each([&]<int K, int Q>(const Set<K, Q>& set) {
    for (std::size_t e = 0; e < set.nodes.size(); ++e)
      for (const auto& poles : set.poles[e])
        for (int i = 0; i < K; ++i) sums[set.nodes[e][i]] += poles[i];
  });
  for (Index v = 0; v < vertices_; ++v)
    if (sums[v] != 0) poles_.emplace_back(v, sums[v]);
}

std::optional<double> Magnets::add_gradient(const Fields::Setting& setting, const Points& positions, Points& gradient,
                                            Team& team) const {
  const std::optional<double> turning = turning_.add_gradient(fields_, setting, positions, gradient, team);
  if (!turning) return std::nullopt;
  double energy = *turning;
  if (!setting.uniform.isZero(0)) {
    const Eigen::RowVector3d flux = setting.uniform.transpose();
    for (const auto& [vertex, pole] : poles_) {
      gradient.row(vertex) -= pole * flux;
      energy -= pole * flux.dot(positions.row(vertex));
    }
  }
  if (!setting.in_space()) return energy;
  std::atomic<bool> known = true;
  each([&]<int K, int Q>(const Set<K, Q>& set) {
    const Index count = set.nodes.size();
    LargeVector<std::array<energy::FluxPoint, Q>> fluxes((set.nodes.size() + lanes - 1) / lanes);
    team.pieces(fluxes.size(), [&](Index begin, Index end) {
      for (Index b = begin; b < end; ++b)
        for (int q = 0; q < Q; ++q) {
          const auto points = points_of<K>(set, b, q, positions);
          if (!fields_.flux(setting, places_of(points), std::min<Index>(lanes, count - lanes * b), false, fluxes[b][q]))
            known = false;
        }
    });
    for (Index e = 0; e < count; ++e)  // by one thread: elements have vertices in common
      for (int q = 0; q < Q; ++q) {
        const Point point = point_of<K>(set.nodes[e], set.shapes[q], set.poles[e][q], positions);
        const Flux flux = flux_of_lane(fluxes[e / lanes][q], e % lanes);
        energy -= point.moment.dot(flux.value);
        const Vec3 pull = flux.slope.transpose() * point.moment;
        for (int i = 0; i < K; ++i)
          gradient.row(set.nodes[e][i]) -= (set.poles[e][q][i] * flux.value + set.shapes[q][i] * pull).transpose();
      }
  });
  if (!known) return std::nullopt;
  return energy;
}

void Magnets::evaluate(const Iterate& at, const LoadState& load_state, Scratch& /*scratch*/, Sum& sum,
                       Team& team) const {
  const std::optional<double> energy = add_gradient(fields_.setting(load_state), at.positions, sum.gradient, team);
  sum.energy += energy.value_or(0);
  sum.forbidden = sum.forbidden || !energy;
  sum.left_field = sum.left_field || !energy;
}

void Magnets::add_change(const LoadState& from, const LoadState& to, const Points& positions, Scratch& /*scratch*/,
                         Points& force, Team& team) const {
  const bool commanded =
      std::any_of(commands_.begin(), commands_.end(), [&](Index a) { return from.actuation[a] != to.actuation[a]; });
  if (!commanded && !(grows() && from.load_factor != to.load_factor)) return;
  Fields::Setting before = fields_.setting(from), after = fields_.setting(to);
  if (!before.in_space() && !after.in_space()) {  // the gradient is linear in a uniform field
    after.uniform -= before.uniform;
    (void)add_gradient(after, positions, force, team);
    return;
  }
  Points gradient = Points::Zero(force.rows(), 3);  // the field of a dipole is not linear in its commands
  (void)add_gradient(before, positions, gradient, team);
  force -= gradient;
  (void)add_gradient(after, positions, force, team);
}

void Magnets::stiffness(const Iterate& at, const LoadState& load_state, bool projected, Scratch& /*scratch*/,
                        LargeVector<double>& slots, Team& team) const {
  const Points& positions = at.positions;
  const Fields::Setting setting = fields_.setting(load_state);
  turning_.add_stiffness(fields_, setting, positions, projected, slots, team);
  if (!setting.in_space()) return;
  each([&]<int K, int Q>(const Set<K, Q>& set) {
    const auto of_element = [&](Index e, int q, const Point& point, const Flux& flux, double* slot) {
      const auto& shapes = set.shapes[q];
      const auto& poles = set.poles[e][q];
      Matrix6 second = second_derivative(point, flux);
      if (projected) second = made_positive(second, std::cbrt(set.volumes[e][q]));
      const Mat3 mixed = second.topRightCorner<3, 3>(), of_place = second.bottomRightCorner<3, 3>(),
                 of_moment = second.topLeftCorner<3, 3>();
      for (int a = 0; a < K; ++a)
        for (int b = 0; b <= a; ++b, slot += 9) {
          const Mat3 block = poles[a] * poles[b] * of_moment + poles[a] * shapes[b] * mixed +
                             shapes[a] * poles[b] * mixed.transpose() + shapes[a] * shapes[b] * of_place;
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) slot[3 * r + c] += block(r, c);
        }
    };
    const Index count = set.nodes.size();
    team.pieces((count + lanes - 1) / lanes, [&](Index begin, Index end) {
      energy::FluxPoint flux;
      for (Index b = begin; b < end; ++b)
        for (int q = 0; q < Q; ++q) {
          const auto points = points_of<K>(set, b, q, positions);
          const Index elements = std::min<Index>(lanes, count - lanes * b);
          if (!fields_.flux(setting, places_of(points), elements, true, flux)) continue;  // a shape that is forbidden
          for (Index l = 0; l < elements; ++l)
            of_element(lanes * b + l, q, points[l], flux_of_lane(flux, l), slots.data() + 9 * set.slots[lanes * b + l]);
        }
    });
  });
}

void Magnets::add_derivative(Index command, const LoadState& load_state, const Points& positions, Scratch& /*scratch*/,
                             Points& force, Team& team) const {
  if (loads(command)) (void)add_gradient(fields_.derivative(command, load_state), positions, force, team);
}

MagneticLoad Magnets::load(const LoadState& load_state, const Points& positions, Team& team) const {
  MagneticLoad load;
  double volume = 0;
  each([&]<int K, int Q>(const Set<K, Q>& set) {
    for (std::size_t e = 0; e < set.nodes.size(); ++e)
      for (int q = 0; q < Q; ++q) {
        const Point point = point_of<K>(set.nodes[e], set.shapes[q], set.poles[e][q], positions);
        load.center += set.volumes[e][q] * point.place;
        volume += set.volumes[e][q];
      }
  });
  turning_.add_places(positions, volume, load.center);
  load.center /= volume;
  Points gradient = Points::Zero(positions.rows(), 3);
  (void)add_gradient(fields_.setting(load_state), positions, gradient, team);
  for (Index v = 0; v < vertices_; ++v) {
    const Vec3 force = -gradient.row(v).transpose();
    load.force += force;
    load.moment += (positions.row(v).transpose() - load.center).cross(force);
  }
  return load;
}

}  // namespace softkin::physical
