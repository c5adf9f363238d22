#pragma once

#include <filesystem>
#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/runs/reports.hpp>
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

/// throws  InvalidInput on a file that is no map, or not of this robot
[[nodiscard]] KinematicMap read_map_of(const Model& model, const std::string& file);

/// Equilibria of the solver, or of the map that was asked for; the solver's begun from the map's.
class Answers {
 public:
  /// model must outlive the object. throws InvalidInput on a file that is no map, or not of this robot
  Answers(const Model& model, const MapUse& use);
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;

  [[nodiscard]] const Statics& statics() const { return statics_; }
  /// For reports; null without a map.
  [[nodiscard]] const runs::UsedMap* map() const { return used_ ? &*used_ : nullptr; }
  /// The solver that was asked for; empty where it has nothing to do.
  [[nodiscard]] std::string solver(const SolveOptions& options) const;
  /// "scene.yaml: " and what robot it is, how it is solved, and what is known of the map's errors; with the line's end.
  [[nodiscard]] std::string head(const SolveOptions& options) const;

  /// As solve_inverse_from().
  [[nodiscard]] InverseResult inverse(const std::vector<Goal>& goals, const Actuation& start,
                                      const InverseOptions& options, const ProgressCallback& progress) const;

 private:
  const Model& model_;
  std::optional<KinematicMap> map_;
  std::optional<runs::UsedMap> used_;
  Statics statics_;
};

}  // namespace softkin::cli
