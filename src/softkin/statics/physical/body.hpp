#pragma once

#include <Eigen/SparseCore>
#include <softkin/core/team.hpp>
#include <softkin/energy/elastic.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/deformation.hpp>

namespace softkin::physical {

/// The body of a robot in the physical formulation: elastic energy and its derivatives in the vertices.
class Body {
 public:
  explicit Body(const Model& model);

  /// What evaluation needs beside the positions; nothing is allocated per call.
  struct Scratch {
    std::vector<double> pulls;                                    // 3 per node of every element [N]
    std::vector<energy::Pack> energies;                           // per block of all sets [mJ]
    std::vector<energy::PackMask> inverted;                       // the same
    std::vector<std::vector<energy::ElasticBlock<6, 6>>> layers;  // per dea set: at the ratio below
    std::vector<double> layer_ratios;                             // [-]; 0: not made yet
  };
  [[nodiscard]] Scratch make_scratch() const;

  struct Result {
    double energy = 0;       // [mJ]
    bool inverted = false;   // is an element
    bool forbidden = false;  // is one whose law forbids it; energy and gradient are then meaningless
  };

  /// Energy and gradient (#V by 3 [N]). actuation: of which the ratios of dea actuators are taken.
  Result force(const Eigen::VectorXd& actuation, const Points& positions, Scratch& scratch, Points& gradient,
               Team& team) const;

  /// Sum of the magnitudes of what the elements at a vertex pull there, the largest of all vertices [N]. After force().
  [[nodiscard]] double largest_pull(const Scratch& scratch, Team& team) const;

  /// Cauchy stress of every element, at that of its quadrature points where von Mises' is largest.
  void stress(const Eigen::VectorXd& actuation, const Points& positions, Scratch& scratch, ElementStress& out,
              Team& team) const;

  /// Adds every element as a clique.
  void add_cliques(linear::Cliques& cliques);

  /// First slot of every tetrahedron's matrices, then of every prism's. After add_cliques().
  [[nodiscard]] std::vector<std::int64_t> element_slots() const;

  /// Second derivatives into the slots of those cliques, 9 values each [N/mm].
  void stiffness(const Eigen::VectorXd& actuation, const Points& positions, bool projected, Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const;

  /// What the linear step lacks to turn the elements instead of shearing them (energy/turning.hpp), a pull for each
  /// vertex: residual of a system with the matrix below.
  void turning(const Points& positions, const Points& step, Scratch& scratch, Points& residual, Team& team) const;

  /// Sum over quadrature points of volume slope_a . slope_b: one coordinate, lower triangle. Vertices of no element
  /// have a 1 on the diagonal.
  [[nodiscard]] Eigen::SparseMatrix<double> laplacian() const;

 private:
  /// Elements of one kind and law, `lanes` to a block; the last block repeats the last element, without volume.
  template <int K, int Q>
  struct Set {
    Law law = Law::neo_hookean;
    Index actuator = -1;  // dea
    Index count = 0;
    Index first_pull = 0;         // element e, node i pulls at first_pull + K e + i
    std::int64_t first_slot = 0;  // of its matrices
    std::vector<energy::ElasticBlock<K, Q>> blocks;
    std::vector<std::array<std::array<Index, energy::lanes>, K>> nodes;
    std::vector<Index> elements;                          // place of each in the model, tetrahedra first, then prisms
    std::vector<std::array<Mat3, energy::lanes>> frames;  // dea: of the layer
  };

  template <int K, int Q, class Element>
  static void add(std::vector<Set<K, Q>>& sets, const Model& model, Law law, const ElasticLaw& constants,
                  Index actuator, Index element, const Element& nodes);
  void gather(const Scratch& scratch, Points& sums, Team& team) const;
  template <int K, int Q>
  void store(const Set<K, Q>& set, Index block, const energy::Shape<K>& pull, Scratch& scratch) const;
  void stretch_layers(const Eigen::VectorXd& actuation, Scratch& scratch) const;

  /// visit(set, its blocks at the current active stretch)
  template <class Visit>
  void each(const Scratch& scratch, const Visit& visit) const {
    for (const auto& set : linear_) visit(set, set.blocks);
    for (const auto& set : quadratic_) visit(set, set.blocks);
    std::size_t layer = 0;
    for (const auto& set : prisms_) {
      if (set.actuator >= 0)
        visit(set, scratch.layers[layer++]);
      else
        visit(set, set.blocks);
    }
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
  std::vector<Set<4, 1>> linear_;
  std::vector<Set<10, 4>> quadratic_;
  std::vector<Set<6, 6>> prisms_;
  std::size_t blocks_ = 0;
  Index pulls_ = 0;
  std::vector<Index> pull_starts_, pull_order_;  // pulls at each vertex
};

}  // namespace softkin::physical
