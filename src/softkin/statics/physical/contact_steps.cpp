#include <algorithm>
#include <cmath>
#include <softkin/energy/contact_laws.hpp>
#include <softkin/statics/physical/contact_steps.hpp>
#include <utility>

namespace softkin::physical {

void hold_friction(const System& system, const Iterate& at, Workspace& work, Team& team) {
  if (!system.friction()) return;
  system.contacts()->find(at.positions, *work.contacts, team);
  system.contacts()->friction().hold(work.contacts->terms, at.anchors, work.contacts->holds);
}

double renew_friction(const System& system, const Points& from, const FreeMotion& free, Iterate& at, Workspace& work,
                      Team& team) {
  if (!system.friction()) return 0;
  const Contacts& contacts = *system.contacts();
  contacts.find(at.positions, *work.contacts, team);
  contacts.renew(from, at.positions, free, *work.contacts, at.anchors);
  const Friction::Holds before = work.contacts->holds;
  contacts.friction().hold(work.contacts->terms, at.anchors, work.contacts->holds);
  return contacts.disagreement(at.positions, before, work.contacts->holds);
}

double slipping_fraction(const System& system, const Iterate& at, Workspace& work, Team& team) {
  if (!system.friction()) return 0;
  hold_friction(system, at, work, team);
  return system.contacts()->friction().slipping_fraction(at.positions, work.contacts->holds);
}

void slide_friction(const System& system, Iterate& at, Workspace& work, Team& team) {
  if (!system.friction()) return;
  const Contacts& contacts = *system.contacts();
  contacts.find(at.positions, *work.contacts, team);
  contacts.slide(at.positions, *work.contacts, at.anchors);
  contacts.friction().hold(work.contacts->terms, at.anchors, work.contacts->holds);
}

OtherContact::~OtherContact() {
  forget();
}

void OtherContact::straighten(const Iterate& at, double foresight) {
  contacts_.find(at.positions, scratch_, team_);
  contacts_.note_pushes(scratch_);
  scratch_.stiffness_scale = {1, 1, foresight};
  scratch_.straight = true;
}

void OtherContact::forget() {
  scratch_.stiffness_scale = {};
  scratch_.straight = false;
  scratch_.pushes.clear();
}

double missed_by_pushes(const System& system, const Workspace& work) {
  const double faint = work.options.contact.faint_force;
  double largest = 0, most = 0;
  for (const ContactPush& push : work.contacts->pushes) largest = std::max(largest, push.push);
  for (const ContactPush& push : work.contacts->pushes) {
    const ContactPotential::Term& term = work.contacts->terms[push.term];
    const double by_gap =
        -energy::barrier(std::sqrt(term.separation.squared), system.contacts()->surfaces().reach_mm).slope;
    most = std::max(most, std::abs(by_gap - push.push) / (push.push + faint * largest));
  }
  return most;
}

double clear_fraction(const System& system, const Points& from, const Motion& path, double end, Workspace& work,
                      Points& to, Team& team) {
  const ContactOptions& options = work.options.contact;
  path(end, to);
  if (!system.contact()) return end;
  const Contacts& contacts = *system.contacts();
  const double turn = to.allFinite() ? contacts.largest_turn(from, to) : 2 * options.max_turn;
  if (!(turn <= options.max_turn)) return 0.5 * end * options.max_turn / turn;
  const int pieces = std::max(1, static_cast<int>(std::ceil(turn / options.piece_turn)));
  Points last = from, next;
  for (int piece = 1; piece <= pieces; ++piece) {
    if (piece < pieces)
      path(end * piece / pieces, next);
    else
      next = to;
    const double fraction = contacts.longest_step(last, next, *work.contacts, team);
    if (fraction < 1) return end * (piece - 1 + fraction) / pieces;
    last.swap(next);
  }
  return end;
}

bool advance_clear(const System& system, const Eigen::VectorXd& step, double& scale, Workspace& work, Points& positions,
                   Team& team) {
  const ContactOptions& options = work.options.contact;
  const Points from = positions;
  const Motion path = [&](double fraction, Points& out) {
    out = from;
    system.advance(step, fraction * scale, work, out, team);
  };
  for (double end = 1; end >= options.min_advance;) {
    const double fraction = clear_fraction(system, from, path, end, work, positions, team);
    if (fraction >= end) {
      scale *= end;
      return true;
    }
    end = options.clear_fraction * fraction;
  }
  return false;
}

}  // namespace softkin::physical
