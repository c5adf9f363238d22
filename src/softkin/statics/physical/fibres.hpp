#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Fibres in the body's elements, which deform with these. A piece of length L has the energy L E A / 2 (s - 1)^2, s
/// being its stretch, and the tension E A (s - 1); both are zero below a stretch of 1 if it takes tension only.
class Fibres : public Term {
 public:
  /// model must outlive the object.
  explicit Fibres(const Model& model);

  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;
  void add_cliques(linear::Cliques& cliques) override;
  /// projected: without the negative stiffness of compressed pieces across their direction; the rest is positive.
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  [[nodiscard]] bool kinked() const override;
  void describe(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, ElementDeformation& out,
                Team& team) const override;

 private:
  /// A place among the vertices of its group.
  struct Place {
    std::vector<double> slopes;
    double length_mm = 0, stiffness_N = 0;
    bool tension_only = false;
  };
  /// Places of the same vertices.
  struct Group {
    std::vector<Index> vertices;
    std::vector<Place> places;
    std::int64_t slot = 0;  // its first
  };

  const std::vector<Fibre>& fibres_;
  std::vector<Group> groups_;
};

}  // namespace softkin::physical
