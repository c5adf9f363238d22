#pragma once

#include <functional>
#include <softkin/statics/physical/system.hpp>

/// What contact and friction ask of the steps of a solver: how far a step may go, what is held while it is made, what
/// is remembered after it. Where nothing can touch they do nothing.

namespace softkin::physical {

/// Friction by the normal forces of an equilibrium, for what follows, at its anchors.
void hold_friction(const System& system, const Iterate& at, Workspace& work, Team& team);
/// The same, with new anchors where something began to touch on the way from an earlier shape.
///
/// returns  how far the friction at the iterate was by other normal forces, over the largest force on a vertex [-]
double renew_friction(const System& system, const Points& from, const FreeWay& free, Iterate& at, Workspace& work,
                      Team& team);
/// Does friction act on the shapes that are evaluated?
[[nodiscard]] inline bool rubs(const Workspace& work) {
  return work.contacts && (work.contacts->friction_follows || !work.contacts->holds.empty());
}
/// Share of what rubs that slips, or nearly [-].
[[nodiscard]] double slipping_share(const System& system, const Iterate& at, Workspace& work, Team& team);
/// Lets what slips at an equilibrium go on from there.
void slide_friction(const System& system, Iterate& at, Workspace& work, Team& team);

/// While it lives the normal forces that limit friction are those of the shape, not those held.
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

/// While it lives contact is felt otherwise than by its own laws: of another firmness, or as lines through what pushes.
class OtherContact {
 public:
  /// Of contact that there is. All must outlive the object.
  OtherContact(const System& system, Workspace& work, Team& team)
      : contacts_(*system.contacts()), scratch_(*work.contacts), team_(team) {}
  ~OtherContact();
  OtherContact(const OtherContact&) = delete;
  OtherContact& operator=(const OtherContact&) = delete;

  void set_firmness(const ContactFirmness& firmness) { scratch_.firmness = firmness; }
  /// Notes what touches in a shape, and with what it pushes, as it is felt: lines through that are its laws from there
  /// on, to look up to so many reaches; see ContactPotential::straighten.
  void straighten(const Iterate& at, double foresight);
  [[nodiscard]] bool any_push() const { return !scratch_.pushes.empty(); }
  /// By its own laws again.
  void forget();

 private:
  const Contacts& contacts_;
  Contacts::Scratch& scratch_;
  Team& team_;
};

/// How far pushes are from those of the gaps by the scene's contact, over them: the largest, but for faint ones [-].
[[nodiscard]] double missed_by_pushes(const System& system, const Workspace& work);

/// A way: the shape at a share of it.
using Way = std::function<void(double, Points&)>;
/// How far a way can be gone before something passes through something or is torn out of all proportion [-]. Where it
/// turns what touches by much it is looked at in pieces.
///
/// end  of the way, whose shape is written to `to`
double clear_share(const System& system, const Points& from, const Way& way, double end, Workspace& work, Points& to,
                   Team& team);

/// System::advance, less far where otherwise something would pass through something.
///
/// scale    becomes what was moved by
/// returns  false where hardly any move is possible
bool advance_clear(const System& system, const Eigen::VectorXd& step, double& scale, Workspace& work, Points& positions,
                   Team& team);

}  // namespace softkin::physical
