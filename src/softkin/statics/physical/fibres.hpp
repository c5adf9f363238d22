#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Threads that the body's elements carry along. A piece of length L has the energy L E A / 2 (s - 1)^2, s its stretch,
/// and the tension E A (s - 1); one that takes tension only neither below a stretch of 1.
class Fibres : public Term {
 public:
  /// model must outlive the object.
  explicit Fibres(const Model& model);

  void evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const override;
  void add_cliques(linear::Cliques& cliques) override;
  /// projected: what pressed pieces lose across their direction is left out, all else is positive.
  void stiffness(const Iterate& at, const Demand& demand, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  [[nodiscard]] bool kinked() const override;
  void tell(const Iterate& at, const Demand& demand, Term::Scratch& scratch, ElementDeformation& out,
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
