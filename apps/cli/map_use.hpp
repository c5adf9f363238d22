#pragma once

#include <filesystem>
#include <softkin/runs/answers.hpp>
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

/// Of a path that has times. Throws InvalidInput where they do not go with the options.
void check_times(const Model& model, const std::string& path, const SolveOptions& options, const MapUse& use);

/// "scene.yaml: " and what robot it is, how it is solved, and what is known of a map's errors; with the line's end.
[[nodiscard]] std::string head_text(const Model& model, const SolveOptions& options, const runs::Answers& answers);

}  // namespace softkin::cli
