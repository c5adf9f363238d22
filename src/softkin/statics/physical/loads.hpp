#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Weight and forces that the scene gives, which grow with the share of what is done at once: dead loads. Their energy
/// is that of the moves from rest.
class DeadLoads : public Term {
 public:
  /// model must outlive the object.
  explicit DeadLoads(const Model& model);

  void evaluate(const Iterate& at, const Demand& demand, Scratch& scratch, Sum& sum, Team& team) const override;
  void add_change(const Demand& from, const Demand& to, const Points& positions, Scratch& scratch, Points& force,
                  Team& team) const override;
  [[nodiscard]] bool grows() const override { return any_; }

 private:
  const Model& model_;
  bool any_;
};

/// What was not in balance where a way began that is no equilibrium: dead loads that hold the robot there, and fade
/// along the way.
class FadingLoads : public Term {
 public:
  /// model must outlive the object.
  explicit FadingLoads(const Model& model) : model_(model) {}

  struct Scratch : Term::Scratch {
    Points force;  // #V by 3 [N]: gradient of the Lagrangian there
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return std::make_unique<Scratch>(); }

  void evaluate(const Iterate& at, const Demand& demand, Term::Scratch& scratch, Sum& sum, Team& team) const override;
  void add_change(const Demand& from, const Demand& to, const Points& positions, Term::Scratch& scratch, Points& force,
                  Team& team) const override;

 private:
  const Model& model_;
};

}  // namespace softkin::physical
