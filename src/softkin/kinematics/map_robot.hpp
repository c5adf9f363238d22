#pragma once

#include <memory>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// A robot that consists of its map, with a shape or without: its vertices are its markers, and two per cable, at a
/// distance equal to its length. Functions that need markers, loads and commands alone work with it as with the robot:
/// solve_inverse, follow_path.
class MapRobot {
 public:
  /// map must be of the model (runs::check_robot), and outlive the object.
  MapRobot(const Model& model, const KinematicMap& map);
  MapRobot(const MapRobot&) = delete;
  MapRobot& operator=(const MapRobot&) = delete;

  /// Belongs to statics() alone: its vertices are those of no mesh. Lives as long as the object.
  [[nodiscard]] const Model& model() const { return model_; }
  /// Returns its equilibria, which the map evaluates. It lives as long as the object.
  [[nodiscard]] const Statics& statics() const { return statics_; }

 private:
  Model model_;
  Statics statics_;
};

/// Returns the equilibria of a robot by its solver; by its map alone; or by the solver with those of the map as initial
/// guesses (polish). A map evaluates whole shapes, in which the vertices around a marker are moved to agree with its
/// own, more accurate polynomials.
///
/// model, map  must outlive the object, and belong together (runs::check_robot); map may be null: there is none
/// throws      InvalidInput on a map without shape
[[nodiscard]] Statics statics_by(const Model& model, const KinematicMap* map, bool polish);

/// Runs solve_inverse_from() by the map alone, and again by the solver from that result, in a few equilibria; by the
/// solver alone where the map has no equilibrium at the start.
///
/// statics  of the model, whose solves begin at the map's equilibria: statics_by(), polish
/// returns  counts and history are those of the solver
[[nodiscard]] InverseResult solve_inverse_by_map(const Model& model, const KinematicMap& map, const Statics& statics,
                                                 const std::vector<Goal>& goals, const Actuation& start,
                                                 const InverseOptions& options = {},
                                                 const ProgressCallback& progress = {});

}  // namespace softkin
