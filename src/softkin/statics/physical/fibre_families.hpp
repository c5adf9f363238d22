#pragma once

#include <optional>
#include <softkin/model/families.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Families of fibres in materials (model/families.hpp), in addition to the isotropic law of the elements, in their own
/// slots.
///
/// With H = kappa I + (1 - 3 kappa) d d^T the strain of a family is E = J^(-2/3) tr(F H F^T) - 1. There is no energy
/// where an element is inverted, or a fibre so long that exp(k2 E^2) overflows.
class FibreFamilies : public Term {
 public:
  /// model  must outlive the object
  /// slots  first one of every tetrahedron's matrices, then of every prism's
  FibreFamilies(const Model& model, const std::vector<std::int64_t>& slots);

  [[nodiscard]] static bool any(const Model& model);

  struct Scratch : Term::Scratch {
    std::vector<double> pulls;  // 3 per node of every element [N]
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override;

  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  /// Compressed fibres carry nothing.
  [[nodiscard]] bool kinked() const override { return true; }

  /// Their contribution to the Cauchy stress of an element at a quadrature point [MPa]; tetrahedra first, then prisms.
  [[nodiscard]] Mat3 stress(Index element, int point, const Points& positions) const;

 private:
  struct Family {
    double k1_MPa, k2;
    Mat3 structure;  // H
  };
  template <int K, int Q>
  struct Element {
    std::array<Index, K> nodes;
    std::array<Eigen::Matrix<double, K, 3>, Q> slopes;  // of the shape functions at rest [1/mm]
    std::array<double, Q> volumes;                      // [mm^3]
    std::vector<Family> families;
    std::int64_t slot;
  };
  template <int K, int Q>
  using Elements = std::vector<Element<K, Q>>;

  template <int K, int Q, class Nodes>
  void add(Elements<K, Q>& elements, const Model& model, const Nodes& nodes, std::vector<Family>&& families,
           Index number, std::int64_t slot);
  /// visit(elements, the first number of their pulls)
  template <class Visit>
  void each(const Visit& visit) const {
    visit(linear_, std::size_t{0});
    visit(quadratic_, 12 * linear_.size());
    visit(prisms_, 12 * linear_.size() + 30 * quadratic_.size());
  }

  Elements<4, 1> linear_;
  Elements<10, 4> quadratic_;
  Elements<6, 6> prisms_;
  std::vector<Index> places_;  // of every element of the model among those of its kind; -1: it has no fibres
  Index tetrahedra_;
};

}  // namespace softkin::physical
