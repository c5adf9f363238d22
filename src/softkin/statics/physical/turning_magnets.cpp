#include <algorithm>
#include <atomic>
#include <softkin/energy/elastic.hpp>
#include <softkin/statics/physical/element_shapes.hpp>
#include <softkin/statics/physical/load_block.hpp>
#include <softkin/statics/physical/turning_magnets.hpp>

namespace softkin::physical {

using energy::lanes;

namespace {

void put(energy::Pack3& vector, int lane, const Vec3& value) {
  vector.x[lane] = value[0];
  vector.y[lane] = value[1];
  vector.z[lane] = value[2];
}

energy::Pack3 everywhere(const Vec3& vector) {
  return {energy::pack(vector[0]), energy::pack(vector[1]), energy::pack(vector[2])};
}

/// Flux density of a field that is the same everywhere.
template <int Q>
energy::FluxBlock<Q> uniform_flux(const Fields::Setting& setting) {
  energy::FluxBlock<Q> flux;
  flux.in_space = setting.in_space();
  for (energy::FluxPoint& point : flux.point) point.value = everywhere(setting.uniform);
  return flux;
}

/// Flux density of a field that varies in space, at the first `count` elements of a block. False where it is not known
/// for one of them: the shape is forbidden.
template <int K, int Q>
bool set_flux(const Fields& fields, const Fields::Setting& setting, const energy::MagnetBlock<K, Q>& block,
              const energy::Shape<K>& shape, Index count, bool second, energy::FluxBlock<Q>& out) {
  if (!out.in_space) return true;
  bool known = true;
  for (int q = 0; q < Q; ++q) {
    energy::Pack3 place{};
    for (int i = 0; i < K; ++i) place = place + energy::pack(block.shape[q][i]) * shape[i];
    known = fields.flux(setting, place, count, second, out.point[q]) && known;
    out.point[q].value = out.point[q].value + everywhere(setting.uniform);
  }
  return known;
}

}  // namespace

template <int K, int Q, class Nodes>
void TurningMagnets::add(Set<K, Q>& set, const Model& model, const Nodes& nodes, const Vec3& remanence,
                         std::int64_t slot) {
  Eigen::Matrix<double, K, 3> rest;
  for (int i = 0; i < K; ++i) rest.row(i) = model.rest.row(nodes[i]);
  const energy::ElasticRest<K, Q> shape = energy::elastic_rest(rest);
  const int lane = set.count++ % lanes;
  if (lane == 0) {
    set.nodes.emplace_back();
    ElementShapes<K, Q> shapes;
    set_shapes(shapes);
    energy::MagnetBlock<K, Q>& block = set.blocks.emplace_back();
    for (int q = 0; q < Q; ++q) std::copy(shapes[q].begin(), shapes[q].end(), block.shape[q]);
  }
  energy::MagnetBlock<K, Q>& block = set.blocks.back();
  auto& volumes = set.volumes.emplace_back();
  set.slots.push_back(slot);
  for (int l = lane; l < lanes; ++l) {  // later elements overwrite the lanes that this one fills in advance
    for (int q = 0; q < Q; ++q) {
      volumes[q] = shape.volume[q];
      put(block.moment[q], l, l == lane ? Vec3(inverse_permeability * shape.volume[q] * remanence) : Vec3(0, 0, 0));
      for (int i = 0; i < K; ++i) put(block.slope[q][i], l, shape.slope[q].row(i).transpose());
    }
    for (int i = 0; i < K; ++i) set.nodes.back()[i][l] = nodes[i];
  }
}

TurningMagnets::TurningMagnets(const Model& model, const std::vector<std::int64_t>& slots) {
  const Magnetism& magnetism = *model.magnetism;
  const std::size_t tetrahedra = model.elements.tetrahedra.size();
  std::vector<std::size_t> order;
  for (std::size_t e = 0; e < magnetism.remanence.size(); ++e)
    if (magnetism.magnetisation[e] == Magnetisation::turns && !magnetism.remanence[e].isZero(0)) order.push_back(e);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return slots[a] < slots[b]; });
  for (const std::size_t e : order) {
    const Vec3& remanence = magnetism.remanence[e];
    if (e >= tetrahedra) {
      add(prisms_, model, model.elements.prisms[e - tetrahedra], remanence, slots[e]);
    } else if (model.elements.edge_nodes.empty()) {
      add(linear_, model, model.elements.tetrahedra[e], remanence, slots[e]);
    } else {
      std::array<Index, 10> nodes;
      std::copy(model.elements.tetrahedra[e].begin(), model.elements.tetrahedra[e].end(), nodes.begin());
      std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
      add(quadratic_, model, nodes, remanence, slots[e]);
    }
  }
}

