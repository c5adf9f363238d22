#pragma once

#include <softkin/core/dense.hpp>
#include <softkin/linear/mixed_ldlt.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/contacts.hpp>
#include <softkin/statics/physical/loads.hpp>
#include <softkin/statics/physical/magnets.hpp>
#include <softkin/statics/physical/surroundings.hpp>
#include <softkin/statics/physical/trail.hpp>
#include <softkin/statics/supports/actuator_measures.hpp>
#include <softkin/statics/supports/freedoms.hpp>
#include <softkin/statics/supports/global_step.hpp>
#include <softkin/statics/supports/reduced_matrix.hpp>
#include <softkin/statics/supports/turning.hpp>
#include <utility>

namespace softkin::physical {

/// Equations of equilibrium: gradient of energy(x) + sum_a sign_a multiplier_a measure_a(x) - load . x is zero in the
/// unknowns, and measure_a(x) = demand for every active constraint. sign: +1 for cables, -1 for chambers. The energy is
/// the sum of the terms'; multipliers of dea actuators under voltage are told, but not read.
class System {
 public:
  explicit System(const Model& model);

  /// What the matrix of a factorisation looks like.
  struct Layout {
    linear::BlockPattern pattern;  // over vertices
    supports::ReducedMatrix reduced;
    std::shared_ptr<const linear::FrontTree> symbolic;
    std::int64_t slots = 0;  // of the cliques of the pattern
  };

  /// How an equilibrium changes with the commands: what a derivative found.
  struct Slopes {
    Points at;                           // no rows: not known
    std::vector<Index> held;             // the constraints that were
    Eigen::MatrixXd moves, multipliers;  // of the unknowns, of the constraints, per unit of each command
    Eigen::VectorXd foreseen_for{};      // an actuation whose equilibrium was foreseen from here; empty: none
    Iterate foreseen{};
  };

  /// Everything that is written while solving; one per thread of control. Nothing is allocated per iteration.
  struct Workspace {
    explicit Workspace(const System& system);

    std::vector<std::unique_ptr<Term::Scratch>> terms;  // of each
    Body::Scratch& elastic;
    FadingLoads::Scratch& fading;
    Contacts::Scratch* contacts;  // where there is contact
    /// Every column becomes nearly its solution, as linear::MixedLdlt says, with the last factorisation.
    void solve(Eigen::Ref<Eigen::MatrixXd> right_sides, Team& team);

    bool left_field = false;                          // was a shape where a field is not known, as outside a grid
    std::uint64_t evaluated = 0;                      // times
    std::uint64_t assembled = 0;                      // by which the exact stiffness in the slots is; 0: none is there
    std::uint64_t factorised_by = 0;                  // the same of the factor
    std::shared_ptr<const Layout> layout;             // of the slots
    std::shared_ptr<const Layout> factorised_layout;  // of the factor
    LargeVector<double> slots, blocks, values;
    Eigen::MatrixXd in_columns;  // right-hand sides in the order of the layout, where it has its own
    Points gradient;             // of the Lagrangian in x
    Points moves, lacking;       // of advance()
    std::vector<Points> slopes;  // of each active measure
    linear::MixedLdlt factor;
    linear::MixedLdlt::Precision precision;  // asked of the next
    Eigen::MatrixXd solutions;               // of the last factorisation: responses, then the step without constraints
    Eigen::MatrixXd responses;               // K^-1 G, a column per active constraint, in the order of `active`
    Eigen::MatrixXd constraint_slopes;       // G: sign_a times the gradient of measure_a
    Eigen::VectorXd scale;                   // S: makes the diagonal of the next 1
    MinimumNorm schur;                       // S G^T K^-1 G S; singular where constraints depend on each other
    std::vector<Index> active;               // constraints of the factorisation
    double stiffest = 0;                     // the largest of the diagonal [N/mm] of the last factorisation
    double mean = 0;                         // and their mean
    bool exact = false;                      // the last factorisation: the stiffness neither made positive nor shifted
    int negative = 0;                        // its negative eigenvalues,
    int unstable = 0;                        // and those that the constraints leave
    Points factorised;                       // its shape
    Eigen::VectorXd softest;  // nearly its softest change that the constraints leave, of length 1; empty: not asked for
    double softness = 0;      // its curvature along that
    Points home;              // equilibrium at which the last solve ended, and near which it factorised
    Trail trail;              // that led there
    Slopes tangents;          // of an equilibrium
  };

  struct Balance {
    Eigen::VectorXd force;         // of the unknowns, what is not in balance [N, N mm]
    Eigen::VectorXd constraint;    // m: measure minus demand, 0 where not active [mm, mm^3]
    double energy = 0;             // elastic and of contact, less the work of dead loads [mJ]
    double load_energy = 0;        // of measures whose multipliers are given [mJ]
    bool inverted = false;         // an element
    bool forbidden = false;        // inverted where the law has no energy
    std::uint64_t evaluation = 0;  // of the workspace
  };

