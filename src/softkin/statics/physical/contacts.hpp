#pragma once

#include <algorithm>
#include <memory>
#include <softkin/model/model.hpp>
#include <softkin/statics/physical/contact_points.hpp>
#include <softkin/statics/physical/contact_potential.hpp>
#include <softkin/statics/physical/friction.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// What touches in the shapes of a robot: the potential between its surfaces and those around it, what it adds to the
/// pattern of the stiffness, and how far the robot may move before anything passes through anything. Positions, moves
/// and forces are of nodes; what touches are flat triangles between the ContactPoints.
class Contacts : public Term {
 public:
  /// model must outlive the object, and have contact.
  explicit Contacts(const Model& model);

  /// What changes with the shape; one per thread of control.
  struct Scratch : Term::Scratch {
    explicit Scratch(const contact::BroadPhase& all) : broad(all) {}

    /// What is within reach on a way, every point on a straight one, and at most half the margin beside it.
    struct Around {
      contact::Candidates pairs;
      Points begin, end;  // of the points
      double reach = 0;   // for which it was looked for [mm]
      double least = -1;  // distance of those pairs at the end [mm]; negative: not known
      [[nodiscard]] double beside(const Points& points) const;
    };
    contact::BroadPhase broad;
    Around around, before;                      // and the last but one, as steps that are not taken lead back to it
    contact::Candidates close;                  // what is within reach of the shape that was found last
    std::vector<ContactPotential::Term> terms;  // of the points of the shape that was found last
    Friction::Holds holds;                      // of normal forces that were held last
    ContactFirmness firmness{};                 // of what is found
    bool straight = false;                      // are laws lines through the pushes
    std::vector<ContactPush> pushes{};
    bool friction_follows = false;  // are its normal forces those of the shape, not those held
    bool evaluated = false;         // was the last shape one in which all that comes before has an energy
    contact::Candidates slotted{};  // pairs that have slots
    std::int64_t first_slot = 0;
  };
  [[nodiscard]] std::unique_ptr<Scratch> make_scratch() const;
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return make_scratch(); }

  /// Finds what is closer than the reach.
  void find(const Points& positions, Scratch& scratch, Team& team) const;

  [[nodiscard]] const Friction& friction() const { return friction_; }
  // Of the terms that were found: see Friction.
  /// from, to: the way to the shape that was found
  void renew(const Points& from, const Points& to, const FreeWay& free, const Scratch& scratch,
             std::vector<Anchor>& anchors) const;
  void slide(const Points& positions, const Scratch& scratch, std::vector<Anchor>& anchors) const;
  [[nodiscard]] double disagreement(const Points& positions, const Friction::Holds& before,
                                    const Friction::Holds& after) const;

  // Of the terms that were found, at the same positions, and of the holds.
  /// [mJ]; infinite where a pair touches.
  [[nodiscard]] double energy(const Points& positions, const Scratch& scratch) const;
  /// Adds it [N].
  void add_gradient(const Points& positions, const Scratch& scratch, Points& gradient) const;
  /// Finds what touches, and adds it; nothing where a term before has no energy.
  void evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const override;

  /// What the terms that were found push with.
  void note_pushes(Scratch& scratch) const { scratch.pushes = potential_->pushes(scratch.terms); }
  /// What they push with after so much of a move.
  void follow_pushes(const Points& moves, double share, Scratch& scratch) const;

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
  void stiffness(const Iterate& at, const Demand& demand, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;

  /// Adds what friction's normal forces change of the gradient with moves; see Friction::add_response.
  void add_friction_response(const Points& positions, const Scratch& scratch, const Points& moves,
                             Points& gradient) const;
  [[nodiscard]] bool symmetric() const override { return !friction_.any(); }
  void add_response(const Iterate& at, const Points& moves, const Term::Scratch& scratch,
                    Points& force) const override {
    if (!symmetric()) add_friction_response(at.positions, static_cast<const Scratch&>(scratch), moves, force);
  }

  /// The share in [0, 1] of a motion, every vertex on its straight way, in which nothing passes through anything and no
  /// gap shrinks to less than a tenth.
  [[nodiscard]] double longest_step(const Points& from, const Points& to, Term::Scratch& scratch,
                                    Team& team) const override;

  /// How much an edge of the surfaces changes in a motion, over its length, the largest of all: 2 sin(angle / 2) where
  /// it only turns [-].
  [[nodiscard]] double largest_turn(const Points& from, const Points& to) const;

  void tell(const Iterate& at, const Demand& demand, Term::Scratch& scratch, ElementDeformation& out,
            Team& team) const override;

  /// How what pulls on the points changes along moves of the nodes, at a shape whose terms were found and whose
  /// friction is held: the derivative of the gradient of all that touches and rubs [N].
  [[nodiscard]] Points change_along(const Points& positions, const Scratch& scratch, const Points& moves) const;

  [[nodiscard]] const ContactSurfaces& surfaces() const { return surfaces_; }
  [[nodiscard]] const ContactPotential& potential() const { return *potential_; }
  [[nodiscard]] const ContactPoints& points() const { return points_; }

 private:
  [[nodiscard]] double longest_step_of_points(const Points& from, const Points& to, Scratch& scratch, Team& team) const;
  void search(const Points& from, const Points& to, Scratch& scratch, Team& team) const;
  [[nodiscard]] double reach_mm(const Scratch& scratch) const {
    return surfaces_.reach_mm * std::max(1.0, scratch.firmness.reach) * scratch.firmness.foresight;
  }
  void keep_close(const Points& positions, const ContactFirmness& firmness, contact::Candidates& pairs) const;
  void find_parts();
  [[nodiscard]] double share_of_edge(std::size_t edge, double mean_area) const;
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
