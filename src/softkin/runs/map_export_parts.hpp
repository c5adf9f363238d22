#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/runs/map_export.hpp>
#include <utility>

/// Declarations for all exports of a map.

namespace softkin::runs {

/// Sums of all cells behind one another. The terms of a cell are runs that differ in the last variable alone, whose
/// degree is 0, 1, ...
struct FlatSums {
  Index size = 0;                    // sums
  std::vector<Index> highest;        // degrees, #inputs per cell
  std::vector<Index> cell_runs;      // the first of each cell, and the number of all
  std::vector<Index> cell_terms;     // likewise
  std::vector<Index> runs;           // #inputs per run: degrees of all variables but the last, and the number of terms
  std::vector<double> coefficients;  // size per term

  [[nodiscard]] Index terms() const { return cell_terms.back(); }
};

/// A map as tables. The variables of every piece are all inputs, those that it does not depend on first: always of
/// degree 0, they need no code of their own.
struct FlatMap {
  std::vector<Index> pieces;                           // by the bits of what is taut; -1: none
  std::vector<Index> variables;                        // #inputs per piece: their numbers
  std::vector<Index> roots;                            // node of each piece
  std::vector<Index> node_inputs;                      // -1: a cell
  std::vector<double> node_at;                         //
  std::vector<std::pair<Index, Index>> node_children;  // below and above; cell, -1: outside
  std::vector<std::pair<double, double>> boxes;        // #inputs per cell; both 0: the piece does not depend on it
  FlatSums outputs, modes;
};

[[nodiscard]] FlatMap flat_map(const MapData& data);

/// Markers of the map: outputs 3 i, 3 i + 1 and 3 i + 2 are where the i-th is.
[[nodiscard]] std::vector<std::string> marker_names(const MapData& data);

/// The answers that an exported map has to reproduce.
struct MapAnswers {
  maps::RowMatrix commands;  // a row per answer
  maps::RowMatrix outputs;
  maps::RowMatrix slopes;  // of the outputs, along a line on which input i moves (i + 1) times its range
  Eigen::VectorXd output_scale, slope_scale;  // the largest of each output, >= 1e-6
};

/// Returns answers at random commands, each with answers all around it.
///
/// numbers  type of number that represents the commands exactly
/// throws   InvalidInput where none is found
[[nodiscard]] MapAnswers map_answers(const KinematicMap& map, CNumbers numbers);

/// "checked at 200 points, ...": what is known of the map's errors, a line each.
[[nodiscard]] std::vector<std::string> error_lines(const MapData& data);

/// A text with letters, digits and single underscores.
[[nodiscard]] std::string identifier(const std::string& text);

/// Texts, each found in another, replaced.
[[nodiscard]] std::string replaced(std::string text, const std::vector<std::pair<std::string, std::string>>& by);

}  // namespace softkin::runs
