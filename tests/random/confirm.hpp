#pragma once

#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

namespace softkin::random_robots {

/// The result of an evaluation of an answer that shares no code with the solvers.
struct Confirmation {
  std::vector<std::string> faults;  // a sentence each; none: the answer is as it reports
  bool is_equilibrium = false;      // was the answer, or its last good shape, found to be one
  double residual_ratio = 0;        // largest residual force over the largest force at a vertex [-]
  double constraint_error = 0;      // largest violation of a volume or length, over the requested value [-]
  double step_ratio = 0;            // target shapes: step of Algorithm 1 from the answer, over the tolerance [-]
  bool blurred = false;             // rounding of the coordinates alone could hide much of the forces
  bool undecided = false;           // target shapes: a best rotation is not unique
  long inverted = 0;                // elements
};

/// Checks an answer: numbers are finite, the reason for its end is reported, inverted elements are counted correctly,
/// and an equilibrium is one. The limits of the checks are
/// - the residual force at every free vertex and of every rigid region: 1e-5 of the largest force at any vertex, plus
///   the change of force by a step of the tolerance, plus rounding of the coordinates;
/// - constraints: 1e-8 of the requested volume or length, plus rounding;
/// - the step of Algorithm 1: five times the tolerance, plus rounding.
///
/// begun  equilibrium in which a robot with memory has rested before
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
/// Returns the places of fixed axes, turned by the commands, at the load factor of the state [mm].
[[nodiscard]] Points held_places(const Model& model, const State& state);

[[nodiscard]] RigidMoves moves_of(const Model& model, const RigidRegion& region);

/// A number for a message.
[[nodiscard]] std::string digits(double value);

}  // namespace softkin::random_robots
