#pragma once

#include <optional>
#include <softkin/core/large_vector.hpp>
#include <softkin/core/team.hpp>
#include <softkin/energy/magnet.hpp>
#include <softkin/statics/physical/fields.hpp>

namespace softkin::physical {

/// Magnets that turn with their material and do not stretch, in applied fields: -(1 / mu_0) (R b_r) . b(x) per rest
/// volume, R being the rotation of F = R U (energy/magnet.hpp).
class TurningMagnets {
 public:
  /// slots  first one of every tetrahedron's matrices, then of every prism's
  TurningMagnets(const Model& model, const std::vector<std::int64_t>& slots);

  /// Energy [mJ]; adds the gradient [N]. None where the field is not known: outside a grid, on a wire.
  [[nodiscard]] std::optional<double> add_gradient(const Fields& fields, const Fields::Setting& setting,
                                                   const Points& positions, Points& gradient, Team& team) const;

  /// Adds second derivatives to what is in the elements' slots [N/mm].
  void add_stiffness(const Fields& fields, const Fields::Setting& setting, const Points& positions, bool projected,
                     LargeVector<double>& slots, Team& team) const;

  /// Adds the volume of the magnets at rest, and the integral of the position over it.
  void add_places(const Points& positions, double& volume, Vec3& sum) const;

 private:
  /// `lanes` elements to a block, in the order of their slots, which keeps neighbours together; the last block repeats
  /// the last element, without moment.
  template <int K, int Q>
  struct Set {
    Index count = 0;
    std::vector<energy::MagnetBlock<K, Q>> blocks;
    std::vector<std::array<std::array<Index, energy::lanes>, K>> nodes;
    std::vector<std::int64_t> slots;             // of every element
    std::vector<std::array<double, Q>> volumes;  // the same [mm^3]
  };
  template <int K, int Q, class Nodes>
  void add(Set<K, Q>& set, const Model& model, const Nodes& nodes, const Vec3& remanence, std::int64_t slot);
  template <class Visit>
  void each(const Visit& visit) const {
    if (linear_.count > 0) visit(linear_);
    if (quadratic_.count > 0) visit(quadratic_);
    if (prisms_.count > 0) visit(prisms_);
  }

  Set<4, 1> linear_;
  Set<10, 4> quadratic_;
  Set<6, 6> prisms_;
};

}  // namespace softkin::physical
