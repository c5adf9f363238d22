#pragma once

#include <memory>
#include <softkin/core/team.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/iterate.hpp>

namespace softkin::physical {

/// A part of the energy of a robot: elastic energy of elements, energy in fields and under weights, contact. Terms are
/// independent of each other. An equilibrium is a shape at which their gradients balance the constraint forces.
///
/// A term overrides the functions that it needs and inherits the defaults below for the rest: most terms couple no
/// further vertices, and few contribute to the description of an equilibrium.
class Term {
 public:
  Term() = default;
  virtual ~Term() = default;
  Term(const Term&) = delete;
  Term& operator=(const Term&) = delete;

  /// Data that a term writes while solving; one object per thread of control.
  struct Scratch {
    virtual ~Scratch() = default;
  };
  [[nodiscard]] virtual std::unique_ptr<Scratch> new_scratch() const { return std::make_unique<Scratch>(); }

  /// Is the gradient that of the energy?
  [[nodiscard]] virtual bool conservative() const { return true; }

  /// The sum of the terms evaluated so far at one shape.
  struct Sum {
    Points& gradient;         // #V by 3 [N]
    double energy = 0;        // [mJ]
    bool inverted = false;    // an element is inverted
    bool forbidden = false;   // an element has no energy there; energy and gradient are then undefined
    bool left_field = false;  // a field is not defined there
  };
  /// Adds energy and gradient.
  virtual void evaluate(const Iterate& at, const LoadState& load_state, Scratch& scratch, Sum& sum,
                        Team& team) const = 0;

  /// Adds the cliques of vertices that the term couples in every shape.
  virtual void add_cliques(linear::Cliques& /*cliques*/) {}
  /// Does the term lack slots for the vertices that it couples in the shape evaluated last?
  [[nodiscard]] virtual bool lacks_slots(const Scratch& /*scratch*/) const { return false; }
  /// Adds the cliques of vertices that it couples in that shape, or may couple soon, in addition to those above. From
  /// then on it owns their slots.
  virtual void add_cliques_of(const Iterate& /*at*/, Scratch& /*scratch*/, linear::Cliques& /*cliques*/,
                              Team& /*team*/) const {}

  /// Writes the tangent stiffness into the term's slots, or adds it to that of earlier terms, 9 values each [N/mm],
  /// at the shape evaluated last. projected: they are made positive semidefinite, part by part
  virtual void stiffness(const Iterate& /*at*/, const LoadState& /*load_state*/, bool /*projected*/,
                         Scratch& /*scratch*/, LargeVector<double>& /*slots*/, Team& /*team*/) const {}
  /// Is stiffness() the whole derivative of the gradient? Otherwise add_response() adds the rest.
  [[nodiscard]] virtual bool symmetric() const { return true; }
  /// Adds the unsymmetric part of the change of the gradient under moves of the vertices, which stiffness() lacks [N].
  virtual void add_response(const Iterate& /*at*/, const Points& /*moves*/, const Scratch& /*scratch*/,
                            Points& /*force*/) const {}

  /// Adds the change of the gradient from one load state to another in one shape [N], at least to first order.
  virtual void add_change(const LoadState& /*from*/, const LoadState& /*to*/, const Points& /*positions*/,
                          Scratch& /*scratch*/, Points& /*force*/, Team& /*team*/) const {}
  /// Adds the derivative of the gradient by a command in one shape [N per unit of command].
  virtual void add_derivative(Index /*command*/, const LoadState& /*load_state*/, const Points& /*positions*/,
                              Scratch& /*scratch*/, Points& /*force*/, Team& /*team*/) const {}
  /// Is a command a load that the term applies to the robot, and not a measure or a ratio, to which a load responds?
  [[nodiscard]] virtual bool loads(Index /*command*/) const { return false; }
  /// Is the term a load that is proportional to the load factor, as weight is?
  [[nodiscard]] virtual bool grows() const { return false; }

  /// Returns the fraction in [0, 1] of a motion that the term admits, with every vertex on a straight path.
  [[nodiscard]] virtual double longest_step(const Points& /*from*/, const Points& /*to*/, Scratch& /*scratch*/,
                                            Team& /*team*/) const {
    return 1;
  }

  /// Can the stiffness change abruptly within a step, so that only the energy shows whether the step descends?
  [[nodiscard]] virtual bool kinked() const { return false; }

  /// Adds the term's part of the description of the equilibrium evaluated last.
  virtual void describe(const Iterate& /*at*/, const LoadState& /*load_state*/, Scratch& /*scratch*/,
                        ElementDeformation& /*out*/, Team& /*team*/) const {}
};

}  // namespace softkin::physical
