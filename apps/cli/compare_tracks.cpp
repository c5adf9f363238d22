#include <algorithm>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/track_file.hpp>

#include "compare_paths.hpp"
#include "compare_reports.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace fs = std::filesystem;

namespace {

/// "F.csv@tip" as file and marker, where no file has the whole name.
struct Source {
  std::string file, marker;

  Source(const std::string& text, const std::string& default_marker) : file(text), marker(default_marker) {
    const std::size_t at = text.rfind('@');
    std::error_code ignored;
    if (at == std::string::npos || fs::exists(text, ignored)) return;
    file = text.substr(0, at);
    marker = text.substr(at + 1);
  }
};

bool names_parameter(const std::string& by) {
  return !by.empty() && by != "waypoint" && by != "time" && by != "arc";
}

std::string marker_of(const ReportedPath& path, const std::string& asked) {
  if (!asked.empty()) return asked;
  const auto& markers = path.steps.front().markers;
  if (markers.empty()) throw InvalidInput({path.file}, "the report has no markers");
  return markers.front().first;
}

double command_of(const ReportedPath& path, const ReportedStep& step, const std::string& actuator) {
  std::vector<std::string> names;
  for (const auto& [name, value] : step.actuation) {
    if (name == actuator) return value;
    names.push_back(name);
  }
  throw InvalidInput({path.file}, "no actuator " + excerpt(actuator) + suggest_name(actuator, names));
}

/// Times, or the commands of the actuator that --by names.
std::vector<double> parameter_of(const ReportedPath& path, const std::string& by) {
  std::vector<double> values;
  for (const ReportedStep& step : path.steps) {
    if (!names_parameter(by) && !step.time) return {};
    values.push_back(names_parameter(by) ? command_of(path, step, by) : *step.time);
    if (values.size() > 1 && !(values.back() > values[values.size() - 2]))
      throw InvalidInput({path.file}, (names_parameter(by) ? "the commands of '" + by + "'" : "the times") +
                                          " do not ascend from step to step, so nothing can be compared by them");
  }
  return values;
}

Track track_of(const ReportedPath& path, const std::string& marker, const std::string& by) {
  return {path.file, places_of(path, marker_of(path, marker)), {true, true, true}, parameter_of(path, by), true};
}

/// A track of two coordinates, laid into a plane of the robot.
Track in_plane(const Track& track, const Plane& plane) {
  std::vector<Index> known;
  for (Index a = 0; a < 3; ++a)
    if (track.axes[static_cast<std::size_t>(a)]) known.push_back(a);
  if (known.size() != 2) return track;
  Track result = track;
  result.axes = {false, false, false};
  for (int c = 0; c < 2; ++c) {
    result.axes[static_cast<std::size_t>(plane.axes[c])] = true;
    for (std::size_t i = 0; i < track.points.size(); ++i)
      result.points[i][plane.axes[c]] = plane.signs[c] * track.points[i][known[static_cast<std::size_t>(c)]];
  }
  for (std::size_t i = 0; i < result.points.size(); ++i)
    for (Index a = 0; a < 3; ++a)
      if (!result.axes[static_cast<std::size_t>(a)]) result.points[i][a] = 0;
  return result;
}

bool is_report(const std::string& file) {
  return lower_extension(file) == ".json";
}

/// Sets the clocks of all tables but the first file back by the start.
void set_clocks(std::vector<Track>& tracks, double start) {
  bool any = false;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    Track& track = tracks[t];
    if (track.parameter.empty()) throw InvalidInput({track.name}, "it has no times, so --start means nothing to it");
    if (t == 0 || track.robot_frame) continue;
    for (double& time : track.parameter) time -= start;
    any = true;
  }
  if (!any) throw InvalidInput("--start is of the clock of a measured track: give one (.csv) after the first file");
}

/// A report in which one actuator moves, as a sweep of it.
class Single {
 public:
  Single(const std::string& file, const std::string& marker) : path_(read_reported_path(file)) {
    const ReportedStep& start = path_.steps.front();
    for (const auto& [name, value] : start.actuation) {
      const auto moves = [&](const ReportedStep& step) { return command_of(path_, step, name) != value; };
      if (std::none_of(path_.steps.begin(), path_.steps.end(), moves)) continue;
      if (!actuator_.empty())
        throw InvalidInput({file}, "'" + actuator_ + "' and '" + name +
                                       "' both move: a sum is of reports in which "
                                       "one actuator moves");
      actuator_ = name;
    }
    if (actuator_.empty()) throw InvalidInput({file}, "no actuator moves: a sum is of reports in which one does");
    sweep_ = {file, {}, places_of(path_, marker_of(path_, marker))};
    for (const ReportedStep& step : path_.steps) sweep_.commands.push_back(command_of(path_, step, actuator_));
  }