std::optional<double> TurningMagnets::add_gradient(const Fields& fields, const Fields::Setting& setting,
                                                   const Points& positions, Points& gradient, Team& team) const {
  double sum = 0;
  std::atomic<bool> known = true;
  each([&]<int K, int Q>(const Set<K, Q>& set) {
    struct Pull {
      energy::Shape<K> gradient;
      energy::Pack energy;
    };
    const Index count = set.blocks.size();
    LargeVector<Pull> pulls(set.blocks.size());
    team.pieces(count, [&](Index begin, Index end) {
      energy::Shape<K> shape;
      energy::FluxBlock<Q> flux = uniform_flux<Q>(setting);
      for (Index b = begin; b < end; ++b) {
        const Index elements = std::min<Index>(lanes, set.count - lanes * b);
        load<K>(positions, set.nodes[b], shape);
        if (!set_flux<K, Q>(fields, setting, set.blocks[b], shape, elements, false, flux)) known = false;
        magnet_force<K, Q>(set.blocks[b], flux, shape, pulls[b].gradient, pulls[b].energy);
      }
    });
    for (Index b = 0; b < count; ++b) {  // by one thread: elements have common vertices
      const Pull& pull = pulls[b];
      for (int l = 0; l < std::min<Index>(lanes, set.count - lanes * b); ++l) {
        sum += pull.energy[l];
        for (int i = 0; i < K; ++i) {
          double* at = gradient.data() + 3 * static_cast<std::ptrdiff_t>(set.nodes[b][i][l]);
          at[0] += pull.gradient[i].x[l];
          at[1] += pull.gradient[i].y[l];
          at[2] += pull.gradient[i].z[l];
        }
      }
    }
  });
  if (!known) return std::nullopt;
  return sum;
}

void TurningMagnets::add_stiffness(const Fields& fields, const Fields::Setting& setting, const Points& positions,
                                   bool projected, LargeVector<double>& slots, Team& team) const {
  each([&]<int K, int Q>(const Set<K, Q>& set) {
    constexpr int matrices = K * (K + 1) / 2;
    team.pieces(set.blocks.size(), [&](Index begin, Index end) {
      energy::Shape<K> shape;
      energy::FluxBlock<Q> flux = uniform_flux<Q>(setting);
      energy::ElasticStiffness<K> out;
      for (Index b = begin; b < end; ++b) {
        const Index elements = std::min<Index>(lanes, set.count - lanes * b);
        load<K>(positions, set.nodes[b], shape);
        if (!set_flux<K, Q>(fields, setting, set.blocks[b], shape, elements, true, flux)) continue;
        magnet_stiffness<K, Q>(set.blocks[b], flux, shape, projected, out);
        for (Index l = 0; l < elements; ++l) {
          double* slot = slots.data() + 9 * set.slots[lanes * b + l];
          for (int m = 0; m < matrices; ++m, slot += 9)
            for (int r = 0; r < 3; ++r) {
              slot[3 * r] += out.block[m].row[r].x[l];
              slot[3 * r + 1] += out.block[m].row[r].y[l];
              slot[3 * r + 2] += out.block[m].row[r].z[l];
            }
        }
      }
    });
  });
}

void TurningMagnets::add_places(const Points& positions, double& volume, Vec3& sum) const {
  each([&]<int K, int Q>(const Set<K, Q>& set) {
    for (Index e = 0; e < set.count; ++e)
      for (int q = 0; q < Q; ++q) {
        const double part = set.volumes[e][q];
        volume += part;
        for (int i = 0; i < K; ++i)
          sum +=
              part * set.blocks[e / lanes].shape[q][i] * positions.row(set.nodes[e / lanes][i][e % lanes]).transpose();
      }
  });
}

}  // namespace softkin::physical
