#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin::maps {

/// An equilibrium of a piece of a map, and how it changes with the piece's inputs.
struct Sample {
  Eigen::VectorXd commands;  // of the piece's inputs
  State state;               // m actuators of the piece's robot
  Eigen::VectorXd values;    // per output of the map; empty: there is none, or none that goes on from others
  RowMatrix slopes;          // inputs by outputs
  Eigen::MatrixXf moves;     // of the shape by each input, 3 #V by inputs [mm per unit of command]

  [[nodiscard]] bool is_good() const { return values.size() > 0; }
};

/// The robot while certain cables are taut and the others slack: taut ones are held to their lengths whatever that
/// takes, pushing if need be. Its shapes are smooth functions of what is commanded where those of the robot have kinks,
/// and the same where no taut cable pushes and no slack one is too long.
class PieceSolver {
 public:
  /// model must outlive the object. data: its inputs, outputs and cables; piece: what is taut, and its inputs
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

/// Is the length, area or volume of the actuator over that at rest an output of the robot's maps: where it follows from
/// what is commanded, or may differ from it?
[[nodiscard]] bool answers_with_ratio(const Model& model, const Actuator& actuator);

/// What a map of the robot takes and gives; without pieces.
///
/// throws  InvalidInput on a robot with nothing that varies or with too much, without markers, or with friction, whose
///         shapes depend on the way there
[[nodiscard]] MapData outline_of(const Model& model);

}  // namespace softkin::maps
