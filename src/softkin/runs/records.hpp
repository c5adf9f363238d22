#pragma once

#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/walk.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/paths.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/electric_layer.hpp>
#include <softkin/statics/self_overlap.hpp>
#include <softkin/statics/worst_place.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

// Records of results. A number that a diverged solve leaves undefined is not finite here, and null in JSON.

/// An actuator in a shape.
struct ActuatorRecord {
  double requested = 0;                  // ratio to rest [-], or tension [N], gauge pressure [kPa], voltage [kV] or
                                         // amount [mL]
  double achieved = 0;                   // ratio to rest [-]
  std::optional<double> by_curve{};      // the input that the actuator's curve gives for the request [kPa gauge or kV];
                                         // none outside the curve or without one
  double multiplier = 0;                 // tension [N], gauge pressure [kPa] or voltage [kV]; physical
  bool slack = false;                    // a cable that carries nothing because its path is shorter than it
  std::optional<ElectricLayer> layer{};  // of a dea under voltage
  std::optional<TendonForces> tendon{};  // of a cable with friction
  std::vector<double> volumes_mL{};      // of each of several chambers that are connected
};

/// The forces of an equilibrium; physical, of a walk none.
struct StepForces {
  std::optional<StressExtremes> stress{};             // of all elements
  std::vector<Reaction> reactions{};                  // per support
  std::optional<MagneticLoad> magnetic{};             // where there is a magnetic field
  std::vector<LayerForces> layers{};                  // of each; where a map answered none
  std::vector<FibreForces> fibres{};                  // the same
  std::optional<std::vector<PairForces>> contacts{};  // where the robot may touch anything
};

/// One equilibrium: the request, the result, and the solver's report. Of a report a step. The history of a record that
/// was read has the iterations that were written.
struct StepRecord : SolveReport {
  Actuation actuation;                         // m, requested
  std::optional<double> reached_fraction{};    // of the path from the step before [-]; none: not known
  std::optional<Actuation> shape_actuation{};  // m, of the shape; none: not known
  double shape_load_fraction = 1;      // of dead loads, prestretch and displacements of supports, as State::fraction
  std::vector<Anchor> anchors{};       // of friction
  std::vector<double> eyelets{};       // of cables with friction; see State
  std::size_t inverted_elements = 0;   // of the shape
  double largest_displacement_mm = 0;  // of a vertex from its place at rest
  SelfOverlap self_overlap;            // of the shape, set by who makes the record
  std::vector<Vec3> markers;           // [mm]
  std::vector<double> marker_turns{};  // from rest [degrees]; not finite where a marker has no orientation (turns.hpp)
  std::vector<ActuatorRecord> actuators;  // in the order of the model
  StepForces forces;                      // in and on the robot
  StrainHistogram strain;                 // how much of the body is strained how far
  std::optional<WorstPlace> worst{};      // physical, where status is limit
  std::vector<int> history_iterations;    // from 1, per entry of history; empty: all

  std::optional<double> time_s{};           // of the path [s]; none: it has no times
  std::optional<double> viscous_loss_mJ{};  // since the step before; of a viscous robot on a path with times
  std::string shape, shape_fingerprint;     // file of a series that holds the shape; empty: none
};

/// A waypoint of a path of markers.
struct WaypointRecord : StepRecord {
  Waypoint requested;                                // where its markers were to be
  InverseStatus end = InverseStatus::not_converged;  // of the search
  double error_mm = 0;                               // of the marker that is farthest from its target
  int equilibria = 0;                                // that the search solved for
  double command_change = 0;  // from the waypoint before, the largest of the actuators', over its range [-]
  double step_mm = 0;         // the same, of the path's markers
  std::string search_remark;  // why it ended, where it is not reached

  /// Are all of its markers within the tolerance?
  [[nodiscard]] bool is_reached() const { return end == InverseStatus::reached; }
};

/// A step of a walk; walk.equilibrium is empty.
struct WalkRecord : StepRecord {
  std::size_t cycle = 0;  // from 1; 0: where the robot is put down
  WalkStep walk;          // where the robot has come to
};

/// In the order of the model's actuators.
[[nodiscard]] std::vector<ActuatorRecord> actuator_records(const Model& model, const Equilibrium& found);

/// deformation: of the equilibrium's shape; what is not of it is left as it is: shape, time_s, self_overlap
[[nodiscard]] StepRecord step_record(const Model& model, const Equilibrium& found,
                                     const ElementDeformation& deformation);
[[nodiscard]] WaypointRecord waypoint_record(const Model& model, const Waypoint& requested, const InverseResult& found,
                                             const ElementDeformation& deformation);
/// How far the record's commands and the path's markers are from those of the waypoint before.
void note_jump(const Model& model, const MarkerPath& path, const WaypointRecord& before, WaypointRecord& record);
[[nodiscard]] WalkRecord walk_record(const Model& model, std::size_t cycle, const WalkStep& found,
                                     const ElementDeformation& deformation);

/// Returns the sum of all normal forces on a part of the surroundings, such as a body, by its contacts [N].
[[nodiscard]] double normal_force_on(const Model& model, const std::string& part, const std::vector<PairForces>& pairs);

/// The state that a record's shape is, as if it had just been solved.
[[nodiscard]] State state_of(const Model& model, const StepRecord& record, Points positions);

/// An actuator that did not reach its request, in its own unit.
struct Shortfall {
  Index actuator = -1;                // of the model
  double reached = 0, requested = 0;  // in the unit of its command
};

/// Returns where the shape of a step that did not converge falls short of the request; none where only loads or
/// displaced supports do (StepRecord::reached_fraction), or it is not known.
[[nodiscard]] std::vector<Shortfall> shortfalls(const Model& model, const StepRecord& record);

}  // namespace softkin::runs
