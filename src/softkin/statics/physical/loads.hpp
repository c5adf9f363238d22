#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Weight and forces of the scene, which grow with the load factor: dead loads. Their energy is counted from the shape
/// at rest.
class DeadLoads : public Term {
 public:
  /// model must outlive the object.
  explicit DeadLoads(const Model& model);

  void evaluate(const Iterate& at, const LoadState& load_state, Scratch& scratch, Sum& sum, Team& team) const override;
  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Scratch& scratch, Points& force,
                  Team& team) const override;
  [[nodiscard]] bool grows() const override { return any_; }

 private:
  const Model& model_;
  bool any_;
};

/// The residual at the start of a path that does not begin at an equilibrium: dead loads that keep the robot in that
/// shape, and fade along the path.
class FadingLoads : public Term {
 public:
  /// model must outlive the object.
  explicit FadingLoads(const Model& model) : model_(model) {}

  struct Scratch : Term::Scratch {
    Points force;  // #V by 3 [N]: gradient of the Lagrangian there
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return std::make_unique<Scratch>(); }

  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;
  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Term::Scratch& scratch,
                  Points& force, Team& team) const override;

 private:
  const Model& model_;
};

}  // namespace softkin::physical
