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

/// Equations of equilibrium: the gradient of energy(x) + sum_a sign_a multiplier_a measure_a(x) - load . x is zero in
/// the unknowns, and measure_a(x) is equal to its target for every active constraint. The target of a sealed chamber is
/// the volume of its filling at the pressure multiplier_a. sign: +1 for cables, -1 for chambers. The energy is the sum
/// of the terms'; multipliers of dea actuators under voltage are reported, but not read. Pressures of mixed elements
/// are additional vertices (see Pressures) and unknowns like others: the energy is stationary in them, too.
class System {
 public:
  explicit System(const Model& model);
  /// The same equations with other numbers; what depends on the mesh alone is shared. like must outlive the object.
  ///
  /// throws  InvalidInput where the models differ by more
  System(const Model& model, const System& like);

  /// active: per actuator, is its measure constrained to the target (else its multiplier is given).
  void evaluate(const Iterate& at, const LoadState& load_state, const std::vector<bool>& active, Workspace& work,
                Balance& balance, Team& team) const;

  // The functions below that take the balance of an evaluation need that of the last one of the workspace.
  // throws std::logic_error on another one

  [[nodiscard]] Imbalance imbalance(const Balance& balance, const Workspace& work, Team& team) const;

  /// Sets the history of the Maxwell branches, and the time since then [s], for all later evaluations in a workspace;
  /// see Body.
  void set_time(std::shared_ptr<const ViscousHistory> history, double elapsed_s, Workspace& work, Team& team) const;
  [[nodiscard]] bool viscous() const { return body_.viscous(); }
  /// Returns the history of the Maxwell branches at an equilibrium; see Body.
  [[nodiscard]] std::shared_ptr<const ViscousHistory> flow(const State& at, Workspace& work, double& lost_mJ,
                                                           Team& team) const {
    return body_.flow({at.actuation, at.load_factor}, at.positions, work.elastic, lost_mJ, team);
  }
  [[nodiscard]] std::size_t remembered() const { return body_.remembered(); }
  /// Returns the load state of a path that begins where forces are not in equilibrium: their residual becomes a load
  /// that fades along the path.
  [[nodiscard]] LoadState unbalanced(const Iterate& at, const LoadState& load_state, Workspace& work, Team& team) const;

  enum class Stiffness { exact, projected };
  /// Which stiffness is factorised.
  struct Factoring {
    Stiffness kind = Stiffness::exact;
    double shift = 0;   // times the mean diagonal, added
    bool step = false;  // is Saddle::first_step() to follow: the balance's step is solved for with the responses
  };
  /// Assembles and factorises the tangent stiffness at an iterate. Without contact the assembled matrix is overwritten;
  /// multiply() is as ready as after gather() if nothing was shifted.
  ///
  /// balance  of its evaluation
  /// returns  number of negative eigenvalues on the changes that keep the active measures: 0 at a stable equilibrium
  int factorise(const Iterate& at, const LoadState& load_state, const std::vector<bool>& active, const Balance& balance,
                const Factoring& factoring, Workspace& work, Team& team) const;

  /// Sets the part of the last factorisation that belongs to the active measures, from their gradients at an iterate.
  void couple(const Iterate& at, const std::vector<bool>& active, const Balance& balance, Workspace& work,
              Team& team) const;

  /// Stiffness of the elements and measures at an iterate, as factorise() makes it itself.
  void assemble(const Iterate& at, const LoadState& load_state, const Balance& balance, Stiffness kind, Workspace& work,
                Team& team) const;
  /// Makes the stiffness that was assembled last ready for multiply().
  void gather(const Iterate& at, const Balance& balance, Workspace& work, Team& team) const;
  /// Multiplies every column by K, over the unknowns, at the iterate that was gathered, including the contribution of
  /// the normal forces that limit friction, which no factor contains. product: of vectors' size
  void multiply(const Iterate& at, const Eigen::MatrixXd& vectors, Workspace& work, Eigen::MatrixXd& product,
                Team& team) const;

  /// Derivative of the gradient of the Lagrangian by a command that no measure answers to, at fixed positions, #V by 3
  /// [N per unit of command].
  void command_force(const Iterate& at, const LoadState& load_state, Index actuator, Workspace& work, Points& force,
                     Team& team) const;

  /// Adds the change of the gradient along moves of vertices, also of those that are no unknowns, at the balance's
  /// iterate [N].
  void add_pull(const Iterate& at, const LoadState& load_state, const Balance& balance, const Points& moves,
                Workspace& work, Points& force, Team& team) const;

  /// Slopes of the active measures by the unknowns, with their signs, at an iterate.
  ///
  /// pulls  forces per unit of their multipliers, where these differ from the slopes; else no columns
  void reduce_slopes(const Iterate& at, const Balance& balance, const Workspace& work, Eigen::MatrixXd& slopes,
                     Eigen::MatrixXd& pulls) const;

  /// Returns the compliance of the active measures in the form that Saddle takes.
  [[nodiscard]] Eigen::VectorXd compliance(const Balance& balance, const Workspace& work) const;

