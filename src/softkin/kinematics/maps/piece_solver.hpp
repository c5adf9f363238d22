#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin::maps {

/// An equilibrium of a piece of a map, and how it changes with the piece's inputs.
struct Sample {
  Eigen::VectorXd commands;  // of the piece's inputs
  State state;               // m actuators of the piece's robot
  Eigen::VectorXd values;    // per output of the map; empty: no equilibrium, or none that continues the others
  RowMatrix slopes;          // inputs by outputs
  Eigen::MatrixXf moves;     // of the shape by each input, 3 #V by inputs [mm per unit of command]

  [[nodiscard]] bool is_good() const { return values.size() > 0; }
};

/// The robot while certain cables are taut and the others slack: taut ones keep their lengths, also where they have to
/// push. Its shapes are smooth functions of the commands where those of the robot have kinks. Both are the same where
/// no taut cable pushes and no slack one is too long.
class PieceSolver {
 public:
  /// model must outlive the object. data: its inputs, outputs and cables; piece: its taut cables and its inputs
  PieceSolver(const Model& model, const MapData& data, const MapPiece& piece);

  /// nearest  where the search begins; null: at rest
  /// returns  nothing where progress stopped it
  [[nodiscard]] std::optional<Sample> solve(const Eigen::VectorXd& commands, const Sample* nearest,
                                            const StaticsOptions& options, const ProgressCallback& progress) const;

 private:
  void add_values(Sample& sample) const;
  void add_slopes(const Sensitivity& sensitivity, Sample& sample) const;

  Model model_;  // with the piece's cables
  const MapData& data_;
  std::vector<Index> actuators_;  // of the piece's inputs
  Statics statics_;
};

/// The outputs of a map in an equilibrium of its robot, or of a piece's.
[[nodiscard]] Eigen::VectorXd outputs_of(const Model& model, const MapData& data, const State& state);

/// Is the length, area or volume of the actuator over that at rest an output of the robot's maps, as it follows from
/// the command or may differ from it?
[[nodiscard]] bool answers_with_ratio(const Model& model, const Actuator& actuator);

/// Returns the inputs and outputs of a map of the robot, without pieces.
///
/// throws  InvalidInput on a robot with no or too many commands that vary, without markers, or with friction, which
///         makes its shapes depend on the path
[[nodiscard]] MapData outline_of(const Model& model);

}  // namespace softkin::maps