  /// active: per actuator, is its measure held at the demand (else its multiplier is given).
  void evaluate(const Iterate& at, const Demand& demand, const std::vector<bool>& active, Workspace& work,
                Balance& balance, Team& team) const;

  // What follows and takes the balance of an evaluation asks for the last one of the workspace.
  // throws std::logic_error on another one

  /// How well forces balance at an iterate [N].
  struct Imbalance {
    double residual = 0;  // on a vertex or a rigid region, the largest
    double pull = 0;      // of the elements on a vertex, sum of magnitudes, the largest
    double rounding = 0;  // what rounding of the positions may leave on a vertex
  };
  [[nodiscard]] Imbalance imbalance(const Balance& balance, const Workspace& work, Team& team) const;

  /// What Maxwell branches remember, and the time since then [s], for all that a workspace evaluates next; see Body.
  void set_time(std::shared_ptr<const ViscousHistory> history, double elapsed_s, Workspace& work, Team& team) const;
  [[nodiscard]] bool viscous() const { return body_.viscous(); }
  /// What they remember of an equilibrium; see Body.
  [[nodiscard]] std::shared_ptr<const ViscousHistory> flow(const State& at, Workspace& work, double& lost_mJ,
                                                           Team& team) const {
    return body_.flow({at.actuation, at.share}, at.positions, work.elastic, lost_mJ, team);
  }
  [[nodiscard]] std::size_t remembered() const { return body_.remembered(); }
  /// The demand of a way that begins where forces are not in balance: what they lack fades along it.
  [[nodiscard]] Demand unbalanced(const Iterate& at, const Demand& demand, Workspace& work, Team& team) const;

  enum class Stiffness { exact, projected };
  /// Which stiffness is factorised.
  struct Factoring {
    Stiffness kind = Stiffness::exact;
    double shift = 0;   // times the mean diagonal, added
    bool step = false;  // is first_step() to follow: the balance's step is solved for together with the responses
  };
  /// Stiffness at an iterate, factorised. Where nothing can touch, what was assembled is lost; multiply() is as ready
  /// as after gather() if nothing was shifted.
  ///
  /// balance  of its evaluation
  /// returns  how many negative eigenvalues it has on the changes that keep the active measures: 0 at a stable
  ///          equilibrium
  int factorise(const Iterate& at, const Demand& demand, const std::vector<bool>& active, const Balance& balance,
                const Factoring& factoring, Workspace& work, Team& team) const;

  /// What the last factorisation holds of the active measures, from their slopes at an iterate.
  void couple(const Iterate& at, const std::vector<bool>& active, const Balance& balance, Workspace& work,
              Team& team) const;

  /// Stiffness of the elements and measures at an iterate, as factorise() makes it itself.
  void assemble(const Iterate& at, const Demand& demand, const Balance& balance, Stiffness kind, Workspace& work,
                Team& team) const;
  /// Makes the stiffness that was assembled last ready for multiply().
  void gather(const Iterate& at, const Balance& balance, Workspace& work, Team& team) const;
  /// K times every column, over the unknowns, at the iterate that was gathered, and what the normal forces that limit
  /// friction add to it, which no factor holds. product: of vectors' size
  void multiply(const Iterate& at, const Eigen::MatrixXd& vectors, Workspace& work, Eigen::MatrixXd& product,
                Team& team) const;

  /// Derivative of the gradient of the Lagrangian by a command that no measure answers to, at fixed positions of all
  /// that is free, #V by 3 [N per unit of command]. moves: of what is commanded to move, per unit
  void command_force(const Iterate& at, const Demand& demand, const Balance& balance, Index actuator, Workspace& work,
                     Points& force, Points& moves, Team& team) const;

  /// Slopes of the active measures by the unknowns, with their signs, at an iterate.
  void reduce_slopes(const Iterate& at, const Balance& balance, const Workspace& work, Eigen::MatrixXd& slopes) const;

  /// Newton step of the balance with which the last factorisation was made.
  void first_step(const Balance& balance, Workspace& work, Eigen::VectorXd& step, Eigen::VectorXd& change) const;

  /// Newton step of the last factorisation: K step + G change = -force, G^T step = -sign constraint; where constraints
  /// contradict each other, what misses them least.
  void step(const Balance& balance, Workspace& work, Eigen::VectorXd& step, Eigen::VectorXd& change, Team& team) const;

  /// What the next step would change multipliers by, without one: G^T K^-1 force needs no solve.
  void correct_multipliers(const Balance& balance, const Workspace& work, Eigen::VectorXd& multipliers) const;

  /// Does a change of demand move what holds the robot or stands around it?
  [[nodiscard]] bool moves_supports(const Demand& from, const Demand& to) const;
  /// Balance that a change of demand upsets, to first order: for the tangent predictor. Where it moves supports the
  /// stiffness is to be assembled.
  void upset(const Iterate& at, const Demand& from, const Demand& to, const std::vector<bool>& active, Workspace& work,
             Balance& balance, Team& team) const;

