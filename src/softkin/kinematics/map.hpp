#pragma once

#include <optional>
#include <softkin/kinematics/maps/polynomials.hpp>
#include <softkin/model/equilibrium.hpp>
#include <string>

namespace softkin {

/// A command that a map takes.
struct MapInput {
  std::string name;          // of its actuator
  std::string unit;          // "" (a ratio), "kPa" or "N"
  Index actuator = 0;        // in the robot's order
  double low = 0, high = 0;  // ends of its range, in its unit
};

/// A number that a map returns.
struct MapOutput {
  std::string name;     // "tip_x", "air_pressure", "tendon1_ratio"
  std::string unit;     // "mm", "kPa", "N" or ""
  double accuracy = 0;  // requested, in its unit; 0: none
};

/// A cable whose length is commanded: it becomes slack where it would push.
struct MapCable {
  Index actuator = 0;              // in the robot's order
  Index input = -1;                // -1: its command is always the same
  double command = 1;              // where it is
  Index tension = -1, ratio = -1;  // outputs
};

/// Polynomials over a box of commands.
struct MapCell {
  Eigen::VectorXd low, high;  // of the inputs of its piece
  maps::Polynomials outputs;  // in the order of MapData::outputs, of the commands from -1 to 1 over the box
  maps::Polynomials modes;    // amplitudes of MapShape's; none: count() == 0
};

/// A node of the binary tree that halves the box of all commands: it contains where its box is halved, or its cell.
struct MapNode {
  int variable = -1;              // of the piece's inputs; -1: a cell, or none
  double at = 0;                  // commands below it: first
  Index first = -1, second = -1;  // nodes
  Index cell = -1;                // -1: outside the map
};

/// All shapes in which the same cables are taut, as functions of the commands of these and of the other actuators.
struct MapPiece {
  std::vector<bool> taut;      // per cable
  std::vector<Index> inputs;   // that it depends on
  std::vector<MapNode> tree;   // the first is its root
  std::vector<MapCell> cells;  // boxes with their polynomials, by MapNode::cell
};

/// The whole shape: mean + modes times amplitudes. The rounding error of 16 bits is less than 0.01 % of each mode.
struct MapShape {
  Eigen::VectorXf mean;                                               // 3 #V: x, y, z of each vertex [mm]
  Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic> modes;  // 3 #V by #modes
  Eigen::VectorXd units;                                              // #modes: of modes [mm per unit of amplitude]
  double accuracy_mm = 0;                                             // requested, of every vertex
};

/// The errors of a map against the solver at actuations that it was not made from. They are not a bound.
struct MapCheck {
  Index points = 0;                                // inside the map that were solved
  Index outside = 0;                               // of them that the map refuses, or the solver has no equilibrium for
  std::uint64_t seed = 0;                          // of the random actuations
  Eigen::VectorXd largest, mean;                   // per output, in its unit
  double shape_largest_mm = 0, shape_mean_mm = 0;  // over vertices: the largest; its mean over the points
  double strain_largest = 0;  // of the body's least and greatest principal strain, taken from the shape [-]
};

/// A robot's equilibria as functions of its commands, in closed form.
struct MapData {
  std::string robot;               // fingerprint_of its model
  std::string name;                // of the robot
  Actuation actuation;             // m: commands that are always the same, at rest
  std::vector<MapInput> inputs;    // in the robot's order
  std::vector<MapOutput> outputs;  // coordinates of markers, then loads and ratios
  std::vector<MapCable> cables;    // whose lengths are commanded
  std::vector<MapPiece> pieces;    // one for each set of taut cables
  std::optional<MapShape> shape;   // none: markers, loads and ratios alone
  MapCheck check;                  // how far it is from the solver
  Index equilibria = 0;            // that it was made of
};

/// Evaluates a map: in microseconds, without allocating memory.
class KinematicMap {
 public:
  /// throws  InvalidInput where parts of the data do not fit together
  explicit KinematicMap(MapData data);

  /// Returns the data that it was made from.
  [[nodiscard]] const MapData& data() const { return data_; }
  /// Returns the number of its commands.
  [[nodiscard]] Index inputs() const { return data_.inputs.size(); }
  /// Returns the number of its outputs.
  [[nodiscard]] Index outputs() const { return data_.outputs.size(); }

  /// The cell of a piece that contains given commands.
  struct Place {
    Index piece = -1, cell = -1;  // -1: there is none
  };

  /// commands  one per input
  /// values    one per output; of a slack cable the ratio that its path has
  /// slopes    inputs by outputs, by rows [unit of the output per unit of the command]; null: not requested
  /// returns   nothing where the commands are outside the map
  std::optional<Place> evaluate(const double* commands, double* values, double* slopes = nullptr) const;

  /// Evaluates the same while certain cables are taut, whether they pull or push; returns nothing where the map has no
  /// such piece or cell.
  ///
  /// taut  per cable
  std::optional<Place> evaluate_taut(const std::vector<bool>& taut, const double* commands, double* values,
                                     double* slopes) const;

  /// Returns which cables are taut where the commands need a piece that the map does not have; nothing where it has all
  /// the pieces that they need.
  ///
  /// values  one per output, scratch
  [[nodiscard]] std::optional<std::vector<bool>> missing_piece(const double* commands, double* values) const;

  /// Returns the shape for commands at a place that evaluate() has returned.
  ///
  /// throws  InvalidInput on a map without shape
  [[nodiscard]] Points shape(const double* commands, const Place& place) const;
  /// Returns its slopes by each input, #V by 3 [mm per unit of the command]; zeros for those on which the piece does
  /// not depend.
  [[nodiscard]] std::vector<Points> shape_slopes(const double* commands, const Place& place) const;

  /// Returns those of a robot's m commands that the map takes.
  ///
  /// throws  InvalidInput naming the actuator: one that has another command than the map was made with
  [[nodiscard]] Eigen::VectorXd commands(const Actuation& actuation) const;

 private:
  Place find(const double* commands, double* values, double* slopes, Index& taut) const;
  /// taut: bits. The piece is -1 where there is none of these, the cell where it has none there.
  Place evaluate_bits(Index taut, const double* commands, double* values, double* slopes) const;
  [[nodiscard]] Index cell_of(const MapPiece& piece, const double* commands) const;
  [[nodiscard]] Points sum_of_modes(const Eigen::VectorXd& amplitudes) const;
  void evaluate(const MapPiece& piece, const MapCell& cell, const double* commands, double* values,
                double* slopes) const;

  MapData data_;
  std::vector<Index> pieces_;  // by their taut cables, as the bits of a number; -1: none
};

}  // namespace softkin
