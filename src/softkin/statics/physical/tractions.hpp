#pragma once

#include <softkin/model/mesh/triangle_points.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Loads on the body's surface that follow it: on each piece of its present area a pressure along the present normal n,
/// and a traction t that turns with the piece: R t - p n, R from the polar decomposition of the deformation of surface
/// and normal. They grow with the share of what is done at once.
///
/// Such loads have an energy only where their edges can not move. What is told is -p V of the pressures, V the volume
/// between the faces and the middle that they have at rest, and the work of the tractions as they are now on all of the
/// way from rest; the stiffness is the symmetric part of the derivative, the rest is a response.
///
/// source  Bonet, Wood 2008, Nonlinear continuum mechanics, section 8.5
class Tractions : public Term {
 public:
  /// model must outlive the object.
  explicit Tractions(const Model& model);

  /// Has it such loads?
  [[nodiscard]] static bool act(const Model& model);

  struct Scratch : Term::Scratch {
    double share = 0;  // of the last evaluation
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return std::make_unique<Scratch>(); }

  void evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const override;
  [[nodiscard]] bool conservative() const override { return false; }

  void add_cliques(linear::Cliques& cliques) override;
  void stiffness(const Iterate& at, const Demand& demand, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  [[nodiscard]] bool symmetric() const override { return false; }
  void add_response(const Iterate& at, const Points& moves, const Term::Scratch& scratch, Points& force) const override;

  void add_change(const Demand& from, const Demand& to, const Points& positions, Term::Scratch& scratch, Points& force,
                  Team& team) const override;
  [[nodiscard]] bool grows() const override { return true; }

 private:
  /// A place on a face, of whose area and frame at rest it knows.
  struct Place {
    const TrianglePoint* point;
    double area_mm2;            // at rest, the place's share of the face
    Eigen::Matrix2d to_frame;   // from the edges of the surface to a right-handed frame in it at rest
    Eigen::Vector2d along_MPa;  // the traction in that frame
    double outwards_MPa;        // and along the normal
  };
  struct Face {
    double pressure_MPa;
    std::vector<Index> nodes;
    std::vector<Place> places;
    std::int64_t slot;  // its first
  };
  class Load;
  using Blocks = std::array<std::array<Mat3, 6>, 6>;
  /// Calls visit(face, place, its load) for all places.
  template <class Visit>
  void each_place(const Points& positions, const Visit& visit) const;
  [[nodiscard]] Blocks slopes(const Face& face, const Points& positions) const;

  const Model& model_;
  std::vector<Face> faces_;
  Vec3 middle_{0, 0, 0};  // at rest
};

}  // namespace softkin::physical
