#pragma once

#include <memory>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// Which feet slide between two steps of a walk.
enum class Sliding { none, rear, front, both };

/// The state of a walk after a step.
struct WalkStep {
  Equilibrium equilibrium;           // of the body, where it has walked to: positions #V by 3 [mm]
  Sliding sliding = Sliding::none;   // since the step before
  double friction_N = 0;             // with which the feet stretch the body, < 0: compress it; target-shape: 0
  double rear_mm = 0, front_mm = 0;  // feet along the direction of travel, from where the rear one stood at rest
  double travel_mm = 0;              // of the middle between the feet, from where it stood first
  double shift_mm = 0;               // along the direction of travel, from where the scene holds it
  int equilibria = 0;                // solved for this step
};

/// A robot that walks on its two feet as its actuation changes, so slowly that it is always in equilibrium.
///
/// The direction of travel is that from the rear foot to the front one at rest. The floor is the scene's `fixed`; the
/// walk releases what it holds along that direction, which must be near one foot alone. The friction forces on both
/// feet are equal and opposite, as no other force acts along the direction of travel. While both feet stick, their
/// distance stays the same; where the force reaches the friction limit of a foot, that foot slides against this force.
/// With equal limits both slide, half each. The result does not depend on how finely the actuation is divided as long
/// as the distance of the feet is monotonic in between.
///
/// Target shapes have no forces: the body takes its shape freely, and the friction only determines which foot slides.
///
/// source  Coulomb friction with a limit for either direction, backward Euler: A. DeSimone, P. Gidoni, G. Noselli,
///         Liquid crystal elastomer strips as soft crawlers, J. Mech. Phys. Solids 84, 2015
class Walker {
 public:
  /// throws  InvalidInput on a model without feet, feet at one place, both feet held along the direction of travel,
  ///         loads along it, or magnetic fields that are not the same everywhere
  Walker(const Model& model, const StaticsOptions& options);
  ~Walker();
  Walker(Walker&&) noexcept;
  Walker& operator=(Walker&&) noexcept;

  /// The next actuation, m values. The first one finds the robot put down without friction, its rear foot at its rest
  /// place. Where the equilibrium did not converge or was interrupted the walk stays where it was.
  ///
  /// throws  InvalidInput as Statics::solve does, and where the feet leave the line between them at rest by more than
  ///         1e-6 of their distance
  [[nodiscard]] WalkStep advance(const Actuation& actuation, const ProgressCallback& progress = {});

  /// Continues as if this step, with its equilibrium's state, had just been done.
  void resume(const WalkStep& step);

  [[nodiscard]] const Vec3& direction() const;  // of travel, of length 1

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softkin
