#pragma once

#include <optional>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/contacts.hpp>
#include <softkin/statics/physical/layers.hpp>
#include <softkin/statics/physical/loads.hpp>
#include <softkin/statics/physical/placement.hpp>
#include <softkin/statics/physical/predictor_history.hpp>
#include <softkin/statics/physical/saddle.hpp>
#include <softkin/statics/solver_options.hpp>

namespace softkin::physical {

class System;

/// Everything that is written while solving; one per thread of control. Nothing is allocated per iteration.
struct Workspace {
  explicit Workspace(const System& system);

  std::vector<std::unique_ptr<Term::Scratch>> terms;  // of each
  Body::Scratch& elastic;
  FadingLoads::Scratch& fading;
  Contacts::Scratch* contacts;  // where there is contact
  Layers::Scratch* layers;      // where there are some

  SolverOptions options{};      // of the solve that uses the workspace, which sets them when it begins
  bool left_field = false;      // was a shape outside the domain of a field, as outside a grid
  std::uint64_t evaluated = 0;  // number of evaluations
  /// The stiffness.
  struct Assembled {
    std::uint64_t assembled = 0;             // evaluation of which the slots contain the exact stiffness; 0: none
    std::shared_ptr<const Layout> layout{};  // of the slots
    LargeVector<double> slots{}, blocks{}, values{};
  };
  Assembled stiffness;
  Points gradient;             // of the Lagrangian in x
  Points moves;                // of multiply()
  Placement::Scratch placing;  // of advance()
  std::vector<Points> slopes;  // of each active measure

  /// The approximate softest mode under the constraints, of length 1, and its curvature.
  struct Softest {
    Eigen::VectorXd direction;
    double curvature;
  };
  /// The origin of the last factorisation.
  struct Factored {
    std::uint64_t by = 0;            // its evaluation,
    Points shape;                    // its shape,
    bool exact = false;              // is the stiffness neither made positive nor shifted,
    std::optional<Softest> softest;  // if it was requested
  };
  Saddle saddle;  // the last factorisation
  Factored factored;

  Points solved_shape;                 // equilibrium at which the last solve ended, and near which it factorised
  PredictorHistory predictor_history;  // last equilibria on the path to `solved_shape`
  Slopes tangents;                     // of an equilibrium
  std::optional<State> initial_guess;  // from the caller, for the next solve from there; multipliers in internal units
};

}  // namespace softkin::physical
