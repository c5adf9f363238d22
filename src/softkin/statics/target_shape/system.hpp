#pragma once

#include <Eigen/SparseCore>
#include <softkin/core/team.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/target_shape/element_sets.hpp>

namespace softkin::target_shape {

/// The local step of Algorithm 1 over a whole model, and the matrix of its global step.
class System {
 public:
  explicit System(const Model& model);

  /// How local ratios follow the current ones: where these change by a', the local ones change by gain a'_i less a
  /// fraction of sum_j a'_j u_j.
  struct Following {
    double gain = 1;     // proportional: a U / sum_j a_j^cur u_j; else 1
    double current = 1;  // sum_j a_j^cur u_j; proportional
    double target = 1;   // a U, for a cable of its gaps only
  };

  /// Memory of a solve besides the positions: warm rotations, pulls, energies. Nothing is allocated per iteration.
  struct Scratch {
    std::vector<std::vector<energy::PackRotation>> rotations;  // per set, per block
    std::vector<std::vector<energy::Pack>> ratios;             // local ratios per actuation set, per block
    std::vector<Following> following;                          // per set
    std::vector<energy::Pack> energies;                        // per block of all sets
    std::vector<double> pulls;                                 // 3 per slot
    Points nodes;                                              // vertices, then embedded points
    Points residual;  // #V by 3: minus half the gradient at fixed targets [mm^4]
  };
  [[nodiscard]] Scratch make_scratch() const;

  /// Local ratios, rotations and target shapes at `positions`; fills scratch.residual = sum_i w_i Vol_i (V_i^t - N
  /// V_i^d).
  ///
  /// returns  energy of Eq. (9) at these positions and targets [mm^5]
  double local_step(const Actuation& actuation, const Points& positions, Scratch& scratch, Team& team) const;

  /// How the residual changes with the positions, at the shape of the last local_step: rotations turn along, targets of
  /// R_omega < 1 and ratios that are not uniform follow.
  ///
  /// local   the scratch of that local_step
  /// change  #V by 3, of the positions
  /// out     another scratch; its residual, #V by 3, becomes the derivative of local.residual along `change`
  void residual_change(const Scratch& local, const Points& change, Scratch& out, Team& team) const;

  /// How the residual changes with the command of one actuator at fixed positions, at the shape of the last local_step:
  /// out.residual becomes the derivative of local.residual.
  void command_change(const Scratch& local, Index actuator, Scratch& out, Team& team) const;

  /// Computes where `change` would move the elements, including the rotations of the targets that it causes:
  /// out.residual is that with which the global step moves there (see turned_move_of_body).
  void turned_move(const Scratch& local, const Points& change, Scratch& out, Team& team) const;

  /// The part of residual_change that couples all elements of an actuator whose ratios follow the shape, -source
  /// (target . change): a change of one element's measure is made up for by all. Per such actuator, in the order of the
  /// sets.
  struct Redistribution {
    Points source, target;  // #V by 3
  };
  void redistributions(const Scratch& local, Scratch& work, std::vector<Redistribution>& out, Team& team) const;

  /// Is the residual minus half the gradient of the energy: no R_omega < 1, uniform ratios alone?
  [[nodiscard]] bool is_gradient() const;
  [[nodiscard]] const ElementSets& sets() const { return sets_; }
  /// Do the set's ratios follow the shape?
  [[nodiscard]] bool redistributes(Index actuator) const {
    return actuator >= 0 && model_.actuators[actuator].distribution != Distribution::uniform;
  }
  /// In proportion to the current ones?
  [[nodiscard]] bool is_proportional(Index actuator) const {
    return actuator >= 0 && model_.actuators[actuator].distribution == Distribution::proportional;
  }

  /// Matrix of Eq. (10), one coordinate, lower triangle: sum_i w_i Vol_i P_i^T N P_i [mm^3].
  [[nodiscard]] Eigen::SparseMatrix<double> global_matrix() const;

 private:
  template <int K>
  void local_ratios(const ActuationSet<K>& set, double requested, const Points& nodes,
                    std::vector<energy::Pack>& ratios, Following& following, Team& team) const;
  template <int K>
  [[nodiscard]] energy::Pack fraction_of_change(const ActuationSet<K>& set, Index block, const energy::Pack& ratio,
                                                const Following& following, double moved) const;
  template <int K>
  void ratio_changes(const ActuationSet<K>& set, const Scratch& local, std::size_t index, const Points& nodes,
                     std::vector<energy::Pack>& changes, Team& team) const;
  template <class Kernel>
  void each_change(const Scratch& local, Scratch& out, Team& team, const Kernel& kernel) const;
  void spread(const Points& positions, Points& nodes) const;
  void gather(const std::vector<double>& pulls, Points& residual, Team& team) const;

  const Model& model_;
  ElementSets sets_;
  std::vector<Index> slot_starts_, slots_;  // slots that pull at each node, vertices then points
};

}  // namespace softkin::target_shape
