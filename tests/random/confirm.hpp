#pragma once

#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

namespace softkin::random_robots {

/// What an evaluation that shares no code with the solvers says about an answer.
struct Confirmation {
  std::vector<std::string> faults;  // a sentence each; none: the answer is what it says it is
  bool is_equilibrium = false;      // was the answer, or its last good shape, found to be one
  double residual_ratio = 0;        // largest force out of balance over the largest force at a vertex [-]
  double constraint_error = 0;      // largest miss of a volume or length, over what was asked for [-]
  double step_ratio = 0;            // target shapes: step of Algorithm 1 from the answer, over the tolerance [-]
  bool blurred = false;             // rounding of the coordinates alone could hide much of the forces
  bool undecided = false;           // target shapes: a best rotation is not unique
  long inverted = 0;                // elements
};

/// What is to be true of any answer: numbers are finite, it says why it stopped, inverted elements are counted right,
/// and an equilibrium is one.
///
/// residual    at every free vertex and of every rigid region at most 1e-5 of the largest force that acts at any
///             vertex, and what moves of step_mm within the tolerance stand for, plus rounding of the coordinates
/// begun       where a robot that remembers has stood for long
/// constraint  1e-8 of the volume or length asked for, plus rounding
/// step        of Algorithm 1: five times the tolerance, plus rounding
[[nodiscard]] Confirmation confirm(const Model& model, const Actuation& command, const Equilibrium& found,
                                   const State& begun);

/// Where a robot stands, solved for, before the times of one that remembers begin.
[[nodiscard]] State long_rest(const Model& model, StaticsOptions options);

// its parts
void confirm_physical(const Model& model, const Equilibrium& found, const State& begun, Confirmation& out);
void confirm_target_shape(const Model& model, const Equilibrium& found, Confirmation& out);

/// How the rigid region may move: along and about which axes.
struct RigidMoves {
  std::array<bool, 3> slides{true, true, true}, turns{true, true, true};
};
/// Where fixed axes are held, turned as the commands say, at the share of the state [mm].
[[nodiscard]] Points held_places(const Model& model, const State& state);

[[nodiscard]] RigidMoves moves_of(const Model& model, const RigidRegion& region);

/// A number for a message.
[[nodiscard]] std::string digits(double value);

}  // namespace softkin::random_robots
