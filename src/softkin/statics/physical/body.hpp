#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <softkin/core/team.hpp>
#include <softkin/energy/dielectric.hpp>
#include <softkin/energy/pressure.hpp>
#include <softkin/energy/viscous.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/growth.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/physical/fibre_families.hpp>
#include <softkin/statics/physical/pressures.hpp>
#include <softkin/statics/physical/term.hpp>
#include <tuple>

namespace softkin::physical {

/// The body of a robot in the physical formulation: the elastic energy, the energy of the electric field in layers
/// under voltage, and their derivatives by the positions of vertices and, for mixed elements, by the pressures. Growth
/// changes the elements at rest: their shape function gradients and volumes depend on the command.
class Body : public Term {
 public:
  /// pressures: of model's last vertices; null: it has none
  explicit Body(const Model& model, const Pressures* pressures = nullptr);

  /// Blocks of a set whose elements at rest depend on a command.
  template <int K, int Q>
  struct Changed {
    std::vector<energy::ElasticBlock<K, Q>> blocks;
    double stretch = 0;  // for which they were made [-]; 0: not made yet
  };

  /// Memory of evaluations; nothing is allocated per call.
  struct Scratch : Term::Scratch {
    std::vector<double> pulls;                          // 3 per node of every element [N]
    std::vector<energy::Pack> energies;                 // per block of all sets [mJ]
    std::vector<energy::PackMask> inverted, forbidden;  // the same
    std::tuple<std::vector<Changed<4, 1>>, std::vector<Changed<10, 4>>, std::vector<Changed<6, 6>>> changed;
    Index nudged = -1;  // actuator whose stretches include a perturbation of its command, to first order
    double nudge = 0;
    std::shared_ptr<const ViscousHistory> history;               // none: relaxed at rest
    double elapsed_s = std::numeric_limits<double>::infinity();  // since then; infinity: no branch pulls
    std::vector<energy::BranchFractions> fractions;              // by block and branch of viscous sets
    std::vector<energy::Pack> rates;                             // the same: that time over their relaxation times
    std::vector<double> begun;                                   // the same: energy::begin_step() of them

    [[nodiscard]] bool pulls_viscously() const { return elapsed_s < std::numeric_limits<double>::infinity(); }
  };
  [[nodiscard]] Scratch make_scratch() const;
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override {
    return std::make_unique<Scratch>(make_scratch());
  }

  /// Has an element Maxwell branches?
  [[nodiscard]] bool viscous() const { return branches_ > 0; }
  /// Sets the history of Maxwell branches and the time since then [s] for the evaluations that follow. history: as
  /// returned by flow(), or null
  void set_time(std::shared_ptr<const ViscousHistory> history, double elapsed_s, Scratch& scratch, Team& team) const;
  /// Returns the history after a time step that ends at this shape. lost_mJ: becomes the energy dissipated in it
  [[nodiscard]] std::shared_ptr<const ViscousHistory> flow(const LoadState& load_state, const Points& positions,
                                                           Scratch& scratch, double& lost_mJ, Team& team) const;
  /// The number of values in a history.
  [[nodiscard]] std::size_t remembered() const { return strains_; }

  struct Result {
    double energy = 0;       // [mJ]
    bool inverted = false;   // is an element inverted
    bool forbidden = false;  // has an element no energy there; energy and gradient are then meaningless
  };

  /// Computes energy and gradient (#V by 3 [N]). load_state: its ratios and voltages of dea actuators count, and its
  /// load factor for the prestretch of those under voltage.
  Result force(const LoadState& load_state, const Points& positions, Scratch& scratch, Points& gradient,
               Team& team) const;
  void evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                Team& team) const override;

  /// The change is of first order; for voltages alone it is exact.
  void add_change(const LoadState& from, const LoadState& to, const Points& positions, Term::Scratch& scratch,
                  Points& force, Team& team) const override;
  void add_derivative(Index command, const LoadState& load_state, const Points& positions, Term::Scratch& scratch,
                      Points& force, Team& team) const override;

  /// The sum of the magnitudes of the elements' internal forces at a vertex, the largest of all vertices [N]. Call it
  /// after force().
  [[nodiscard]] double largest_pull(const Scratch& scratch, Team& team) const;

  /// Gradient of the energy of the electric field of a dea, #V by 3 [N], at a voltage [kV]: it is proportional to the
  /// square of the voltage.
  void field_force(Index actuator, double voltage_kV, const Points& positions, Scratch& scratch, Points& gradient,
                   Team& team) const;

