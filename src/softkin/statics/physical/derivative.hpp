#pragma once

#include <softkin/statics/physical/bordered.hpp>
#include <softkin/statics/sensitivity.hpp>

namespace softkin::physical {

/// Derivatives of an equilibrium by the commands: K X + G L = F, G^T X = T, a column per actuator, with the stiffness K
/// and the slopes G of the measures that are held, both at the shape. F: how loads and layers change with the command;
/// T: the measures'.
class Derivative {
 public:
  /// All must outlive the object. work.home: the shape near which the workspace factorised, or empty
  Derivative(const System& system, System::Workspace& work, double accuracy, Team& team);

  /// at  multipliers in internal units
  [[nodiscard]] Sensitivity of(const Iterate& at, const Demand& demand);

 private:
  void hold(const Iterate& at, const Demand& demand);
  void ask(const Iterate& at, const Demand& demand);
  bool solve(const Iterate& at, bool exact_factor);
  [[nodiscard]] Sensitivity result(const Iterate& at) const;

  const System& system_;
  System::Workspace& work_;
  double accuracy_;
  Team& team_;
  System::Balance balance_;  // at the shape
  std::vector<bool> active_;
  std::vector<Index> held_;
  Columns right_, found_;
  std::vector<Points> moves_;  // per actuator: of what its command moves itself; no rows: nothing
};

}  // namespace softkin::physical
