#pragma once

#include <memory>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// A robot as its map knows it, with a shape or without: its vertices are its markers, and two per cable that are as
/// far apart as its path is long. What needs markers, loads and commands alone works with it as with the robot:
/// solve_inverse, follow_path.
class MapRobot {
 public:
  /// map must be of the model (runs::check_robot), and outlive the object.
  MapRobot(const Model& model, const KinematicMap& map);
  MapRobot(const MapRobot&) = delete;
  MapRobot& operator=(const MapRobot&) = delete;

  /// Belongs to statics() alone: its vertices are those of no mesh. Lives as long as the object.
  [[nodiscard]] const Model& model() const { return model_; }
  /// Its equilibria, which the map gives. Lives as long as the object.
  [[nodiscard]] const Statics& statics() const { return statics_; }

 private:
  Model model_;
  Statics statics_;
};

/// Equilibria of a robot by its solver; by its map alone; or by the solver begun at those of the map (polish). A map
/// gives whole shapes, in which the vertices around a marker are moved by what its own, more accurate polynomials say.
///
/// model, map  must outlive the object, and belong together (runs::check_robot); map may be null: there is none
/// throws      InvalidInput on a map without shape
[[nodiscard]] Statics statics_by(const Model& model, const KinematicMap* map, bool polish);

/// solve_inverse_from() by the map alone, and again by the solver from what that found: a few equilibria. Where the map
/// has no equilibrium at the start, by the solver alone.
///
/// statics  of the model, whose solves begin at the map's equilibria: statics_by(), polish
/// returns  counts and history are those of the solver
[[nodiscard]] InverseResult solve_inverse_by_map(const Model& model, const KinematicMap& map, const Statics& statics,
                                                 const std::vector<Goal>& goals, const Actuation& start,
                                                 const InverseOptions& options = {},
                                                 const ProgressCallback& progress = {});

}  // namespace softkin
