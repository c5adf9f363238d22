#pragma once

#include <algorithm>
#include <memory>
#include <softkin/model/model.hpp>
#include <softkin/statics/physical/contact_points.hpp>
#include <softkin/statics/physical/contact_potential.hpp>
#include <softkin/statics/physical/friction.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// The contacts of a robot: the potential between its surfaces and those around it, its part of the pattern of the
/// stiffness, and the largest motion without penetration. Positions, moves and forces belong to nodes; the surfaces are
/// flat triangles between the ContactPoints.
class Contacts : public Term {
 public:
  /// model must outlive the object, and have contact.
  explicit Contacts(const Model& model);

  /// Data that change with the shape; one per thread of control.
  struct Scratch : Term::Scratch {
    explicit Scratch(const contact::BroadPhase& all) : broad(all) {}

    /// Pairs within reach during a motion of all points along straight lines, or at most half the margin away from
    /// these.
    struct Around {
      contact::Candidates pairs;
      Points begin, end;  // of the points
      double reach = 0;   // of the search [mm]
      double least = -1;  // distance of those pairs at the end [mm]; negative: not known
      [[nodiscard]] double beside(const Points& points) const;
    };
    contact::BroadPhase broad;
    Around around, before;                      // and the last but one, to which rejected steps return
    contact::Candidates close;                  // pairs within reach in the shape that was found last
    std::vector<ContactPotential::Term> terms;  // of the points of the shape that was found last
    Friction::Holds holds;                      // of normal forces that were held last
    ContactStiffnessScale stiffness_scale{};    // of the pairs that are found
    bool straight = false;                      // are laws lines through the pushes
    std::vector<ContactPush> pushes{};
    bool friction_follows = false;  // are its normal forces those of the shape, not those held
    bool evaluated = false;         // did all terms before it have an energy in the last shape
    contact::Candidates slotted{};  // pairs that have slots
    std::int64_t first_slot = 0;
  };
  [[nodiscard]] std::unique_ptr<Scratch> make_scratch() const;
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return make_scratch(); }

  /// Finds all pairs that are closer than the reach.
  void find(const Points& positions, Scratch& scratch, Team& team) const;

  [[nodiscard]] const Friction& friction() const { return friction_; }
  // Of the terms that were found: see Friction.
  /// from, to: start and end of the motion to the shape that was found
  void renew(const Points& from, const Points& to, const FreeMotion& free, const Scratch& scratch,
             std::vector<Anchor>& anchors) const;
  void slide(const Points& positions, const Scratch& scratch, std::vector<Anchor>& anchors) const;
  [[nodiscard]] double disagreement(const Points& positions, const Friction::Holds& before,
                                    const Friction::Holds& after) const;

  // Of the terms that were found, at the same positions, and of the holds.
  /// [mJ]; infinite where a pair touches.
  [[nodiscard]] double energy(const Points& positions, const Scratch& scratch) const;
  /// Adds the gradient of the energy [N].
  void add_gradient(const Points& positions, const Scratch& scratch, Points& gradient) const;
  /// Finds the contacts and adds their energy and gradient; does nothing where a term before has no energy.
  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;

  /// Stores the forces of the terms that were found.
  void note_pushes(Scratch& scratch) const { scratch.pushes = potential_->pushes(scratch.terms); }
  /// Updates these forces after a fraction of a move.
  void follow_pushes(const Points& moves, double fraction, Scratch& scratch) const;

  /// Does a pattern with the cliques of these pairs hold the stiffness of all terms?
  [[nodiscard]] static bool holds(const contact::Candidates& pairs, const Scratch& scratch);
  [[nodiscard]] bool lacks_slots(const Term::Scratch& scratch) const override {
    const auto& own = static_cast<const Scratch&>(scratch);
    return !holds(own.slotted, own);
  }
  /// Pairs that are close enough to come within reach soon; sorted.
  void find_pairs(const Points& positions, Scratch& scratch, Team& team, contact::Candidates& pairs) const;
  /// Adds every pair as a clique: its four vertices, or the nodes that carry them.
  void add_cliques(const contact::Candidates& pairs, linear::Cliques& cliques) const;
  using Term::add_cliques;
  void add_cliques_of(const Iterate& at, Term::Scratch& scratch, linear::Cliques& cliques, Team& team) const override;
  /// Second derivatives of the terms into the slots of the cliques of pairs that hold them, the first of which is
  /// given; 9 values each [N/mm].
  void stiffness(const Points& positions, bool projected, const Scratch& scratch, const contact::Candidates& pairs,
                 double* slots) const;
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;

  /// Adds the change of the gradient along moves that comes from the normal forces of friction; see
  /// Friction::add_response.
  void add_friction_response(const Points& positions, const Scratch& scratch, const Points& moves,
                             Points& gradient) const;
  [[nodiscard]] bool symmetric() const override { return !friction_.any(); }
  void add_response(const Iterate& at, const Points& moves, const Term::Scratch& scratch,
                    Points& force) const override {
    if (!symmetric()) add_friction_response(at.positions, static_cast<const Scratch&>(scratch), moves, force);
  }

  /// Returns the fraction in [0, 1] of a motion, every vertex on a straight line, in which no surface passes through
  /// another and no gap shrinks to less than a tenth.
  [[nodiscard]] double longest_step(const Points& from, const Points& to, Term::Scratch& scratch,
                                    Team& team) const override;

  /// Returns the largest change of an edge of the surfaces in a motion, over its length: 2 sin(angle / 2) where it only
  /// turns [-].
  [[nodiscard]] double largest_turn(const Points& from, const Points& to) const;

  void describe(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, ElementDeformation& out,
                Team& team) const override;

  /// Returns the change of the gradient of all contact and friction terms on the points along moves of the nodes, at a
  /// shape whose terms were found and whose normal forces of friction are fixed [N].
  [[nodiscard]] Points change_along(const Points& positions, const Scratch& scratch, const Points& moves) const;

  [[nodiscard]] const ContactSurfaces& surfaces() const { return surfaces_; }
  [[nodiscard]] const ContactPotential& potential() const { return *potential_; }
  [[nodiscard]] const ContactPoints& points() const { return points_; }

 private:
  [[nodiscard]] double longest_step_of_points(const Points& from, const Points& to, Scratch& scratch, Team& team) const;
  void search(const Points& from, const Points& to, Scratch& scratch, Team& team) const;
  [[nodiscard]] double reach_mm(const Scratch& scratch) const {
    return surfaces_.reach_mm * std::max(1.0, scratch.stiffness_scale.reach) * scratch.stiffness_scale.foresight;
  }
  void keep_close(const Points& positions, const ContactStiffnessScale& stiffness_scale,
                  contact::Candidates& pairs) const;
  void find_parts();
  [[nodiscard]] double fraction_of_edge(std::size_t edge, double mean_area) const;
  void choose_areas();
  [[nodiscard]] contact::Exclusions exclusions() const;
  void add_of_points(Points& gradient, const auto& add) const;
  [[nodiscard]] contact::Nodes nodes_of(const contact::Pair& pair, bool edges) const;
  [[nodiscard]] std::vector<std::int64_t> slots_of(const contact::Candidates& pairs) const;

  const Model& model_;
  ContactPoints points_;
  Points rest_;  // of the points
  ContactSurfaces surfaces_;
  Friction friction_;
  double margin_mm_ = 0;
  std::unique_ptr<ContactPotential> potential_;
  std::unique_ptr<contact::BroadPhase> broad_;  // sorted once; every thread of control has a copy
};

}  // namespace softkin::physical
