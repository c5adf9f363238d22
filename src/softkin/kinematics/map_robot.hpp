#pragma once

#include <memory>
#include <softkin/kinematics/map.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// A robot as its map knows it: its vertices are its markers, and two per cable that are as far apart as its path is
/// long. What needs markers, loads and commands alone works with it as with the robot: solve_inverse, follow_path.
class MapRobot {
 public:
  /// map must be of the model (runs::check_robot), and outlive the object.
  MapRobot(const Model& model, const KinematicMap& map);
  MapRobot(const MapRobot&) = delete;
  MapRobot& operator=(const MapRobot&) = delete;

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Statics& statics() const { return statics_; }

  /// Where the outputs of a map belong in a state of this robot.
  struct Places {
    Index markers = 0;         // vertices: the first ones
    std::vector<Index> loads;  // per actuator: its output, or -1
  };

 private:
  Model model_;
  Places places_;
  Statics statics_;
};

}  // namespace softkin