  /// Stress, reactions and what touches at an equilibrium.
  void measure(const Iterate& at, const Demand& demand, Workspace& work, ElementDeformation& out, Team& team) const;

  /// Moves positions by scale times a step; elements turn with it instead of growing: equal to Freedoms::move to first
  /// order, and far better where a step bends the robot.
  /// held  what is fixed or commanded to move comes to where this has it
  void advance(const Eigen::VectorXd& step, double scale, Workspace& work, Points& positions, Team& team,
               const Demand* held = nullptr) const;

  /// Puts what is fixed or commanded to move where a demand has it, and rigid regions into the pose that fits best.
  void hold(const Demand& demand, Points& positions) const;

  /// Supports that turn.
  [[nodiscard]] const supports::Turning& turning() const { return supports_turn_; }

  /// What touches; null: nothing can.
  [[nodiscard]] const Contacts* contacts() const { return contacts_.get(); }
  [[nodiscard]] bool contact() const { return contacts_ != nullptr; }
  [[nodiscard]] bool friction() const { return contacts_ && contacts_->friction().any(); }

  /// Largest and root mean square move of a vertex [mm] that unknowns stand for.
  struct Size {
    double largest = 0, mean = 0;
  };
  [[nodiscard]] Size size_of(const Eigen::VectorXd& unknowns, const Points& positions) const;

  [[nodiscard]] const Model& model() const { return model_; }
  /// In the order in which they are added; a workspace has their scratch in the same.
  [[nodiscard]] const std::vector<const Term*>& terms() const { return terms_; }
  [[nodiscard]] const supports::Freedoms& freedoms() const { return *freedoms_; }
  [[nodiscard]] const supports::ActuatorMeasures& measures() const { return measures_; }
  [[nodiscard]] Index actuators() const { return static_cast<Index>(model_.actuators.size()); }
  /// Of a shape whose multipliers are known.
  [[nodiscard]] Iterate iterate(const State& at) const {
    Iterate shape{at.positions, at.multipliers, at.anchors};
    for (Index a = 0; a < actuators(); ++a) shape.multipliers[a] *= measures_.unit(a);
    return shape;
  }
  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }
  /// Does a command load the robot without a measure: a voltage, a magnetic field, a force on a body, what holds it.
  [[nodiscard]] bool loads(Index actuator) const;
  /// Is the derivative of the gradient by the shape symmetric?
  [[nodiscard]] bool symmetric() const;
  /// Are there loads that grow with the share: weight, forces, dipoles.
  [[nodiscard]] bool any_dead_load() const;
  [[nodiscard]] bool prestretched() const { return body_.prestretched(); }

 private:
  bool loses_energy(Workspace& work, Team& team) const;
  [[nodiscard]] bool multiplies_unknowns(const Workspace& work) const;
  void give_slots(const Iterate& at, Workspace& work, Team& team) const;
  static void require_last(const Balance& balance, const Workspace& work);
  void ask(const Iterate& at, const std::vector<bool>& active, const Balance& balance, bool step,
           Workspace& work) const;
  void close(Workspace& work) const;
  [[nodiscard]] Eigen::VectorXd closing(const Balance& balance, const Workspace& work,
                                        const Eigen::VectorXd& more) const;
  void meet_constraints(const Balance& balance, Workspace& work, Eigen::VectorXd& step, Eigen::VectorXd& change) const;

  /// visit(term, its scratch)
  template <class Visit>
  void each_term(Workspace& work, const Visit& visit) const {
    for (std::size_t i = 0; i < terms_.size(); ++i) visit(*terms_[i], *work.terms[i]);
  }

  const Model& model_;
  Body body_;
  DeadLoads dead_loads_;
  FadingLoads fading_loads_;
  Surroundings surroundings_;
  std::unique_ptr<const Magnets> magnets_;
  std::unique_ptr<Contacts> contacts_;
  supports::ActuatorMeasures measures_;
  supports::Turning supports_turn_;
  std::unique_ptr<supports::Freedoms> freedoms_;
  linear::Cliques cliques_;               // of what couples in every shape
  std::shared_ptr<const Layout> layout_;  // of that alone
  std::vector<const Term*> terms_;        // contact last: nothing is looked for in a shape that is forbidden
  std::unique_ptr<supports::GlobalStep> turning_;
};

/// What is asked of factors while it lives; then again what was.
class InPrecision {
 public:
  InPrecision(System::Workspace& work, linear::MixedLdlt::Precision precision)
      : work_(work), before_(std::exchange(work.precision, precision)) {}
  ~InPrecision() { work_.precision = before_; }
  InPrecision(const InPrecision&) = delete;
  InPrecision& operator=(const InPrecision&) = delete;

 private:
  System::Workspace& work_;
  linear::MixedLdlt::Precision before_;
};

}  // namespace softkin::physical
