#pragma once

#include <filesystem>
#include <optional>
#include <softkin/kinematics/map.hpp>
#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

#include "solve_options.hpp"

namespace softkin::cli {

/// Whether a kinematic map answers instead of the solver. An empty file name: not given.
struct MapUse {
  std::string map;
  bool polish = false;
};

void add_map_use(CLI::App& command, MapUse& use);

/// Throws InvalidInput where the options contradict each other. inputs: the map is added
void check_map_use(const MapUse& use, const SolveOptions& options, std::vector<std::filesystem::path>& inputs);

/// Equilibria of the solver, or of the map that was asked for.
class Answers {
 public:
  /// model must outlive the object. throws InvalidInput on a file that is no map, or not of this robot
  Answers(const Model& model, const MapUse& use);
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;

  [[nodiscard]] const Statics& statics() const { return statics_; }
  /// What is known of the map's errors, a line with its end; empty without a map.
  [[nodiscard]] const std::string& remark() const { return remark_; }

 private:
  std::optional<KinematicMap> map_;
  std::string remark_;
  Statics statics_;
};

}  // namespace softkin::cli
