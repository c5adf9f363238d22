#pragma once

#include <softkin/model/mesh/triangle_points.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/physical/node_loads.hpp>

namespace softkin::physical {

/// Loads on the body's surface that follow it: on each piece of its present area a pressure along the present normal n,
/// and a traction t that turns with the piece: R t - p n, R from the polar decomposition of the deformation of surface
/// and normal. They grow with the load factor, except for pressures that are commanded.
///
/// Such loads have an energy only where their edges cannot move. The reported energy is -p V of the pressures, V being
/// the volume between the faces and the centre that they have at rest, and the work of the present tractions on the
/// whole motion from rest. The stiffness is the symmetric part of the derivative; the rest is a response.
///
/// source  Bonet, Wood 2008, Nonlinear continuum mechanics, section 8.5
class Tractions : public NodeLoads {
 public:
  /// model must outlive the object.
  explicit Tractions(const Model& model);

  /// Does the model have such loads?
  [[nodiscard]] static bool act(const Model& model);

  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;
  [[nodiscard]] bool conservative() const override { return false; }
  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Term::Scratch& scratch,
                  Points& force, Team& team) const override;
  void add_derivative(Index command, const LoadState& load_state, const Points& positions, Term::Scratch& scratch,
                      Points& force, Team& team) const override;
  [[nodiscard]] bool loads(Index command) const override;
  [[nodiscard]] bool grows() const override { return grows_; }

 private:
  /// A quadrature point of a face, with its area and frame at rest.
  struct Place {
    const TrianglePoint* point;
    double area_mm2;            // at rest, the part of the face that belongs to it
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
  [[nodiscard]] static double scale_of(const Face& face, const LoadState& load_state) {
    return face.command < 0 ? load_state.load_factor : load_state.actuation[face.command];
  }
  [[nodiscard]] double scale(std::size_t face, const LoadState& load_state) const override {
    return scale_of(faces_[face], load_state);
  }

  const Model& model_;
  std::vector<Face> faces_;
  Vec3 middle_{0, 0, 0};  // at rest
  bool grows_ = false;
};

}  // namespace softkin::physical
