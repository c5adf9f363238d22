#pragma once

#include <softkin/energy/bending.hpp>
#include <softkin/energy/sheet.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Thin sheets: membranes on faces of the body, of thickness times the energy of their strain in the plane, and plates
/// of order 2, by their curvature and the angles that their slopes jump by from face to face.
class Layers : public Term {
 public:
  /// model must outlive the object.
  explicit Layers(const Model& model);

  void evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const override;
  void add_cliques(linear::Cliques& cliques) override;
  /// projected: stresses that press are left out; what bends is projected place by place.
  void stiffness(const Iterate& at, const Demand& demand, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  [[nodiscard]] bool kinked() const override;
  void tell(const Iterate& at, const Demand& demand, Term::Scratch& scratch, ElementDeformation& out,
            Team& team) const override;

 private:
  /// Places of the same vertices.
  struct Face {
    const SheetLaw* law;
    double thickness_mm;
    std::vector<Index> vertices;
    std::vector<const LayerPlace*> places;
    std::vector<std::vector<std::size_t>> orders;  // of each place's vertices, ascending
    std::int64_t slot = 0;                         // its first
  };
  /// A place that bends: of its vertices the parts of the columns that its energy is of.
  template <int Columns>
  struct Bent {
    std::vector<Index> vertices;
    std::vector<Eigen::Matrix<double, Columns, 1>> parts;
    std::int64_t slot = 0;  // its first
  };
  struct Place : Bent<5> {
    const BendingPlace* of;
  };
  struct Joint : Bent<6> {
    const BendingJoint* of;
  };
  void add_membrane(const Layer& layer);
  void add_bending(const Layer& layer);
  [[nodiscard]] static energy::BendingResponse<15> bend(const Place& place, const Points& positions, bool second);
  [[nodiscard]] static energy::BendingResponse<18> bend(const Joint& joint, const Points& positions, bool second);

  const Model& model_;
  std::vector<Face> faces_;
  std::vector<Place> places_;
  std::vector<Joint> joints_;
};

}  // namespace softkin::physical
