#pragma once

#include <algorithm>
#include <optional>
#include <softkin/core/large_vector.hpp>
#include <softkin/core/team.hpp>
#include <softkin/statics/physical/element_shapes.hpp>
#include <softkin/statics/physical/term.hpp>
#include <softkin/statics/physical/turning_magnets.hpp>

namespace softkin::physical {

/// A hard-magnetic body in applied fields. Per rest volume its energy is -(1 / mu_0) (R b_r) . b(x) where it turns
/// (TurningMagnets), and -(1 / mu_0) (F b_r) . b(x) where it stretches too, with the remanent flux density b_r of the
/// body at rest and the applied one, b, at the place x where the material is now.
///
/// The second is linear in F. In a uniform field the force on every vertex is a constant times the flux density,
/// whatever the shape: a dead force without stiffness. A field that varies in space also has stiffness, in the
/// elements' own slots.
///
/// source  Zhao, Kim, Cheng, Liu, Zhao, J. Mech. Phys. Solids 124, 2019; docs/magnetism.md
class Magnets : public Term {
 public:
  /// model  must outlive the object, and have magnetism
  /// slots  first one of every tetrahedron's matrices, then of every prism's
  Magnets(const Model& model, const std::vector<std::int64_t>& slots);

  /// The shape is forbidden where the field is not defined: outside a grid, on a wire.
  void evaluate(const Iterate& at, const LoadState& load_state, Scratch& scratch, Sum& sum, Team& team) const override;

  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Scratch& scratch, Points& force,
                  Team& team) const override;

  /// Adds second derivatives to the elements' slots. projected: they are made positive semidefinite at every quadrature
  /// point; for magnets that stretch, by the nearest such matrix in (F b_r, x)
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;

  void add_derivative(Index command, const LoadState& load_state, const Points& positions, Scratch& scratch,
                      Points& force, Team& team) const override;

  [[nodiscard]] MagneticLoad load(const LoadState& load_state, const Points& positions, Team& team) const;

  void describe(const Iterate& at, const LoadState& load_state, Scratch& /*scratch*/, ElementDeformation& out,
                Team& team) const override {
    out.magnetic = load(load_state, at.positions, team);
  }

  [[nodiscard]] bool loads(Index command) const override {
    return std::find(commands_.begin(), commands_.end(), command) != commands_.end();
  }
  /// Are there dipoles? They are proportional to the load factor.
  [[nodiscard]] bool grows() const override { return fields_.any_dipole(); }

 private:
  /// Elements of K nodes and Q quadrature points whose magnets stretch.
  template <int K, int Q>
  struct Set {
    std::vector<std::array<Index, K>> nodes;
    std::vector<std::int64_t> slots;
    std::vector<std::array<std::array<double, K>, Q>> poles;  // volume / mu_0 b_r . slope_a [N / mT]
    std::vector<std::array<double, Q>> volumes;               // at rest [mm^3]
    ElementShapes<K, Q> shapes;
  };
  template <int K, int Q, class Nodes>
  void add(Set<K, Q>& set, const Model& model, const Nodes& nodes, const Vec3& remanence, std::int64_t slot);
  template <class Visit>
  void each(const Visit& visit) const {
    visit(linear_);
    visit(quadratic_);
    visit(prisms_);
  }
  /// Returns the energy [mJ] in the fields of a setting and adds the gradient; none where a field is not defined.
  std::optional<double> add_gradient(const Fields::Setting& setting, const Points& positions, Points& gradient,
                                     Team& team) const;

  Fields fields_;
  std::vector<Index> commands_;  // of actuators of kind magnetic
  Index vertices_;
  TurningMagnets turning_;
  std::vector<std::pair<Index, double>> poles_;  // of a uniform field: vertex, force over flux density [N / mT]
  Set<4, 1> linear_;
  Set<10, 4> quadratic_;
  Set<6, 6> prisms_;
};

}  // namespace softkin::physical
