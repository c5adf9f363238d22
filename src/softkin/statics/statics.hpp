#pragma once

#include <memory>
#include <softkin/core/progress.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/sensitivity.hpp>
#include <softkin/statics/solver_options.hpp>

namespace softkin {

/// throws  InvalidInput on a size mismatch or a value outside its actuator's range
void check_actuation(const Model& model, const Actuation& actuation);

/// newton: the fixed point of Algorithm 1 by Newton's method. local_global: Algorithm 1 itself.
enum class Solver { newton, local_global };
/// "newton" or "local-global".
[[nodiscard]] const char* name_of(Solver solver);

/// Where the program that the paper's authors publish ends Algorithm 1: from this iteration on, once no marker has
/// moved farther in an iteration. No equilibrium is reached then.
struct PublishedStop {
  static constexpr int first_iteration = 10;  // from 1
  static constexpr double move_mm = 0.032;    // the largest move of a marker [mm]
};

/// How equilibria are solved for.
struct StaticsOptions {
  Solver solver = Solver::newton;  // physical: newton alone
  /// Largest move of a vertex in one iteration at which a solver stops [mm], > 0. 0: the paper's 1e-5 mm on a robot
  /// of its size, 8e-8 of the bounding box's diagonal.
  double step_tolerance_mm = 0;
  int max_iterations = 0;     // of a step of a solve's path, >= 0; 0: iteration_limit()
  int anderson = 6;           // earlier steps that Anderson acceleration combines, 0 <= anderson <= 20; 0: as printed
  bool as_published = false;  // local_global: without acceleration, to PublishedStop; for what ends there, not for use
  int threads = 0;            // 0: as many as the machine has and the robot's size justifies; the result is the same
  bool keep_history = true;   // SolveReport::history
  bool trace = false;         // SolveReport::trace; physical
  Deadline deadline{};        // solve() ends there, not converged, with its last good shape
  bool stable = false;        // physical: leave an unstable equilibrium along its lowest mode for a stable one
  /// physical: where one pressure or tension that changes reaches its maximum, the path continues past it along the
  /// volume or length, up to this one over that at rest, > 0 [-], and from there back along the same equilibria; 0: it
  /// ends at the maximum.
  double beyond = 0;
  /// The factor of an earlier solve that ended at the start, where no other thread has taken it by then: the same
  /// result within the tolerance. false: bit for bit that of a new object.
  bool reuse_factor = true;
  /// Viscous: the history of the material, none: a long rest under the scene's loads; and the time that passes until
  /// the requested shape [s], >= 0: 0 is the instant answer, infinity the relaxed one, which depends on no history.
  std::shared_ptr<const ViscousHistory> history{};
  double elapsed_s = std::numeric_limits<double>::infinity();
  SolverOptions tuning{};  // the tuned constants of the solvers

  /// Returns the number of iterations without an advance along its path after which a solve ends, not converged, with
  /// its last good shape: max_iterations, or 500 of Newton's method, which 999 of 1,000 random robots that have an
  /// equilibrium do not need, and 50,000 of Algorithm 1.
  [[nodiscard]] int iteration_limit() const {
    if (max_iterations > 0) return max_iterations;
    return solver == Solver::newton ? 500 : 50000;
  }
};

/// Equilibria that are known without being solved.
class GivenEquilibria {
 public:
  GivenEquilibria() = default;
  GivenEquilibria(const GivenEquilibria&) = delete;
  GivenEquilibria& operator=(const GivenEquilibria&) = delete;
  virtual ~GivenEquilibria() = default;

  /// Returns the equilibrium of an actuation inside the ranges; status limit and the start where none is known.
  [[nodiscard]] virtual Equilibrium at(const Actuation& actuation, const State& start) const = 0;
  /// See Statics::sensitivity.
  [[nodiscard]] virtual Sensitivity sensitivity(const State& at) const = 0;
};

/// answers: nothing is solved. starts: every solve begins at the given equilibrium, where there is one, instead of its
/// start; not of robots with contact, whose surfaces would pass through each other.
enum class Given { answers, starts };

/// Equilibria of one robot. Assembles and factorises once, and keeps threads, memory and factors from call to call, so
/// that a solve from the last equilibrium starts nothing. solve() is const and may run on several threads at once.
class Statics {
 public:
  /// model must outlive the object. throws InvalidInput where some part of the robot is not held
  explicit Statics(const Model& model);
  /// Of a robot that differs from another one in numbers alone: what depends on the mesh is shared. like must outlive
  /// the object.
  ///
  /// throws  InvalidInput where they differ by more; as the first
  Statics(const Model& model, const Statics& like);
  /// Of a robot whose equilibria are given, or whose equilibria are found from those that are.
  Statics(const Model& model, std::unique_ptr<const GivenEquilibria> given, Given use = Given::answers);
  ~Statics();
  Statics(Statics&&) noexcept;
  Statics& operator=(Statics&&) noexcept;

