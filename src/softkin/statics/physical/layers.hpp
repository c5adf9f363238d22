#pragma once

#include <softkin/energy/bending.hpp>
#include <softkin/energy/sheet.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Thin sheets: membranes on faces of the body, with the energy of their strain in the plane times the thickness, and
/// plates of order 2, with the energy of their curvature and of the jumps of their slopes from face to face.
class Layers : public Term {
 public:
  /// model must outlive the object.
  explicit Layers(const Model& model);

  struct Scratch : Term::Scratch {
    Eigen::VectorXd pulls;  // internal force on each vertex, sum of magnitudes [N]
    double barrier = 0;     // smoothing of tension-only sheets; 0: none. See energy::smooth_sheet_response()
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return std::make_unique<Scratch>(); }

  /// Is there a vertex that belongs to layers alone? A flat sheet has no transverse stiffness, or hardly any. A sheet
  /// with bending stiffness counts if it belongs to a chamber that is flat at rest.
  [[nodiscard]] bool has_wrinkling() const { return !alone_.empty(); }
  /// Are these vertices at their positions at rest?
  [[nodiscard]] bool flat(const Points& positions) const;
  /// Returns these vertices.
  [[nodiscard]] const std::vector<Index>& alone() const { return alone_; }
  /// Adds the forces that moves of the vertices cause under a uniform tension of 1 N/mm, the only resistance that the
  /// sheets are assumed to have [N].
  void add_tension(const Points& moves, Points& forces) const;
  /// Returns the largest stiffness of a layer along its direction, times its thickness [N/mm].
  [[nodiscard]] double stiffness_N_mm() const;
  /// Returns the mean magnitude of the slopes of moves over the area.
  [[nodiscard]] double mean_slope(const Points& moves) const;

  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;
  void add_cliques(linear::Cliques& cliques) override;
  /// projected: compressive stresses are omitted; bending is projected place by place.
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  [[nodiscard]] bool kinked() const override;
  void describe(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, ElementDeformation& out,
                Team& team) const override;

 private:
  /// Places with the same vertices.
  struct Face {
    const SheetLaw* law;
    double thickness_mm;
    std::vector<Index> vertices;
    std::vector<const LayerPlace*> places;
    std::vector<std::vector<std::size_t>> orders;  // of each place's vertices, ascending
    std::int64_t slot = 0;                         // its first
  };
  /// A place with bending: for each of its vertices the coefficients of the columns on which its energy depends.
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
