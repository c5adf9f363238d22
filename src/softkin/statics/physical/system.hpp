#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/actuator_loads.hpp>
#include <softkin/statics/physical/body.hpp>
#include <softkin/statics/physical/contacts.hpp>
#include <softkin/statics/physical/fibre_families.hpp>
#include <softkin/statics/physical/fibres.hpp>
#include <softkin/statics/physical/hydrostatics.hpp>
#include <softkin/statics/physical/layers.hpp>
#include <softkin/statics/physical/loads.hpp>
#include <softkin/statics/physical/magnets.hpp>
#include <softkin/statics/physical/moments.hpp>
#include <softkin/statics/physical/placement.hpp>
#include <softkin/statics/physical/pressures.hpp>
#include <softkin/statics/physical/surroundings.hpp>
#include <softkin/statics/physical/tractions.hpp>
#include <softkin/statics/physical/workspace.hpp>

namespace softkin::physical {

/// Equations of equilibrium: gradient of energy(x) + sum_a sign_a multiplier_a measure_a(x) - load . x is zero in the
/// unknowns, and measure_a(x) = demand for every active constraint: of a sealed chamber the volume that multiplier_a
/// leaves of what fills it. sign: +1 for cables, -1 for chambers. The energy is the sum of the terms'; multipliers of
/// dea actuators under voltage are told, but not read. Pressures of mixed elements are vertices more (see Pressures),
/// unknowns as others: the energy is stationary in them, too.
class System {
 public:
  explicit System(const Model& model);
  /// The same equations with other numbers; what depends on the mesh alone is shared. like must outlive the object.
  ///
  /// throws  InvalidInput where the models differ by more
  System(const Model& model, const System& like);

  /// active: per actuator, is its measure held at the demand (else its multiplier is given).
  void evaluate(const Iterate& at, const Demand& demand, const std::vector<bool>& active, Workspace& work,
                Balance& balance, Team& team) const;

  // What follows and takes the balance of an evaluation asks for the last one of the workspace.
  // throws std::logic_error on another one

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
    bool step = false;  // is Saddle::first_step() to follow: the balance's step is solved for with the responses
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

  /// Derivative of the gradient of the Lagrangian by a command that no measure answers to, at fixed positions, #V by 3
  /// [N per unit of command].
  void command_force(const Iterate& at, const Demand& demand, Index actuator, Workspace& work, Points& force,
                     Team& team) const;

  /// Adds what moves of vertices that are no unknowns pull with, at the balance's iterate [N].
  void add_pull(const Iterate& at, const Demand& demand, const Balance& balance, const Points& moves, Workspace& work,
                Points& force, Team& team) const;

  /// Slopes of the active measures by the unknowns, with their signs, at an iterate.
  ///
  /// pulls  what their multipliers pull with, where it is something else; else no columns
  void reduce_slopes(const Iterate& at, const Balance& balance, const Workspace& work, Eigen::MatrixXd& slopes,
                     Eigen::MatrixXd& pulls) const;

  /// Of the active measures, as Saddle has it.
  [[nodiscard]] Eigen::VectorXd compliance(const Balance& balance, const Workspace& work) const;

  /// Balance that a change of demand upsets, to first order: for the tangent predictor. Where it moves supports the
  /// stiffness is to be assembled.
  void upset(const Iterate& at, const Demand& from, const Demand& to, const std::vector<bool>& active, Workspace& work,
             Balance& balance, Team& team) const;
  /// The same of what is held alone, which comes to its place: the forces, on the vertices; of the balance its
  /// constraints alone.
  Points upset_by_held(const Iterate& at, const Demand& to, const std::vector<bool>& active, Workspace& work,
                       Balance& balance, Team& team) const;

  /// Stress, reactions and what touches at an equilibrium.
  void measure(const Iterate& at, const Demand& demand, Workspace& work, ElementDeformation& out, Team& team) const;

  /// See Placement.
  void advance(const Eigen::VectorXd& step, double scale, Workspace& work, Points& positions, Team& team,
               const Demand* held = nullptr) const {
    placement_->advance(step, scale, work.placing, work.elastic, positions, team, held);
  }

  /// What touches; null: nothing can.
  [[nodiscard]] const Contacts* contacts() const { return contacts_.get(); }
  [[nodiscard]] bool contact() const { return contacts_ != nullptr; }
  [[nodiscard]] bool friction() const { return contacts_ && contacts_->friction().any(); }

