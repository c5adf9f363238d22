#pragma once

#include <softkin/statics/physical/system.hpp>

namespace softkin::testing {

/// The equations of a robot with the memory to solve them; a shape and its load state.
struct PhysicalEquations {
  explicit PhysicalEquations(Model robot) : model(std::move(robot)), system(model), work(system), team(1) {}

  Model model;
  physical::System system;
  physical::Workspace work;
  Team team;
  physical::LoadState load_state;
  physical::Iterate at;
  std::vector<bool> active;
  physical::Balance balance;  // of the last evaluation
};

}  // namespace softkin::testing
