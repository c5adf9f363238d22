#pragma once

#include <map>
#include <softkin/model/measured_poses.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "live_messages.hpp"

namespace softkin::view {

// The lines of a stream of readings to estimate from: JSON, an object a line; independent of the network.

/// A line is no longer than this [bytes], without its end.
inline constexpr std::size_t longest_line = 65536;

/// The columns of a table of readings, as the keys of a line.
struct LineColumns {
  /// model     must outlive the object
  /// readings  its columns that may be read
  /// reported  commands that are estimated, which no line has
  /// timed     must every line have t_s?
  LineColumns(const Model& model, std::vector<PoseColumn> readings, std::vector<Index> reported, bool timed);

  const Model& model;
  std::vector<PoseColumn> readings;
  std::vector<Index> reported;
  bool timed;
  std::map<std::string, Index, std::less<>> by_name{};  // of the readings
};

/// The first line: {"token": "..."}.
///
/// throws  Refusal, and nothing else, on whatever is not that
[[nodiscard]] std::string read_token_line(std::string_view text);

/// A line of readings: numbers by the columns of a table; those of readings that are not there, or null, were not read.
/// Commands that are not there rest.
///
/// after   t_s must be larger [s]; none: any is
/// throws  Refusal, and nothing else: no JSON object, an unknown key, which it names, what is no finite number, a
///         command outside its range, a reading larger than largest_reading, no reading at all
[[nodiscard]] ReadingsRequest read_reading_line(std::string_view text, const LineColumns& columns,
                                                std::optional<double> after);

/// {"error": "..."}
[[nodiscard]] std::string error_line(const std::string& why);

}  // namespace softkin::view