  [[nodiscard]] const std::string& actuator() const { return actuator_; }
  [[nodiscard]] const calibration::SingleSweep& sweep() const { return sweep_; }
  [[nodiscard]] const ReportedStep& start() const { return path_.steps.front(); }
  [[nodiscard]] const ReportedPath& path() const { return path_; }

 private:
  ReportedPath path_;
  std::string actuator_;
  calibration::SingleSweep sweep_;
};

/// Every actuator that the sum does not move stays at the start.
void check_others(const ReportedPath& path, const std::vector<Single>& singles) {
  for (const auto& [name, value] : singles.front().start().actuation) {
    for (const Single& single : singles)
      if (single.actuator() != name && command_of(single.path(), single.start(), name) != value &&
          std::none_of(singles.begin(), singles.end(), [&](const Single& s) { return s.actuator() == name; }))
        throw InvalidInput({single.path().file}, "'" + name + "' is not where it is in the other reports of the sum");
    const bool moved =
        std::any_of(singles.begin(), singles.end(), [&](const Single& s) { return s.actuator() == name; });
    for (const ReportedStep& step : path.steps)
      if (!moved && command_of(path, step, name) != value)
        throw InvalidInput({path.file}, "'" + name + "' moves, and no report of the sum has its sweep");
  }
}

Track sum_track(const PathCompareOptions& options, const ReportedPath& path) {
  std::vector<Single> singles;
  for (const std::string& file : options.sum) {
    singles.emplace_back(file, options.marker);
    for (std::size_t s = 0; s + 1 < singles.size(); ++s)
      if (singles[s].actuator() == singles.back().actuator())
        throw InvalidInput({file}, "'" + singles.back().actuator() + "' moves in " + singles[s].path().file + " too");
  }
  check_others(path, singles);
  std::vector<calibration::SingleSweep> sweeps;
  for (const Single& single : singles) sweeps.push_back(single.sweep());
  Track track{"sum of single actuators", {}, {true, true, true}, parameter_of(path, options.by), true};
  for (const ReportedStep& step : path.steps) {
    std::vector<double> commands;
    for (const Single& single : singles) commands.push_back(command_of(path, step, single.actuator()));
    track.points.push_back(calibration::superposed(sweeps, commands));
  }
  return track;
}

}  // namespace

Plane parse_plane(const std::string& text) {
  Plane plane;
  std::size_t at = 0;
  int found = 0;
  for (; found < 2 && at < text.size(); ++found) {
    plane.signs[found] = text[at] == '-' ? -1 : 1;
    if (text[at] == '-') ++at;
    const std::size_t axis = at < text.size() ? std::string("xyz").find(text[at]) : std::string::npos;
    if (axis == std::string::npos) break;
    plane.axes[found] = static_cast<Index>(axis);
    ++at;
  }
  if (found < 2 || at != text.size() || plane.axes[0] == plane.axes[1])
    throw InvalidInput("--plane " + excerpt(text) +
                       ": must name two different axes, such as xz or x-z (z turned round)");
  return plane;
}

std::vector<Track> tracks_of(const PathCompareOptions& options) {
  const std::optional<Plane> plane = options.plane.empty() ? std::nullopt : std::optional(parse_plane(options.plane));
  std::vector<Track> tracks;
  std::optional<ReportedPath> commanded;
  for (const std::string& text : options.files) {
    const Source source(text, options.marker);
    if (!is_report(source.file)) {
      tracks.push_back(
          read_track(source.file, source.marker, names_parameter(options.by) ? options.by : std::string()));
      if (plane) tracks.back() = in_plane(tracks.back(), *plane);
      continue;
    }
    const ReportedPath path = read_reported_path(source.file);
    tracks.push_back(track_of(path, source.marker, options.by));
    if (!commanded) commanded = path;
  }
  if (options.start) set_clocks(tracks, *options.start);
  if (options.sum.empty()) return tracks;
  if (!commanded)
    throw InvalidInput("--sum needs a report among the files, whose commands it adds up single predictions for");
  tracks.push_back(sum_track(options, *commanded));
  return tracks;
}

}  // namespace softkin::cli
