#pragma once

#include <Eigen/SparseCore>
#include <softkin/core/team.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/element_sets.hpp>

namespace softkin {

/// The local step of Algorithm 1 over a whole model, and the matrix of its global step.
class TargetShapeSystem {
 public:
  explicit TargetShapeSystem(const Model& model);

  /// What a solve needs beside the positions: warm rotations, pulls, energies. Nothing is allocated per iteration.
  struct Scratch {
    std::vector<std::vector<PackRotation>> rotations;  // per set, per block
    std::vector<std::vector<Pack>> ratios;             // local ratios per actuation set, per block
    std::vector<Pack> energies;                        // per block of all sets
    std::vector<double> pulls;                         // 3 per slot
    Points nodes;                                      // vertices, then embedded points
    Points residual;                                   // #V by 3: minus half the gradient at fixed targets [mm^4]
  };
  [[nodiscard]] Scratch make_scratch() const;

  /// Local ratios, rotations and target shapes at `positions`; fills scratch.residual = sum_i w_i Vol_i (V_i^t - N
  /// V_i^d).
  ///
  /// returns  energy of Eq. (9) at these positions and targets [mm^5]
  double local_step(const Actuation& actuation, const Points& positions, Scratch& scratch, Team& team) const;

  /// Matrix of Eq. (10), one coordinate, lower triangle: sum_i w_i Vol_i P_i^T N P_i [mm^3].
  [[nodiscard]] Eigen::SparseMatrix<double> global_matrix() const;

 private:
  template <int K>
  void local_ratios(const ActuationSet<K>& set, double requested, const Points& nodes, std::vector<Pack>& ratios,
                    Team& team) const;
  void gather(Scratch& scratch, Team& team) const;

  const Model& model_;
  ElementSets sets_;
  std::vector<Index> slot_starts_, slots_;  // slots that pull at each node, vertices then points
};

}  // namespace softkin
