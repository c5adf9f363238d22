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

  struct Scratch : Term::Scratch {
    Eigen::VectorXd pulls;  // of each vertex, sum of magnitudes [N]
    double barrier = 0;     // of what takes tension only; 0: it has kinks. See energy::smooth_sheet_response()
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return std::make_unique<Scratch>(); }

  /// Is there a vertex that layers alone hold? A flat sheet has no stiffness across itself, or hardly any: one that
  /// bends counts where a chamber begins flat.
  [[nodiscard]] bool limp() const { return !alone_.empty(); }
  /// Are these where they were cut?
  [[nodiscard]] bool flat(const Points& positions) const;
  /// These vertices.
  [[nodiscard]] const std::vector<Index>& alone() const { return alone_; }
  /// Adds to the forces what moves of the vertices call up under a tension of 1 N/mm in every direction, which is all
  /// that the sheets are taken to resist with [N].
  void add_tension(const Points& moves, Points& forces) const;
  /// The largest of a layer along its direction, times its thickness [N/mm].
  [[nodiscard]] double stiffness_N_mm() const;
  /// Mean magnitude of the slopes of moves, over the area.
  [[nodiscard]] double mean_slope(const Points& moves) const;

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
  std::vector<Index> alone_;
  std::vector<Face> faces_;
  std::vector<Place> places_;
  std::vector<Joint> joints_;
};

}  // namespace softkin::physical