  /// Computes the first-order change of the residual with the load state, for the tangent predictor. If supports move,
  /// the stiffness must be assembled before.
  void residual_change(const Iterate& at, const LoadState& from, const LoadState& to, const std::vector<bool>& active,
                       Workspace& work, Balance& balance, Team& team) const;
  /// Does the same for the motion of supports alone: returns the forces on the vertices, and sets only the constraints
  /// of the balance.
  Points residual_change_by_supports(const Iterate& at, const LoadState& to, const std::vector<bool>& active,
                                     Workspace& work, Balance& balance, Team& team) const;

  /// Computes stresses, reactions and contacts at an equilibrium.
  void measure(const Iterate& at, const LoadState& load_state, Workspace& work, ElementDeformation& out,
               Team& team) const;

  /// See Placement.
  void advance(const Eigen::VectorXd& step, double scale, Workspace& work, Points& positions, Team& team,
               const LoadState* held = nullptr) const {
    placement_->advance(step, scale, work.placing, work.elastic, positions, team, held);
  }

  /// The contacts; null: no contact is possible.
  [[nodiscard]] const Contacts* contacts() const { return contacts_.get(); }
  [[nodiscard]] bool contact() const { return contacts_ != nullptr; }
  [[nodiscard]] bool friction() const { return contacts_ && contacts_->friction().any(); }

  /// With the pressures' vertices, where there are any.
  [[nodiscard]] const Model& model() const { return model_; }
  /// Null: no element is mixed.
  [[nodiscard]] const Pressures* pressures() const { return pressures_.get(); }
  /// Returns the largest move of a vertex from one shape to another, without pressures [mm].
  [[nodiscard]] double largest_move(const Points& from, const Points& to) const {
    if (!pressures_) return softkin::largest_move(from, to);
    return softkin::largest_move(from.topRows(pressures_->first), to.topRows(pressures_->first));
  }
  /// Returns the sum of pressures times the residuals of their equations [mJ], which the energy of an evaluation lacks
  /// to be stationary.
  [[nodiscard]] double pressure_work(const Points& positions, const Eigen::VectorXd& force) const;
  /// Sets the entries of pressures in a vector over the unknowns to zero.
  void drop_pressures(Eigen::VectorXd& vector) const {
    for (const Index u : freedoms_->scalar_unknowns()) vector[u] = 0;
  }
  /// In the order in which they are added; a workspace has their scratch in the same.
  [[nodiscard]] const std::vector<const Term*>& terms() const { return terms_; }
  [[nodiscard]] const std::shared_ptr<const Layout>& layout() const { return coupling_.layout; }
  [[nodiscard]] const supports::Freedoms& freedoms() const { return *freedoms_; }
  [[nodiscard]] const Placement& placement() const { return *placement_; }
  [[nodiscard]] const supports::ActuatorMeasures& measures() const { return actuator_loads_.measures(); }
  /// Returns the nodal forces per unit of a measure's multiplier, #V by 3, without its sign.
  [[nodiscard]] Points pull(Index actuator, const Iterate& at) const {
    Points force;
    actuator_loads_.pull(actuator, at, force);
    return force;
  }
  /// Null: there are none.
  [[nodiscard]] const Layers* layers() const { return layers_.get(); }
  /// Are there sheets that no element stiffens, and that have no stiffness where they are flat and slack?
  [[nodiscard]] bool has_wrinkling() const { return layers_ && layers_->has_wrinkling(); }
  [[nodiscard]] const Tendons& tendons() const { return actuator_loads_.tendons(); }
  [[nodiscard]] Index actuators() const { return model_.actuators.size(); }
  /// Returns the iterate of a state whose multipliers are known.
  [[nodiscard]] Iterate iterate(const State& at) const {
    Iterate shape{at.positions, at.multipliers, at.anchors, at.eyelets};
    if (shape.eyelets.empty()) shape.eyelets = tendons().lengths(at.positions);
    for (Index a = 0; a < actuators(); ++a) shape.multipliers[a] *= measures().unit(a);
    return shape;
  }
  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }
  /// Does a command load the robot without a measure: a voltage, a magnetic field, a force on a body, a moving support?
  [[nodiscard]] bool loads(Index actuator) const;
  /// Is the derivative of the terms' gradient by the shape symmetric? The contribution of tendons with friction is not,
  /// but factorisations include it.
  [[nodiscard]] bool symmetric() const;
  /// Are the equations of a Newton step those of their adjoint?
  [[nodiscard]] bool reciprocal() const { return symmetric() && !tendons().any(); }
  /// Do all loads have an energy?
  [[nodiscard]] bool conservative() const;
  /// Does the stiffness of any term come and go within a step?
  [[nodiscard]] bool kinked() const;
  /// Are there loads that grow with the load factor: weight, forces, dipoles?
  [[nodiscard]] bool any_dead_load() const;
  [[nodiscard]] bool prestretched() const { return body_.prestretched(); }

 private:
  System(const Model& model, const System* like);
  System(const Model& model, std::unique_ptr<const Pressures> pressures, const System* like);
  void make_layout();
  void reuse_layout(const System& like);
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
  /// The couplings that every shape has.
  struct Coupling {
    linear::Cliques cliques;
    std::shared_ptr<const Layout> layout;  // of these alone
  };
  Coupling coupling_;
  std::vector<const Term*> terms_;  // contact last: nothing is looked for in a shape that is forbidden
};

}  // namespace softkin::physical
