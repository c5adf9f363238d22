#include <Eigen/Geometry>
#include <cmath>
#include <softkin/statics/target_shape/element_sets.hpp>

namespace softkin::target_shape {

using namespace energy;

namespace {

template <int K>
using RestShape = Eigen::Matrix<double, K, 3>;

void set_lane(Pack3& point, int lane, const Eigen::RowVector3d& value) {
  point.x[lane] = value[0];
  point.y[lane] = value[1];
  point.z[lane] = value[2];
}

template <int K>
RestShape<K> rest_shape(const Points& positions, const std::array<Index, K>& nodes) {
  RestShape<K> shape;
  for (int i = 0; i < K; ++i) shape.row(i) = positions.row(nodes[i]);
  return shape;
}

/// Returns the square of an element's size, by which Eq. (2) makes large elements stiffer: a third of the squared
/// distances of its corners from their centre [mm^2]. In an element that strains alike in all directions, whatever its
/// shape, and averaged over all orientations of it, the energy over this is volume times squared strain.
template <int K>
double squared_size(const RestShape<K>& rest) {
  return (rest.rowwise() - rest.colwise().mean()).squaredNorm() / 3;
}

/// Returns the factor of an element's squared distance from its target.
template <int K>
double element_weight(const Model& model, double weight, double volume, const RestShape<K>& rest) {
  const double of_volume = weight * volume;
  return model.weights == ElementWeights::printed ? of_volume : of_volume / squared_size<K>(rest);
}

/// Adds one element; fill(block, lane) writes everything but the nodes.
template <int K, class Block, class Fill>
void add_element(ElementSet<K, Block>& set, const std::array<Index, K>& nodes, const Fill& fill) {
  const int lane = set.count % lanes;
  if (lane == 0) {
    set.blocks.emplace_back();
    set.nodes.emplace_back();
  }
  // later elements overwrite the lanes that this one fills in advance
  for (int l = lane; l < lanes; ++l) {
    for (int i = 0; i < K; ++i) set.nodes.back()[i][l] = nodes[i];
    fill(set.blocks.back(), l);
    if (l > lane) set.blocks.back().weight[l] = 0;
  }
  ++set.count;
}

template <int K>
void add_body(BodySet<K>& set, const Model& model, const std::array<Index, K>& nodes, double volume,
              const Material& material) {
  RestShape<K> rest = rest_shape<K>(model.rest, nodes);
  const double weight = element_weight<K>(model, material.weight, volume, rest);
  rest.rowwise() -= rest.colwise().mean().eval();
  add_element<K>(set, nodes, [&](BodyBlock<K>& block, int l) {
    if (l == 0) block.blended = false;
    for (int i = 0; i < K; ++i) set_lane(block.rest[i], l, rest.row(i));
    block.volume[l] = volume;
    block.weight[l] = weight;
    block.shape_ratio[l] = material.shape_ratio;
    block.blended = block.blended || material.shape_ratio < 1;
  });
}

template <int K>
void add_actuation(const Model& model, ActuationSet<K>& set, const std::array<Index, K>& nodes,
                   const TargetSplit<K>& split, double measure, double weight) {
  set.even = K != 3 && model.weights == ElementWeights::mesh_independent;  // gaps of a cable are none of the mesh
  set.measure_sum += measure;
  set.fraction_sum += set.even ? measure : measure * measure;
  add_element<K>(set, nodes, [&](ActuationBlock<K>& block, int l) {
    for (int i = 0; i < K; ++i) {
      set_lane(block.constant[i], l, split.constant.row(i));
      set_lane(block.grown[i], l, split.grown.row(i));
      set_lane(block.thinned[i], l, split.thinned.row(i));
    }
    block.measure[l] = measure;
    block.weight[l] = weight;
  });
}

double mean_area(const RestShape<6>& p) {
  const auto area = [&](int a, int b, int c) {
    const Vec3 u = p.row(b) - p.row(a), v = p.row(c) - p.row(a);
    return 0.5 * u.cross(v).norm();
  };
  return 0.5 * (area(0, 1, 2) + area(3, 4, 5));
}

/// A triangle has no volume: with the printed weights it counts as a body element of mean volume, so that its weight is
/// w times that of its surroundings. Much heavier ones stop local/global from converging, much lighter ones are too
/// compliant.
double mean_volume(const Model& model) {
  double sum = 0, count = 0;
  const auto add = [&](const std::vector<ElementRole>& roles, const std::vector<double>& volumes) {
    for (std::size_t e = 0; e < roles.size(); ++e)
      if (roles[e].material >= 0) sum += volumes[e], ++count;
  };
  add(model.elements.tetrahedron_roles, model.elements.tetrahedron_volumes);
  add(model.elements.prism_roles, model.elements.prism_volumes);
  return count > 0 ? sum / count : 1;
}

/// Where the mesh must not matter, it counts as the regular tetrahedron on an equilateral triangle of its size: one
/// with edges a has squared distances a^2 of its corners from their centre, and a volume of a^3 / sqrt(72).
double own_volume(const RestShape<3>& rest) {
  const double edge = std::sqrt(3 * squared_size<3>(rest));
  return edge * edge * edge / std::sqrt(72.0);
}

ActuationSet<3> cable_set(const Model& model, const CableDrive& cable, double weight,
                          std::vector<const EmbeddedPoint*>& points) {
  ActuationSet<3> set;
  const bool printed = model.weights == ElementWeights::printed;
  const double mean = printed ? mean_volume(model) : 0;
  const auto node = [&](const EmbeddedPoint& point) {
    points.push_back(&point);
    return static_cast<Index>(model.rest.rows() + std::ssize(points) - 1);
  };
  std::vector<Index> along(cable.points.size(), -1);
  const auto node_along = [&](Index i) { return along[i] >= 0 ? along[i] : along[i] = node(cable.points[i]); };
  for (const CableGap& gap : cable.gaps) {
    RestShape<3> rest;
    rest.row(0) = cable.points[gap.segment].at(model.rest).transpose();
    rest.row(1) = cable.points[gap.segment + 1].at(model.rest).transpose();
    rest.row(2) = gap.apex.at(model.rest).transpose();
    const Index first = node_along(gap.segment), second = node_along(gap.segment + 1);
    add_actuation<3>(model, set, {first, second, node(gap.apex)}, split_cable(rest), (rest.row(1) - rest.row(0)).norm(),
                     element_weight<3>(model, weight, printed ? mean : own_volume(rest), rest));
  }
  return set;
}

}  // namespace

ElementSets make_element_sets(const Model& model) {
  ElementSets sets;
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    if (const Index m = model.elements.tetrahedron_roles[e].material; m >= 0)
      add_body<4>(sets.tetrahedra, model, model.elements.tetrahedra[e], model.elements.tetrahedron_volumes[e],
                  model.elements.materials[m]);
  for (std::size_t e = 0; e < model.elements.prisms.size(); ++e)
    if (const Index m = model.elements.prism_roles[e].material; m >= 0)
      add_body<6>(sets.prisms, model, model.elements.prisms[e], model.elements.prism_volumes[e],
                  model.elements.materials[m]);

  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const Index index = a;
    if (const auto* cable = actuator.as<CableDrive>()) {
      sets.cables.push_back(cable_set(model, *cable, actuator.weight, sets.points));
      sets.cables.back().actuator = index;
    } else if (const auto* chamber = actuator.as<ChamberDrive>()) {
      ActuationSet<4>& set = sets.pneumatic.emplace_back();
      set.actuator = index;
      for (const Index e : chamber->tetrahedra) {
        const double volume = model.elements.tetrahedron_volumes[e];
        const RestShape<4> rest = rest_shape<4>(model.rest, model.elements.tetrahedra[e]);
        add_actuation<4>(model, set, model.elements.tetrahedra[e], split_pneumatic(rest), volume,
                         element_weight<4>(model, actuator.weight, volume, rest));
      }
    } else if (const auto* dea = actuator.as<DeaDrive>()) {
      ActuationSet<6>& set = sets.dea.emplace_back();
      set.actuator = index;
      for (const Index e : dea->prisms) {
        const RestShape<6> rest = rest_shape<6>(model.rest, model.elements.prisms[e]);
        add_actuation<6>(model, set, model.elements.prisms[e], split_dea(rest), mean_area(rest),
                         element_weight<6>(model, actuator.weight, model.elements.prism_volumes[e], rest));
      }
    }
  }
  const auto number = [&](auto& set, int k) {
    set.first_slot = sets.slots;
    sets.slots += set.count * k;
  };
  number(sets.tetrahedra, 4);
  number(sets.prisms, 6);
  for (auto& set : sets.cables) number(set, 3);
  for (auto& set : sets.pneumatic) number(set, 4);
  for (auto& set : sets.dea) number(set, 6);
  return sets;
}

}  // namespace softkin::target_shape