  /// Cauchy stress of every element, at the quadrature point with the largest von Mises stress; in a layer under
  /// voltage it includes the Maxwell stress.
  void stress(const LoadState& load_state, const Points& positions, Scratch& scratch, ElementStress& out,
              Team& team) const;

  /// Includes the stress of families of fibres in the reported stress. They must outlive the object.
  void add_stress_of(const FibreFamilies& families) { families_ = &families; }

  /// Adds every element as a clique.
  void add_cliques(linear::Cliques& cliques) override;

  /// First slot of every tetrahedron's matrices, then of every prism's. After add_cliques().
  [[nodiscard]] std::vector<std::int64_t> element_slots() const;

  /// Second derivatives into the slots of those cliques, 9 values each [N/mm].
  void stiffness(const LoadState& load_state, const Points& positions, bool projected, Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const;
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override {
    stiffness(load_state, at.positions, projected, static_cast<Scratch&>(scratch), slots, team);
  }
  void describe(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, ElementDeformation& out,
                Team& team) const override {
    stress(load_state, at.positions, static_cast<Scratch&>(scratch), out.stress, team);
  }

  /// Voltages and growths.
  [[nodiscard]] bool loads(Index command) const override {
    return charges(command) || std::find(growths_.begin(), growths_.end(), command) != growths_.end();
  }

  /// Does the load factor change the body: is a layer under voltage prestretched?
  [[nodiscard]] bool prestretched() const;

  /// Residual of the correction that makes a linear step rotate the elements instead of shearing them
  /// (energy/turning.hpp), a force for each vertex; laplacian() is the matrix of that system.
  void turning(const Points& positions, const Points& step, Scratch& scratch, Points& residual, Team& team) const;

  /// Sum over quadrature points of volume gradient_a . gradient_b of the shape functions: one coordinate, lower
  /// triangle. Vertices of no element have a 1 on the diagonal.
  [[nodiscard]] Eigen::SparseMatrix<double> laplacian() const;

 private:
  /// Elements of one kind and law, `lanes` to a block; the last block repeats the last element, without volume.
  template <int K, int Q>
  struct Set {
    Law law = Law::neo_hookean;
    Index actuator = -1;  // dea, whose active stretch is in the slopes of its layers
    Index grower = -1;    // by which of Model::growths it grows
    std::shared_ptr<const Growth> growth;
    Index changed = -1;     // place among Scratch's; -1: no command changes its elements
    bool charged = false;   // is it under voltage
    double prestretch = 1;  // then its stretch, which no command changes
    bool mixed = false;     // tetrahedra with pressures; their law is that of split()
    Index count = 0;
    Index first_pull = 0;         // element e, node i pulls at first_pull + K e + i
    std::int64_t first_slot = 0;  // of its matrices
    std::vector<energy::ElasticBlock<K, Q>> blocks;
    std::vector<std::array<std::array<Index, energy::lanes>, K>> nodes;
    std::vector<Index> elements;                          // place of each in the model, tetrahedra first, then prisms
    std::vector<std::array<Mat3, energy::lanes>> frames;  // dea: of the layer
    std::vector<std::array<Vec3, energy::lanes>> along;   // of a growth along a direction
    std::vector<energy::Pack> permittivity;               // under voltage: as energy/dielectric.hpp takes it
    /// The pressures of tetrahedra that have some.
    struct Corners {
      std::vector<energy::CornerPressure> compliance;                          // softness and smoothing of every block
      std::vector<std::array<std::array<Index, energy::lanes>, 4>> pressures;  // vertices
      Index first_miss = 0;                                                    // as first_pull, of these
    };
    Corners corners;
    /// Moduli and relaxation times of its Maxwell branches.
    struct Viscosity {
      int branches = 0;
      std::vector<energy::Pack> moduli, times;                          // by block: [MPa], [s]
      std::size_t first_branch = 0, first_strain = 0, first_begun = 0;  // in Scratch, a history, begun
    };
    Viscosity viscous;

    /// The number of history values of a block.
    [[nodiscard]] std::size_t strains_each() const {
      return viscous.branches > 0
                 ? std::size_t{6} * Q * energy::lanes * (static_cast<std::size_t>(viscous.branches) + 1)
                 : 0;
    }
    /// The number of 3 by 3 matrices of an element.
    [[nodiscard]] int matrices() const { return mixed ? (K + 4) * (K + 5) / 2 : K * (K + 1) / 2; }
    /// The number of values of a block in Scratch::begun.
    [[nodiscard]] std::size_t begun_each() const {
      return std::size_t{energy::begun_entries} * Q * energy::lanes * static_cast<std::size_t>(viscous.branches);
    }
  };

  template <int K, int Q>
  static Set<K, Q>& set_of(std::vector<Set<K, Q>>& sets, const Model& model, const ElementRole& role, Index grower,
                           bool mixed);
  template <int K, int Q, class Element>
  void add(std::vector<Set<K, Q>>& sets, const Model& model, const ElementRole& role, Index element,
           const Element& nodes, const Pressures* pressures, Index grower);
  void add_elements(const Model& model, const Pressures* pressures);
  void add_directions(const Model& model);
  void number_sets();
  void number_pulls();
  template <int K, int Q>
  static void set_pressures(Set<K, Q>& set, const ElasticLaw& law, const std::array<Index, 4>& vertices,
                            int first_lane);
  void add_field(const Model& model, Set<6, 6>& set);
  template <int K, int Q>
  [[nodiscard]] static energy::ViscousBlock branches_of(const Set<K, Q>& set, std::size_t block,
                                                        const Scratch& scratch) {
    const std::size_t first = block * static_cast<std::size_t>(set.viscous.branches);
    const double* strains = scratch.history ? scratch.history->strains.data() + set.viscous.first_strain : nullptr;
    return {set.viscous.branches, set.viscous.moduli.data() + first,
            scratch.fractions.data() + set.viscous.first_branch + first,
            strains ? strains + set.strains_each() * block : nullptr,
            scratch.begun.data() + set.viscous.first_begun + set.begun_each() * block};
  }
  Result pull(const LoadState& load_state, const Points& positions, Scratch& scratch, Team& team) const;
  void add_pulls(const Scratch& scratch, Points& sums, Team& team) const;
  template <int K, int Q>
  void store(const Set<K, Q>& set, Index block, const energy::Shape<K>& pull, Scratch& scratch) const;
  template <int K, int Q>
  [[nodiscard]] energy::CornerPressure pressure_of(const Set<K, Q>& set, Index block, const Points& positions) const;
  template <int K, int Q>
  void store_miss(const Set<K, Q>& set, Index block, const energy::PressureMiss& miss, Scratch& scratch) const;
  template <int K, int Q>
  void store_coupling(const Set<K, Q>& set, Index block, const energy::PressureCoupling<K>& coupling,
                      LargeVector<double>& slots) const;
  [[nodiscard]] bool charges(Index command) const {
    return std::find(voltages_.begin(), voltages_.end(), command) != voltages_.end();
  }
  template <int K, int Q>
  [[nodiscard]] double stretch_of(const Set<K, Q>& set, const LoadState& load_state, const Scratch& scratch) const;
  [[nodiscard]] double fastest_growth(Index command, const LoadState& load_state) const;
  void change_elements(const LoadState& load_state, Scratch& scratch, Team& team) const;

  /// visit(set, its blocks as the commands have changed them)
  template <class Visit>
  void each(const Scratch& scratch, const Visit& visit) const {
    each_set([&]<int K, int Q>(const Set<K, Q>& set) {
      visit(set, set.changed < 0 ? set.blocks : changed_of<K, Q>(scratch)[set.changed].blocks);
    });
  }
  template <int K, int Q>
  static auto& changed_of(auto& scratch) {
    return std::get<std::vector<Changed<K, Q>>>(scratch.changed);
  }
  /// visit(set)
  template <class Visit>
  void each_set(const Visit& visit) {
    for (auto& set : linear_) visit(set);
    for (auto& set : quadratic_) visit(set);
    for (auto& set : prisms_) visit(set);
  }
  template <class Visit>
  void each_set(const Visit& visit) const {
    for (const auto& set : linear_) visit(set);
    for (const auto& set : quadratic_) visit(set);
    for (const auto& set : prisms_) visit(set);
  }

  Index vertices_;
  const FibreFamilies* families_ = nullptr;
  std::vector<Set<4, 1>> linear_;
  std::vector<Set<10, 4>> quadratic_;
  std::vector<Set<6, 6>> prisms_;
  std::vector<Index> voltages_, ratios_;  // actuators of kind dea, by what their commands are
  std::vector<Index> growths_;            // of kind growth
  std::size_t blocks_ = 0, branches_ = 0, strains_ = 0, begun_ = 0;
  Index pulls_ = 0, misses_ = 0;                 // of all sets; the second behind the first
  double pressure_unit_ = 1;                     // [MPa/mm]
  std::vector<Index> pull_starts_, pull_order_;  // pulls at each vertex
};

}  // namespace softkin::physical
