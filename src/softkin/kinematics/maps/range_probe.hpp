#pragma once

#include <softkin/kinematics/maps/crew.hpp>

namespace softkin::maps {

/// How far equilibria exist along one input of a map, from where it rests, while the other inputs rest.
struct InputReach {
  double rest = 0;                       // the command at rest, or the end of its range nearest to it
  double low = 0, high = 0;              // equilibria exist from low to high, in the unit of the input
  bool low_end = true, high_end = true;  // are these the ends of its range
};

/// Finds out why a robot has no equilibria in parts of the ranges of its inputs.
class RangeProbe {
 public:
  /// All must outlive the object.
  RangeProbe(const Statics& statics, const MapData& data, const MapOptions& options, Crew& crew)
      : statics_(statics), data_(data), options_(options), crew_(crew) {}

  /// Solves for both ends of each input, from the equilibrium at rest. False where that was stopped.
  [[nodiscard]] bool probe_inputs();
  /// Solves for corners of the box of all inputs: for 16 of them where there are more. False where that was stopped.
  [[nodiscard]] bool probe_corners();

  /// In the order of the map's inputs; empty before probe_inputs().
  [[nodiscard]] const std::vector<InputReach>& inputs() const { return inputs_; }

  /// Returns the error in the range of each input with equilibria in less than 80 % of it, and the remedy; empty: none.
  [[nodiscard]] std::string wrong_inputs() const;
  /// The same of all inputs together, at the corner that is nearest to rest.
  [[nodiscard]] std::string wrong_corner() const;
  /// Of samples of a piece of which some have no equilibrium: the input along which these are farther from rest than
  /// the others, and half of its range. Needs probe_inputs() or probe_corners().
  [[nodiscard]] std::string suspected_input(const MapPiece& piece, const std::vector<Sample>& samples) const;

 private:
  /// From 0 to 1; nothing where it was stopped.
  [[nodiscard]] std::optional<double> reach(const Eigen::VectorXd& commands);
  [[nodiscard]] bool solve_rest();
  [[nodiscard]] Actuation actuation_of(const Eigen::VectorXd& commands) const;
  [[nodiscard]] std::string named(std::size_t input, double value) const;

  const Statics& statics_;
  const MapData& data_;
  const MapOptions& options_;
  Crew& crew_;
  std::optional<Equilibrium> at_rest_;
  Eigen::VectorXd rest_;
  std::vector<InputReach> inputs_;
  Eigen::VectorXd corner_;   // the nearest to rest beyond which there are no equilibria
  double corner_reach_ = 1;  // fraction of the path from rest to it
};

}  // namespace softkin::maps
