#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/energy/elastic.hpp>
#include <softkin/statics/physical/fibre_families.hpp>

namespace softkin::physical {

namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Matrix93 = Eigen::Matrix<double, 9, 3>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Smallest strain at which a family has its stiffness, so that it has it at rest.
constexpr double engaged = -1e-9;

/// Strain E of a family at a deformation, with its derivatives. Entry (i, j) of F stands at 3 j + i.
class FamilyStrain {
 public:
  FamilyStrain(const Mat3& f, const Mat3& structure) : structure_(structure), inverse_(f.inverse().transpose()) {
    const double j = f.determinant();
    scale_ = 1 / std::cbrt(j * j);
    stretched_ = f * structure;
    square_ = stretched_.cwiseProduct(f).sum();
    slope_ = 2 * scale_ * (stretched_ - square_ / 3 * inverse_);
  }

  [[nodiscard]] double value() const { return scale_ * square_ - 1; }
  [[nodiscard]] const Mat3& slope() const { return slope_; }

  /// How the slope changes with F.
  [[nodiscard]] Mat3 change(const Mat3& by) const {
    const double volume = inverse_.cwiseProduct(by).sum();
    return -2.0 / 3 * volume * slope_ + 2 * scale_ *
                                            (by * structure_ - 2.0 / 3 * stretched_.cwiseProduct(by).sum() * inverse_ +
                                             square_ / 3 * inverse_ * by.transpose() * inverse_);
  }

 private:
  const Mat3& structure_;
  Mat3 inverse_;  // F^-T
  Mat3 stretched_, slope_;
  double scale_, square_;
};

/// Energy per volume of a family at a strain above 0, and its two derivatives [MPa]. Not finite at too large a strain.
struct FamilyLaw {
  double energy, slope, second;

  FamilyLaw(double k1_MPa, double k2, double strain) {
    const double power = k2 * strain * strain, grown = std::exp(power);
    energy = k2 > 0 ? k1_MPa / (2 * k2) * std::expm1(power) : k1_MPa / 2 * strain * strain;
    slope = k1_MPa * strain * grown;
    second = k1_MPa * (1 + 2 * power) * grown;
  }
  [[nodiscard]] bool finite() const { return std::isfinite(energy) && std::isfinite(second); }
};

template <int K>
Eigen::Matrix<double, 3, K> nodes_at(const Points& positions, const std::array<Index, K>& nodes) {
  Eigen::Matrix<double, 3, K> at;
  for (int i = 0; i < K; ++i) at.col(i) = positions.row(nodes[i]).transpose();
  return at;
}

/// Adds P [MPa], the first Piola-Kirchhoff stress, and the energy per volume of a point; false where there is no
/// energy.
template <class Families>
bool add_force(const Mat3& f, const Families& families, Mat3& force, double& energy) {
  if (!(f.determinant() > 0)) return false;
  for (const auto& family : families) {
    const FamilyStrain strain(f, family.structure);
    if (!(strain.value() > 0)) continue;
    const FamilyLaw law(family.k1_MPa, family.k2, strain.value());
    if (!law.finite()) return false;
    force += law.slope * strain.slope();
    energy += law.energy;
  }
  return true;
}

/// Second derivative of a point's energy per volume by F [MPa].
template <class Families>
Matrix9 second_derivative(const Mat3& f, const Families& families, bool projected) {
  Matrix9 second = Matrix9::Zero();
  if (!(f.determinant() > 0)) return second;
  for (const auto& family : families) {
    const FamilyStrain strain(f, family.structure);
    if (!(strain.value() > engaged)) continue;
    const FamilyLaw law(family.k1_MPa, family.k2, std::max(0.0, strain.value()));
    if (!law.finite()) continue;
    const Eigen::Map<const Vector9> slope(strain.slope().data());
    second += law.second * slope * slope.transpose();
    for (int entry = 0; entry < 9; ++entry) {
      Mat3 by = Mat3::Zero();
      by.data()[entry] = 1;
      const Mat3 change = law.slope * strain.change(by);
      second.col(entry) += Eigen::Map<const Vector9>(change.data());
    }
  }
  if (!projected || second.isZero(0)) return second;
  const SymmetricEigen eigen = symmetric_eigen(second);
  return eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() * eigen.vectors.transpose();
}

}  // namespace

bool FibreFamilies::any(const Model& model) {
  return std::any_of(model.elements.materials.begin(), model.elements.materials.end(),
                     [](const Material& material) { return material.families != nullptr; });
}

template <int K, int Q, class Nodes>
void FibreFamilies::add(Elements<K, Q>& elements, const Model& model, const Nodes& nodes,
                        std::vector<Family>&& families, Index number, std::int64_t slot) {
  places_[number] = elements.size();
  Element<K, Q>& element = elements.emplace_back();
  std::copy(nodes.begin(), nodes.end(), element.nodes.begin());
  Eigen::Matrix<double, K, 3> rest;
  for (int i = 0; i < K; ++i) rest.row(i) = model.rest.row(element.nodes[i]);
  const energy::ElasticRest<K, Q> shape = energy::elastic_rest(rest);
  for (std::size_t q = 0; q < Q; ++q) {
    element.slopes[q] = shape.slope[q];
    element.volumes[q] = shape.volume[q];
  }
  element.families = std::move(families);
  element.slot = slot;
}

