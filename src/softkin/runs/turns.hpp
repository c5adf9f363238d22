#pragma once

#include <optional>
#include <softkin/core/types.hpp>
#include <softkin/io/table/table.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::runs {

/// By how much a line has turned while it went from shape to shape. It may exceed 180 degrees: the axis is that of the
/// first turn, and from shape to shape the line turns by less than 180.
class TurnMeter {
 public:
  /// start: the line that turns are measured from, of some length
  explicit TurnMeter(const Vec3& start) : start_(start) {}

  /// The turn of the next line [degrees]; not finite where the line is not, and the next one is measured from the last
  /// that was.
  double next(const Vec3& line);

 private:
  Vec3 start_, axis_ = Vec3::Zero();
  double last_ = 0;
};

/// The line from one marker to another, whose turn from rest is shown.
struct MarkerLine {
  Index from = -1, to = -1;  // of Model::markers

  /// The line in a shape, from its markers [mm].
  [[nodiscard]] Vec3 in(const std::vector<Vec3>& markers) const;
  /// The line at rest [mm].
  [[nodiscard]] Vec3 at_rest(const Model& model) const;
};

/// The line that two names choose; none where there are no names.
///
/// names   none, or two markers
/// source  the option or function that named them, for messages
/// throws  InvalidInput: no such marker, or two that are at one place at rest
[[nodiscard]] std::optional<MarkerLine> read_marker_line(const Model& model, const std::vector<std::string>& names,
                                                         const std::string& source = "--turn");

/// The turns of the lines between every two markers, from shape to shape.
class LineTurns {
 public:
  /// From rest.
  explicit LineTurns(const Model& model);

  /// The turns in the next shape.
  ///
  /// markers  of the next shape [mm]
  /// returns  by number(), [degrees]; that of two markers at one place at rest means nothing
  std::vector<double> next(const std::vector<Vec3>& markers);

  /// Returns the position of a line's turn. It is the same for the reversed line.
  [[nodiscard]] static std::size_t number(const MarkerLine& line);

 private:
  std::vector<TurnMeter> meters_;
};

/// How far each marker that is a region or a body has turned from rest: the angle of the rotation in the polar
/// decomposition of the linear map that takes its vertices, weighted as in the marker's mean, best to where they are.
///
/// positions  #V by 3 [mm]
/// returns    per marker, 0 to 180 [degrees]; not finite where it is a point of the body, or its vertices are on a line
[[nodiscard]] std::vector<double> marker_turns(const Model& model, const Points& positions);

/// The same along a path, where a turn may exceed 180 degrees and changes its sign where a marker passes its
/// orientation at rest: from shape to shape a marker turns by less than 180 degrees, and its axis by less than 90.
///
/// before            turns of the shape before, of this function or of marker_turns [degrees]
/// positions_before  of that shape, #V by 3 [mm]
[[nodiscard]] std::vector<double> continued_marker_turns(const Model& model, const Points& positions,
                                                         const std::vector<double>& before,
                                                         const Points& positions_before);

/// Which markers have an orientation, by which marker_turns knows their turn.
[[nodiscard]] std::vector<bool> oriented_markers(const Model& model);

}  // namespace softkin::runs
