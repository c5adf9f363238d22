#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace softkin {

/// Points of a panel, joined by a line or not.
struct PlotSeries {
  std::string label;  // in the legend; empty: not there
  std::vector<double> x, y;
  bool line = true, marks = true;  // marks of a line are left out where they would crowd
  bool pairs = false;              // the line joins the first point with the second, the third with the fourth, ...
  int style = -1;                  // colour, dashes and shape of marks: >= 0, six of each; -1: the place in the panel
  bool pale = false;               // a solid grey line, for curves below the others
  double width = 1.6;              // of the line, > 0 [pixel]
  double mark_radius = 3;          // > 0 [pixel]
};

struct PlotAxis {
  std::string label;                // with its unit: "x [mm]"
  std::optional<double> low, high;  // ends of the axis; none: from the data
  bool whole = false;               // ticks at whole numbers alone
  bool logarithmic = false;         // of powers of ten: every value must be > 0
};

struct PlotPanel {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotSeries> series;
  bool equal = false;  // a unit is as long along x as along y: paths in space
};

/// Panels in rows from above, side by side within a row.
struct Plot {
  std::string title;
  std::vector<std::vector<PlotPanel>> rows;
  double width = 900;         // [pixel], 300 to 10000
  double panel_height = 220;  // of the panels' frames [pixel], 80 to 5000; equal ones may be lower
};

/// The plot as the text of an SVG file: no script, no font or file from elsewhere; series differ by dashes and marks
/// too, so that it can be read in black and white. Points that fall on one place of the picture are drawn once.
///
/// throws  InvalidInput naming panel and series: no panel, x and y of different length, a number that is not finite or
///         beyond 1e300, not > 0 on a logarithmic axis, ends of an axis that do not ascend, equal with a logarithmic
///         axis, sizes out of range
[[nodiscard]] std::string svg_text(const Plot& plot);

/// Writes svg_text to a file. Throws as it does, and where the file cannot be written.
void write_svg(const std::filesystem::path& path, const Plot& plot);

}  // namespace softkin