FibreFamilies::FibreFamilies(const Model& model, const std::vector<std::int64_t>& slots)
    : places_(model.elements.tetrahedra.size() + model.elements.prisms.size(), -1),
      tetrahedra_(model.elements.tetrahedra.size()) {
  for (const Material& material : model.elements.materials) {
    if (!material.families) continue;
    const Families& all = *material.families;
    const auto of_element = [&](std::size_t place) {
      std::vector<Family> families;
      for (const Families::Family& family : all.families) {
        const Vec3& d = family.directions[place];
        families.push_back({family.k1_MPa, family.k2,
                            family.dispersion * Mat3::Identity() + (1 - 3 * family.dispersion) * d * d.transpose()});
      }
      return families;
    };
    for (std::size_t i = 0; i < all.tetrahedra.size(); ++i) {
      const std::size_t e = all.tetrahedra[i];
      if (model.elements.edge_nodes.empty()) {
        add(linear_, model, model.elements.tetrahedra[e], of_element(i), all.tetrahedra[i], slots[e]);
        continue;
      }
      std::array<Index, 10> nodes;
      std::copy(model.elements.tetrahedra[e].begin(), model.elements.tetrahedra[e].end(), nodes.begin());
      std::copy(model.elements.edge_nodes[e].begin(), model.elements.edge_nodes[e].end(), nodes.begin() + 4);
      add(quadratic_, model, nodes, of_element(i), all.tetrahedra[i], slots[e]);
    }
    for (std::size_t i = 0; i < all.prisms.size(); ++i) {
      const auto e = static_cast<std::size_t>(all.prisms[i]), number = model.elements.tetrahedra.size() + e;
      add(prisms_, model, model.elements.prisms[e], of_element(all.tetrahedra.size() + i), static_cast<Index>(number),
          slots[number]);
    }
  }
}

std::unique_ptr<Term::Scratch> FibreFamilies::new_scratch() const {
  auto scratch = std::make_unique<Scratch>();
  scratch->pulls.resize(12 * linear_.size() + 30 * quadratic_.size() + 18 * prisms_.size());
  return scratch;
}

void FibreFamilies::evaluate(const Iterate& at, const LoadState& /*load_state*/, Term::Scratch& scratch, Sum& sum,
                             Team& team) const {
  std::vector<double>& pulls = static_cast<Scratch&>(scratch).pulls;
  std::atomic<bool> known = true;
  std::vector<double> energies;
  each([&]<int K, int Q>(const Elements<K, Q>& elements, std::size_t first) {
    energies.assign(elements.size(), 0);
    using Pulls = Eigen::Map<Eigen::Matrix<double, 3, K>>;
    team.pieces(elements.size(), [&](Index begin, Index end) {
      for (std::size_t e = begin; e < static_cast<std::size_t>(end); ++e) {
        const Element<K, Q>& element = elements[e];
        const Eigen::Matrix<double, 3, K> nodes = nodes_at<K>(at.positions, element.nodes);
        Pulls pull(pulls.data() + first + 3 * K * e);
        pull.setZero();
        for (std::size_t q = 0; q < Q; ++q) {
          Mat3 force = Mat3::Zero();
          double energy = 0;
          if (!add_force(nodes * element.slopes[q], element.families, force, energy)) known = false;
          pull += element.volumes[q] * force * element.slopes[q].transpose();
          energies[e] += element.volumes[q] * energy;
        }
      }
    });
    for (std::size_t e = 0; e < elements.size(); ++e) {  // by one thread: elements have vertices in common
      const Pulls pull(pulls.data() + first + 3 * K * e);
      for (int i = 0; i < K; ++i) sum.gradient.row(elements[e].nodes[i]) += pull.col(i).transpose();
      sum.energy += energies[e];
    }
  });
  sum.forbidden = sum.forbidden || !known;
}

void FibreFamilies::stiffness(const Iterate& at, const LoadState& /*load_state*/, bool projected,
                              Term::Scratch& /*scratch*/, LargeVector<double>& slots, Team& team) const {
  using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  each([&]<int K, int Q>(const Elements<K, Q>& elements, std::size_t /*first*/) {
    team.pieces(elements.size(), [&](Index begin, Index end) {
      for (std::size_t e = begin; e < static_cast<std::size_t>(end); ++e) {
        const Element<K, Q>& element = elements[e];
        const Eigen::Matrix<double, 3, K> nodes = nodes_at<K>(at.positions, element.nodes);
        for (std::size_t q = 0; q < Q; ++q) {
          const auto& slopes = element.slopes[q];
          const Matrix9 second =
              element.volumes[q] * second_derivative(Mat3(nodes * slopes), element.families, projected);
          if (second.isZero(0)) continue;
          double* slot = slots.data() + 9 * element.slot;
          for (int a = 0; a < K; ++a) {
            Matrix93 by_a = Matrix93::Zero();  // derivative of P by the position of a node
            for (int k = 0; k < 3; ++k) by_a += slopes(a, k) * second.middleCols<3>(3 * k);
            for (int b = 0; b <= a; ++b, slot += 9) {
              Mat3 block = Mat3::Zero();
              for (int k = 0; k < 3; ++k) block += slopes(b, k) * by_a.middleRows<3>(3 * k);
              Block(slot, 3, 3) += block.transpose();
            }
          }
        }
      }
    });
  });
}

Mat3 FibreFamilies::stress(Index element, int point, const Points& positions) const {
  const Index place = places_[element];
  Mat3 stress = Mat3::Zero();
  if (place < 0) return stress;
  const auto of = [&]<int K, int Q>(const Elements<K, Q>& elements) {
    const Element<K, Q>& own = elements[place];
    const Mat3 f = nodes_at<K>(positions, own.nodes) * own.slopes[point];
    double energy = 0;
    if (add_force(f, own.families, stress, energy)) stress = (stress * f.transpose() / f.determinant()).eval();
  };
  if (element >= tetrahedra_)
    of(prisms_);
  else if (!linear_.empty())
    of(linear_);
  else
    of(quadratic_);
  return stress;
}

}  // namespace softkin::physical
