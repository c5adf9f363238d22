#pragma once

#include <functional>
#include <softkin/statics/physical/system.hpp>

/// Functions for contact and friction in the steps of a solver: the largest step, the normal forces that are fixed
/// during it, and the anchors that are kept after it. Without contact they do nothing.

namespace softkin::physical {

/// Fixes the normal forces that limit friction to those of an equilibrium, at its anchors, for the evaluations that
/// follow.
void hold_friction(const System& system, const Iterate& at, Workspace& work, Team& team);
/// Does the same, with new anchors where contact began on the motion from an earlier shape.
///
/// returns  difference of the friction by the former and the new normal forces, over the largest force on a vertex [-]
double renew_friction(const System& system, const Points& from, const FreeMotion& free, Iterate& at, Workspace& work,
                      Team& team);
/// Does friction act on the shapes that are evaluated?
[[nodiscard]] inline bool has_friction(const Workspace& work) {
  return work.contacts && (work.contacts->friction_follows || !work.contacts->holds.empty());
}
/// Returns the fraction of the normal forces with friction whose contacts slip, or nearly [-].
[[nodiscard]] double slipping_fraction(const System& system, const Iterate& at, Workspace& work, Team& team);
/// Moves the anchors of contacts that slip at an equilibrium after these, so that they can continue to slip.
void slide_friction(const System& system, Iterate& at, Workspace& work, Team& team);

/// During its lifetime the normal forces that limit friction are those of the current shape, not the fixed ones.
class FollowingFriction {
 public:
  explicit FollowingFriction(Workspace& work) : contacts_(work.contacts) { set(true); }
  ~FollowingFriction() { set(false); }
  FollowingFriction(const FollowingFriction&) = delete;
  FollowingFriction& operator=(const FollowingFriction&) = delete;

 private:
  void set(bool follows) {
    if (contacts_) contacts_->friction_follows = follows;
  }

  Contacts::Scratch* contacts_;
};

/// During its lifetime contact has other laws than its own: another stiffness scale, or lines through the present
/// contact forces.
class OtherContact {
 public:
  /// The system must have contact. All must outlive the object.
  OtherContact(const System& system, Workspace& work, Team& team)
      : contacts_(*system.contacts()), scratch_(*work.contacts), team_(team) {}
  ~OtherContact();
  OtherContact(const OtherContact&) = delete;
  OtherContact& operator=(const OtherContact&) = delete;

  void set_stiffness_scale(const ContactStiffnessScale& stiffness_scale) { scratch_.stiffness_scale = stiffness_scale; }
  /// Replaces the laws of the contacts in a shape by lines through their present forces, and extends the search for
  /// contacts to `foresight` times the reach; see ContactPotential::straighten.
  void straighten(const Iterate& at, double foresight);
  [[nodiscard]] bool any_push() const { return !scratch_.pushes.empty(); }
  /// Restores the laws of contact.
  void forget();

 private:
  const Contacts& contacts_;
  Contacts::Scratch& scratch_;
  Team& team_;
};

/// Returns the largest difference of contact forces from those of the scene's contact law at the same gaps, over the
/// forces; small forces count less [-].
[[nodiscard]] double missed_by_pushes(const System& system, const Workspace& work);

/// A motion: sets the shape at a fraction of it.
using Motion = std::function<void(double, Points&)>;
/// Returns the fraction of a motion before surfaces pass through each other or are distorted excessively [-]. A motion
/// that turns contact surfaces far is checked in pieces.
///
/// end  fraction at which the motion ends; the shape there is written to `to`
double clear_fraction(const System& system, const Points& from, const Motion& path, double end, Workspace& work,
                      Points& to, Team& team);

/// Moves positions as System::advance, but only as far as no surface passes through another.
///
/// scale    becomes that of the actual move
/// returns  false where hardly any move is possible
bool advance_clear(const System& system, const Eigen::VectorXd& step, double& scale, Workspace& work, Points& positions,
                   Team& team);

}  // namespace softkin::physical
