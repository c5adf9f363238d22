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

// What is kept of what was computed. A number that a diverged solve does not know is not finite here, and null in JSON.

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
  std::optional<TendonForces> tendon{};  // of a cable that rubs
  std::vector<double> volumes_mL{};      // of each of several chambers that are connected
};

/// One equilibrium: what was asked, what came of it, and how. Of a report a step. The history of a record that was read
/// has the iterations that were written.
struct StepRecord : SolveReport {
  Actuation actuation;                         // m, asked for
  std::optional<double> reached_share{};       // of the way from the step before [-]; none: not known
  std::optional<Actuation> shape_actuation{};  // m, of the shape; none: not known
  double shape_load_share = 1;         // of dead loads, prestretch and displacements of supports, as State::share
  std::vector<Anchor> anchors{};       // of friction
  std::vector<double> eyelets{};       // of cables that rub; see State
  std::size_t inverted_elements = 0;   // of the shape
  double largest_displacement_mm = 0;  // of a vertex from its place at rest
  SelfOverlap self_overlap;            // of the shape, set by who makes the record
  std::vector<Vec3> markers;           // [mm]
  std::vector<double> marker_turns{};  // from rest [degrees]; not finite where a marker has no orientation (turns.hpp)
  std::vector<ActuatorRecord> actuators;              // in the order of the model
  StrainHistogram strain;                             // how much of the body is strained how far
  std::optional<StressExtremes> stress{};             // physical; of a walk none
  std::vector<Reaction> reactions{};                  // the same, per support
  std::optional<MagneticLoad> magnetic{};             // where there is a magnetic field; of a walk none
  std::vector<LayerForces> layers{};                  // of each; as fibres
  std::vector<FibreForces> fibres{};                  // of each; of a walk none, nor where a map answered
  std::optional<std::vector<PairForces>> contacts{};  // where the robot may touch anything; of a walk none
  std::optional<WorstPlace> worst{};                  // physical, where status is limit
  std::vector<int> history_iterations;                // from 1, per entry of history; empty: all

  std::optional<double> time_s{};           // of the path [s]; none: it has no times
  std::optional<double> viscous_loss_mJ{};  // since the step before; of a viscous robot on a path with times
  std::string shape, shape_fingerprint;     // file of a series that holds the shape; empty: none
};

/// A waypoint of a path of markers.
struct WaypointRecord : StepRecord {
  Waypoint asked;                                    // where its markers were to be
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
[[nodiscard]] WaypointRecord waypoint_record(const Model& model, const Waypoint& asked, const InverseResult& found,
                                             const ElementDeformation& deformation);
/// How far the record's commands and the path's markers are from those of the waypoint before.
void note_jump(const Model& model, const MarkerPath& path, const WaypointRecord& before, WaypointRecord& record);
[[nodiscard]] WalkRecord walk_record(const Model& model, std::size_t cycle, const WalkStep& found,
                                     const ElementDeformation& deformation);

/// The sum of all normal forces between a part of the surroundings, such as a body, and what touches it [N].
[[nodiscard]] double normal_force_on(const Model& model, const std::string& part, const std::vector<PairForces>& pairs);

/// The state that a record's shape is, as if it had just been solved.
[[nodiscard]] State state_of(const Model& model, const StepRecord& record, Points positions);

/// What a user should know of an equilibrium beside its numbers.
struct Finding {
  /// What is found; `name` and `values` as they stand beside each.
  enum class Kind {
    strain,               // values: least, greatest, 95th percentile of the magnitude [-]
    beyond_linear_range,  // name: region; values: share of its volume [-], its linear range [-]
    inverted,             // values: how many elements
    slack,                // name: cable; values: length of its path and of the cable over that at rest [-]
    charged,              // name: dea; values: charge [nC], capacitance [pF], the largest field in its layer [kV/mm],
                          // thickness [mm] and place [mm] (3) there
    rubbing,              // name: cable; values: tension at the motor and at its far end [N], share that sticks [-]
    fibre,                // name; values: mean, largest, least tension [N], where the largest is [mm] (3), length over
                          // that at rest [-], share that is slack [-]
    layer,                // name; values: largest, least principal tension [N/mm], where the largest is [mm] (3),
                          // largest strain [-], shares of its area that are wrinkled and slack [-]
    self_overlap,         // values: points inside, depth of the deepest and its place [mm]
    motionless,           // something is asked for and nothing moves; values: largest displacement [mm]
    far_strained,         // values: greatest strain [-]
    far_moved,            // values: largest displacement, diagonal of the robot [mm]
    diverged,             // the iteration
    accuracy,   // values: last step, estimated distance from the equilibrium [mm]; physical: largest force out
                // of balance, largest pull of the elements at a vertex [N]
    stress,     // name: region of the largest of von Mises; values: it [MPa], where [mm] (3), greatest and
                // least principal stress [MPa]
    reaction,   // name: support; values: force [N] (3), moment [N mm] (3), centre [mm] (3)
    contact,    // name: what presses on the other, which is empty where it is itself; values: force [N] (3), moment
                // [N mm] (3), centre [mm] (3), normal force [N], largest pressure [kPa], area [mm^2], least gap [mm],
                // with friction the share of the normal force that slips [-]
    magnetic,   // values: force [N] (3), moment [N mm] (3), centre [mm] (3)
    untouched,  // nothing touches what it might
    unstable,   // values: in how many ways
    buckled,    // values: how often, the largest move [mm]
    snapped,    // values: the longest move [mm], share of the way at which its step began [-]
    unstable_way,  // of an equilibrium that is stable; values: share of the way from which it was not [-]
    branch         // name: chamber or cable whose load has a maximum; values: ratio [-] and load [kPa, N] of each shape
                   // along its volume or length
  };
  Kind kind;                     // what it is
  std::string name{};            // of the region, actuator or part; empty: of none
  std::vector<double> values{};  // numbers, in the order told above
  std::string other{};           // the second name, of a contact
};

/// All that is worth knowing of a record's equilibrium.
[[nodiscard]] std::vector<Finding> findings(const Model& model, const StepRecord& record);

/// An actuator that did not come as far as was asked, in its own unit.
struct Shortfall {
  Index actuator = -1;            // of the model
  double reached = 0, asked = 0;  // in the unit of its command
};

/// Where the shape of a step that did not converge falls short of what was asked; none where only loads or displaced
/// supports do (StepRecord::reached_share), or it is not known.
[[nodiscard]] std::vector<Shortfall> shortfalls(const Model& model, const StepRecord& record);

}  // namespace softkin::runs
