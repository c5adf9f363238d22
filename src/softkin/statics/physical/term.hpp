#pragma once

#include <memory>
#include <softkin/core/team.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/iterate.hpp>

namespace softkin::physical {

/// A part of the energy of a robot: what its elements store, what fields and weights do to it, what touches. Terms know
/// nothing of each other. An equilibrium is a shape at which their gradients add up to what the constraints pull.
///
/// A term does what it has to do and leaves the rest as it is here: most couple no vertices beyond those of others, and
/// few have anything to tell.
class Term {
 public:
  Term() = default;
  virtual ~Term() = default;
  Term(const Term&) = delete;
  Term& operator=(const Term&) = delete;

  /// What a term writes while solving; one per thread of control.
  struct Scratch {
    virtual ~Scratch() = default;
  };
  [[nodiscard]] virtual std::unique_ptr<Scratch> new_scratch() const { return std::make_unique<Scratch>(); }

  /// Is the gradient that of the energy?
  [[nodiscard]] virtual bool conservative() const { return true; }

  /// The terms so far at one shape.
  struct Sum {
    Points& gradient;         // #V by 3 [N]
    double energy = 0;        // [mJ]
    bool inverted = false;    // an element is
    bool forbidden = false;   // one has no energy there; energy and gradient are then meaningless
    bool left_field = false;  // a field is not known there
  };
  /// Adds energy and gradient.
  virtual void evaluate(const Iterate& at, const Demand& demand, Scratch& scratch, Sum& sum, Team& team) const = 0;

  /// Adds the vertices that it couples in every shape, as cliques.
  virtual void add_cliques(linear::Cliques& /*cliques*/) {}
  /// Does what it couples in the shape that was evaluated last lack slots?
  [[nodiscard]] virtual bool lacks_slots(const Scratch& /*scratch*/) const { return false; }
  /// Adds what it couples in that shape, and soon may, beside those cliques; their slots are its own from now on.
  virtual void add_cliques_of(const Iterate& /*at*/, Scratch& /*scratch*/, linear::Cliques& /*cliques*/,
                              Team& /*team*/) const {}

  /// Second derivatives into its own slots, or added to those of terms before it, 9 values each [N/mm], at the shape
  /// that was evaluated last. projected: made positive semidefinite, part by part
  virtual void stiffness(const Iterate& /*at*/, const Demand& /*demand*/, bool /*projected*/, Scratch& /*scratch*/,
                         LargeVector<double>& /*slots*/, Team& /*team*/) const {}
  /// Are these all? Else a response is added to them.
  [[nodiscard]] virtual bool symmetric() const { return true; }
  /// Adds what moves of the vertices change of the gradient beside that: what is not symmetric [N].
  virtual void add_response(const Iterate& /*at*/, const Points& /*moves*/, const Scratch& /*scratch*/,
                            Points& /*force*/) const {}

  /// Adds how the gradient changes from one demand to another in one shape [N], at least to first order.
  virtual void add_change(const Demand& /*from*/, const Demand& /*to*/, const Points& /*positions*/,
                          Scratch& /*scratch*/, Points& /*force*/, Team& /*team*/) const {}
  /// Adds the derivative of the gradient by a command in one shape [N per unit of command].
  virtual void add_derivative(Index /*command*/, const Demand& /*demand*/, const Points& /*positions*/,
                              Scratch& /*scratch*/, Points& /*force*/, Team& /*team*/) const {}
  /// Is a command a load that it lays on the robot: not a measure or a ratio, which the robot answers with a load.
  [[nodiscard]] virtual bool loads(Index /*command*/) const { return false; }
  /// Is it a load that grows with the share of what is done at once, as weight is?
  [[nodiscard]] virtual bool grows() const { return false; }

  /// The share in [0, 1] of a motion that it lets go, every vertex on its straight way.
  [[nodiscard]] virtual double longest_step(const Points& /*from*/, const Points& /*to*/, Scratch& /*scratch*/,
                                            Team& /*team*/) const {
    return 1;
  }

  /// Does its stiffness come and go within a step, so that only its energy says whether the step leads down.
  [[nodiscard]] virtual bool kinked() const { return false; }

  /// Its part of what is told of an equilibrium, which was evaluated last.
  virtual void tell(const Iterate& /*at*/, const Demand& /*demand*/, Scratch& /*scratch*/, ElementDeformation& /*out*/,
                    Team& /*team*/) const {}
};

}  // namespace softkin::physical