  /// With the pressures' vertices, where there are any.
  [[nodiscard]] const Model& model() const { return model_; }
  /// Null: no element is mixed.
  [[nodiscard]] const Pressures* pressures() const { return pressures_.get(); }
  /// Of a vertex from one shape to another, whatever pressures do [mm].
  [[nodiscard]] double largest_move(const Points& from, const Points& to) const {
    if (!pressures_) return softkin::largest_move(from, to);
    return softkin::largest_move(from.topRows(pressures_->first), to.topRows(pressures_->first));
  }
  /// Sum of pressures times what their equations miss [mJ]: what the energy of an evaluation lacks to be stationary.
  [[nodiscard]] double pressure_work(const Points& positions, const Eigen::VectorXd& force) const;
  /// Sets what vectors over the unknowns say of pressures to zero.
  void drop_pressures(Eigen::VectorXd& vector) const {
    for (const Index u : freedoms_->scalar_unknowns()) vector[u] = 0;
  }
  /// In the order in which they are added; a workspace has their scratch in the same.
  [[nodiscard]] const std::vector<const Term*>& terms() const { return terms_; }
  [[nodiscard]] const std::shared_ptr<const Layout>& layout() const { return coupling_.layout; }
  [[nodiscard]] const supports::Freedoms& freedoms() const { return *freedoms_; }
  [[nodiscard]] const Placement& placement() const { return *placement_; }
  [[nodiscard]] const supports::ActuatorMeasures& measures() const { return actuator_loads_.measures(); }
  /// What a measure's multiplier pulls with, #V by 3, but for its sign.
  [[nodiscard]] Points pull(Index actuator, const Iterate& at) const {
    Points force;
    actuator_loads_.pull(actuator, at, force);
    return force;
  }
  /// Null: there are none.
  [[nodiscard]] const Layers* layers() const { return layers_.get(); }
  /// Are there sheets beside elements, which have no stiffness where they are flat and slack?
  [[nodiscard]] bool limp() const { return layers_ && layers_->limp(); }
  [[nodiscard]] const Tendons& tendons() const { return actuator_loads_.tendons(); }
  [[nodiscard]] Index actuators() const { return model_.actuators.size(); }
  /// Of a shape whose multipliers are known.
  [[nodiscard]] Iterate iterate(const State& at) const {
    Iterate shape{at.positions, at.multipliers, at.anchors, at.eyelets};
    if (shape.eyelets.empty()) shape.eyelets = tendons().lengths(at.positions);
    for (Index a = 0; a < actuators(); ++a) shape.multipliers[a] *= measures().unit(a);
    return shape;
  }
  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }
  /// Does a command load the robot without a measure: a voltage, a magnetic field, a force on a body, what holds it.
  [[nodiscard]] bool loads(Index actuator) const;
  /// Is the derivative of the terms' gradient by the shape symmetric? What tendons that rub add is not, but factors
  /// hold it.
  [[nodiscard]] bool symmetric() const;
  /// Are the equations of a Newton step those of their adjoint?
  [[nodiscard]] bool reciprocal() const { return symmetric() && !tendons().any(); }
  /// Has all that loads it an energy?
  [[nodiscard]] bool conservative() const;
  /// Does the stiffness of any term come and go within a step?
  [[nodiscard]] bool kinked() const;
  /// Are there loads that grow with the share: weight, forces, dipoles.
  [[nodiscard]] bool any_dead_load() const;
  [[nodiscard]] bool prestretched() const { return body_.prestretched(); }

 private:
  System(const Model& model, const System* like);
  System(const Model& model, std::unique_ptr<const Pressures> pressures, const System* like);
  void make_layout();
  void share_layout(const System& like);
  [[nodiscard]] bool multiplies_unknowns(const Workspace& work) const;
  void give_slots(const Iterate& at, Workspace& work, Team& team) const;
  static void require_last(const Balance& balance, const Workspace& work);
  void ask(const Iterate& at, const std::vector<bool>& active, const Balance& balance, Workspace& work) const;

  /// visit(term, its scratch)
  template <class Visit>
  void each_term(Workspace& work, const Visit& visit) const {
    for (std::size_t i = 0; i < terms_.size(); ++i) visit(*terms_[i], *work.terms[i]);
  }

  std::unique_ptr<const Pressures> pressures_;
  std::unique_ptr<const Model> own_;  // where there are any
  const Model& model_;
  Body body_;
  DeadLoads dead_loads_;
  FadingLoads fading_loads_;
  Surroundings surroundings_;
  std::unique_ptr<Tractions> tractions_;
  std::unique_ptr<Hydrostatics> hydrostatics_;
  std::unique_ptr<Moments> moments_;
  std::unique_ptr<const FibreFamilies> families_;
  std::unique_ptr<Fibres> fibres_;
  std::unique_ptr<Layers> layers_;
  std::unique_ptr<const Magnets> magnets_;
  std::unique_ptr<Contacts> contacts_;
  ActuatorLoads actuator_loads_;
  std::unique_ptr<const supports::Freedoms> freedoms_;
  std::unique_ptr<const Placement> placement_;
  /// What couples in every shape.
  struct Coupling {
    linear::Cliques cliques;
    std::shared_ptr<const Layout> layout;  // of these alone
  };
  Coupling coupling_;
  std::vector<const Term*> terms_;  // contact last: nothing is looked for in a shape that is forbidden
};

}  // namespace softkin::physical