  /// The robot whose equilibria they are.
  [[nodiscard]] const Model& model() const;

  /// The robot at rest, without an actuation: where a first solve begins.
  [[nodiscard]] State rest() const;

  /// Equilibrium shape under one actuation.
  ///
  /// actuation  m values in model.actuators order: length, area or volume over that at rest [-], or tension [N] or
  ///            gauge pressure [kPa] where control is load
  /// start      where the search begins; its positions are n x 3 [mm]; fixed vertices and rigid regions of it are
  ///            projected to their supports
  /// returns    positions n x 3 [mm], multipliers [N or kPa] (physical formulation, else 0) and report; not converging
  ///            is report.status
  /// source     target-shape: Fang et al. 2020, Alg. 1, Eqs. (1)-(11) as corrected in docs/paper.md; Newton: same
  ///            equilibrium
  /// throws     InvalidInput on a size mismatch, a start that is not finite, or a value outside its actuator's range
  [[nodiscard]] Equilibrium solve(const Actuation& actuation, const State& start, const StaticsOptions& options = {},
                                  const ProgressCallback& progress = {}) const;

  /// Returns the derivatives of an equilibrium by its actuation, by implicit differentiation of the equations that
  /// solve() meets; with the factor that the solve left behind where there is one.
  ///
  /// at        an equilibrium that solve() returned; its actuation and, physical, its multipliers must be known
  /// accuracy  of the derivatives, relative, > 0: bound of the preconditioned residual of the equations
  /// returns   zero by slack cables, which are those without tension that are shorter than their largest length;
  ///           another one without tension counts as one in tension. Not regular at a limit of existence
  /// throws    InvalidInput on a size mismatch, an unknown actuation, or a number that is not finite
  [[nodiscard]] Sensitivity sensitivity(const State& at, const StaticsOptions& options = {},
                                        double accuracy = 1e-8) const;

  /// The same along some changes of the actuation alone.
  ///
  /// changes    k of m values each, in the units of the commands
  /// reactions  are those of supports computed, too
  /// returns    of each change; see ParameterSensitivity
  /// throws     InvalidInput as the other, of target shapes, and on a change that is not of m finite values
  [[nodiscard]] ParameterSensitivity sensitivity_along(const State& at, const std::vector<Actuation>& changes,
                                                       const StaticsOptions& options = {}, double accuracy = 1e-8,
                                                       bool reactions = false) const;

  /// Returns the moves of vertices under dead forces on them. Where the stiffness is symmetric they are also
  /// derivatives of a number by a force anywhere, if the derivative of that number by the vertices' places is the dead
  /// force: one solution serves all places.
  ///
  /// at       as sensitivity() has it
  /// forces   k, each #V by 3 [N]
  /// returns  k, each #V by 3 [mm]; none of target shapes, where friction or follower loads make the stiffness not
  ///          symmetric, and at a limit of existence
  /// source   Maxwell 1864, Betti 1872: reciprocity
  /// throws   InvalidInput as sensitivity() does, and on forces of another size or that are not finite
  [[nodiscard]] std::vector<Points> reciprocal_moves(const State& at, const std::vector<Points>& forces,
                                                     const StaticsOptions& options = {}, double accuracy = 1e-8) const;

  /// Extrapolates the shape under another actuation to second order, at a small part of the cost of a solve. A solve
  /// that follows, from the same equilibrium to that actuation or near it, begins there.
  ///
  /// at         an equilibrium that solve() returned and whose sensitivity() was computed
  /// positions  n x 3 [mm]
  /// returns    false where the derivatives are not stored any more, where contact is possible, and of target shapes
  /// throws     InvalidInput as solve() and sensitivity() do
  bool extrapolate(const Actuation& actuation, const State& at, const StaticsOptions& options, Points& positions) const;

