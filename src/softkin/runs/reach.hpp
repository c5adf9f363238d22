#pragma once

#include <filesystem>
#include <optional>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/workspace_table.hpp>
#include <softkin/kinematics/hull.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// What a finished workspace shows of one marker.
struct Reach {
  std::string marker;
  std::vector<WorkspaceSample> samples;  // those with equilibria
  Points positions;                      // of the marker, #samples by 3 [mm]
  std::optional<Hull> hull{};            // where it is asked for and there are samples
};

/// The marker of that name; empty: the first. Throws InvalidInput on a robot without markers or an unknown name
[[nodiscard]] Index shown_marker(const Model& model, const std::string& name);

/// throws  as shown_marker
[[nodiscard]] Reach reach_of(const Model& model, std::vector<WorkspaceSample> samples, const std::string& marker,
                             bool with_hull);

/// The positions as points, with actuation and loads.
void write_cloud(const std::filesystem::path& path, const Model& model, const Reach& reach);
/// STL or .vtu, by its name. hull: one with triangles
void write_hull(const std::filesystem::path& path, const Hull& hull);
/// The positions, seen along the axes.
[[nodiscard]] Plot plot_of_reach(const Reach& reach);

/// JSON of what a workspace with such a head came to. counts: of samples, per status
[[nodiscard]] std::string workspace_summary(const std::string& scene, const WorkspaceHead& head, const Reach& reach,
                                            const std::vector<std::pair<std::string, Index>>& counts, double seconds);

}  // namespace softkin::runs
