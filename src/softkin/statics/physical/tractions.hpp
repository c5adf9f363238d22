#pragma once

#include <softkin/model/mesh/triangle_points.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/physical/node_loads.hpp>

namespace softkin::physical {

/// Loads on the body's surface that follow it: on each piece of its present area a pressure along the present normal n,
/// and a traction t that turns with the piece: R t - p n, R from the polar decomposition of the deformation of surface
/// and normal. They grow with the share of what is done at once, but for pressures that are commanded.
///
/// Such loads have an energy only where their edges can not move. What is told is -p V of the pressures, V the volume
/// between the faces and the middle that they have at rest, and the work of the tractions as they are now on all of the
/// way from rest; the stiffness is the symmetric part of the derivative, the rest is a response.
///
/// source  Bonet, Wood 2008, Nonlinear continuum mechanics, section 8.5
class Tractions : public NodeLoads {
 public:
  /// model must outlive the object.
  explicit Tractions(const Model& model);

  /// Has it such loads?
  [[nodiscard]] static bool act(const Model& model);

  void evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const override;
  [[nodiscard]] bool conservative() const override { return false; }
  void add_change(const Demand& from, const Demand& to, const Points& positions, Term::Scratch& scratch, Points& force,
                  Team& team) const override;
  void add_derivative(Index command, const Demand& demand, const Points& positions, Term::Scratch& scratch,
                      Points& force, Team& team) const override;
  [[nodiscard]] bool loads(Index command) const override;
  [[nodiscard]] bool grows() const override { return grows_; }

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
    double pressure_MPa;  // of one that is commanded: at 1 kPa
    Index command;        // -1: none
    std::vector<Index> nodes;
    std::vector<Place> places;
  };
  class Load;
  /// Calls visit(face, place, its load) for all places.
  template <class Visit>
  void each_place(const Points& positions, const Visit& visit) const;
  [[nodiscard]] std::size_t parts() const override { return faces_.size(); }
  [[nodiscard]] const std::vector<Index>& nodes_of_part(std::size_t face) const override { return faces_[face].nodes; }
  [[nodiscard]] Blocks slopes(std::size_t face, const Points& positions) const override;
  [[nodiscard]] static double scale_of(const Face& face, const Demand& demand) {
    return face.command < 0 ? demand.share : demand.actuation[face.command];
  }
  [[nodiscard]] double scale(std::size_t face, const Demand& demand) const override {
    return scale_of(faces_[face], demand);
  }

  const Model& model_;
  std::vector<Face> faces_;
  Vec3 middle_{0, 0, 0};  // at rest
  bool grows_ = false;
};

}  // namespace softkin::physical