  /// Sets where the next solve from an equilibrium to an actuation begins, instead of along the tangent; the current
  /// factor serves where that is near.
  ///
  /// at     an equilibrium that solve() returned
  /// there  positions n x 3 [mm], actuation, multipliers [N or kPa]
  /// returns  false where extrapolates() is, of mixed elements, and where the data of the last solve are not stored any
  ///          more
  /// throws   InvalidInput as solve() does
  bool set_initial_guess(const State& at, State there, const StaticsOptions& options) const;

  /// Does extrapolate() work for this robot: in the physical formulation, without contact?
  [[nodiscard]] bool extrapolates() const;

  /// Returns the deformation of a shape, see deformation_of, and in the physical formulation stresses and forces, too.
  ///
  /// at       a state that solve() returned; without its actuation, where a search ended on its path: deformation_of
  ///          alone
  /// throws   InvalidInput as sensitivity() does
  [[nodiscard]] ElementDeformation measured(const State& at) const;

  /// Returns the changes of the contact forces on obstacles and bodies along moves of the vertices.
  ///
  /// at       an equilibrium that solve() returned
  /// moves    k, each #V by 3 [mm]
  /// returns  k, each of model.contact.parts: change of the sum of the contact forces on a part, with friction as if
  ///          sliding continued [N]; zero of parts of the robot and where no contact is possible
  /// throws   InvalidInput as sensitivity() does, of target shapes, and on moves of another size or that are not finite
  [[nodiscard]] std::vector<std::vector<Vec3>> pressing_changes(const State& at,
                                                                const std::vector<Points>& moves) const;

  /// Has the robot Maxwell branches? Then solve() takes a history and a time.
  [[nodiscard]] bool viscous() const;

  /// Returns the history of the material after an equilibrium, for the solves that follow it.
  ///
  /// at       an equilibrium that solve() returned, with its history and time
  /// returns  no history where the robot is not viscous
  /// throws   InvalidInput as sensitivity() does
  [[nodiscard]] ViscousFlow flow(const State& at) const;

  /// Drops the factors that earlier solves left behind: the next result is that of a new object. Not while another
  /// thread solves.
  void forget() const;

 private:
  friend class Neighbourhood;
  friend class Perturbations;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// How equilibria change with numbers of their robot: anything in its description but its mesh and which vertices are
/// held. The equations are differentiated by central differences between perturbed models, the equilibrium exactly.
class Perturbations {
 public:
  /// statics and the models must outlive the object.
  ///
  /// perturbed  by about 1e-5 of the number, or of its typical size: more is less accurate, less is rounded
  /// throws     InvalidInput in the target-shape formulation, and where the models differ by more than numbers
  Perturbations(const Statics& statics, const std::vector<Perturbed>& perturbed);
  ~Perturbations();
  Perturbations(Perturbations&&) noexcept;
  Perturbations& operator=(Perturbations&&) noexcept;

  /// As Statics::sensitivity. Several threads may call it at once. reactions: those of supports, too
  [[nodiscard]] ParameterSensitivity at(const State& at, const StaticsOptions& options = {}, double accuracy = 1e-8,
                                        bool reactions = false) const;

  /// Returns the gradients of reported numbers of an equilibrium by all perturbed numbers. It solves K Y = G^T in place
  /// of K X = F, once for each reported number, however many perturbed ones there are. Where the equations are not
  /// self-adjoint (friction, tendons with friction), it solves once for each perturbed number.
  ///
  /// reported  k gradients by the vertices' places and the loads
  /// returns  k by numbers; no columns at a limit of existence or a branch
  /// throws   InvalidInput as at(), and on gradients of another size or that are not finite
  [[nodiscard]] Eigen::MatrixXd gradients(const State& at, const std::vector<ShapeGradient>& reported,
                                          const StaticsOptions& options = {}, double accuracy = 1e-8) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// First-order predictions of the equilibria around one, which is factorised once for all of them.
class Neighbourhood {
 public:
  /// statics must outlive the object.
  /// at      an equilibrium that solve() returned; its actuation must be known
  /// throws  InvalidInput as Statics::sensitivity does
  Neighbourhood(const Statics& statics, const State& at, int threads = 1);
  ~Neighbourhood();
  Neighbourhood(Neighbourhood&&) noexcept;
  Neighbourhood& operator=(Neighbourhood&&) noexcept;

  /// A start for Statics::solve() at an actuation near by, a function of the arguments alone. Target shapes, and where
  /// the stiffness has no inverse: the equilibrium itself.
  ///
  /// throws  InvalidInput as check_actuation does
  [[nodiscard]] State predict(const Actuation& actuation);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace softkin
