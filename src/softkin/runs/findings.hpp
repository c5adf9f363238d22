#pragma once

#include <softkin/runs/records.hpp>
#include <variant>

namespace softkin::runs {

// The findings that a user should know about an equilibrium besides its numbers.

namespace finding {

/// Principal strains of the body.
struct Strain {
  double least = 0, greatest = 0;  // [-]
  double percentile_95 = 0;        // of the magnitude [-]
};
/// Elements that are inverted.
struct Inverted {
  std::size_t elements = 0;  // how many
};
/// A cable whose path is shorter than it.
struct Slack {
  std::string cable;            // its name
  double path = 0, length = 0;  // over its length at rest [-]
};
/// A layer under voltage.
struct Charged {
  std::string dea;      // its name
  ElectricLayer layer;  // its charge and field
};
/// A cable with friction.
struct CableFriction {
  std::string cable;    // its name
  double motor_N = 0;   // tension there
  TendonForces forces;  // beyond it
};
/// A thread.
struct Fibre {
  std::string name;    // its own
  FibreForces forces;  // along it
};
/// A sheet.
struct Layer {
  std::string name;    // its own
  LayerForces forces;  // in it
};
/// A support of the robot.
struct Support {
  std::string name;  // its own
  Reaction exerts;   // on the robot
};
/// A contact.
struct Contact {
  std::string part, other;  // the first presses on the other; empty: on itself
  PairForces forces;        // by which
};
/// There is no contact, though some is possible.
struct Untouched {};
/// Unstable equilibria that were left.
struct Buckled {
  int times = 0;          // how often
  double largest_mm = 0;  // move
};
/// Steps with a snap-through.
struct Snapped {
  double largest_mm = 0;  // move
  double from = 0;        // fraction of the path at which its step began [-]
};
/// An equilibrium that would be left.
struct Unstable {
  int modes = 0;  // number of unstable modes
};
/// Unstable equilibria on the path to one that is stable.
struct UnstablePath {
  double from = 0;  // fraction of the path [-]
};
/// A motion is requested and nothing moves.
struct Motionless {
  double largest_mm = 0;  // displacement
};
/// Strains larger than elastomers carry.
struct FarStrained {
  double greatest = 0;  // strain [-]
};
/// Displacements larger than those of a body that is held somewhere.
struct FarMoved {
  double largest_mm = 0, diagonal_mm = 0;  // displacement; of the robot
};
/// The iteration.
struct Diverged {};
/// The accuracy of the iteration.
struct Accuracy {
  double step_mm = 0, estimated_error_mm = 0;  // its last step; distance that may be left
  bool physical = false;                       // then there are these
  double residual_N = 0, pull_N = 0;           // largest force out of balance, largest pull of the elements at a vertex
};

}  // namespace finding

/// One of them, or a member of a record.
using Finding =
    std::variant<finding::Strain, StrainHistogram::Beyond, finding::Inverted, finding::Slack, finding::Charged,
                 finding::CableFriction, finding::Fibre, finding::Layer, StressExtremes, finding::Support, MagneticLoad,
                 finding::Contact, finding::Untouched, finding::Buckled, finding::Snapped, finding::Unstable,
                 finding::UnstablePath, LoadBranch, SelfOverlap, finding::Motionless, finding::FarStrained,
                 finding::FarMoved, finding::Diverged, finding::Accuracy>;

/// All that is worth knowing of a record's equilibrium. Of forces what is but rounding is 0; of a branch there are a
/// few points, that of the largest load among them.
[[nodiscard]] std::vector<Finding> findings(const Model& model, const StepRecord& record);

}  // namespace softkin::runs
