#include <algorithm>
#include <cmath>
#include <filesystem>
#include <softkin/calibration/path_comparison.hpp>
#include <softkin/calibration/path_tracks.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/marker_path.hpp>
#include <softkin/runs/report_comparison.hpp>

namespace softkin::calibration {

namespace {

using runs::commands_of;
using runs::ReportedPath;
using runs::ReportedStep;

/// "F.csv@tip" as file and marker, where no file has the whole name.
struct TrackSource {
  std::string file, marker, chosen;  // chosen: the marker, where the text names one

  TrackSource(const std::string& text, const std::string& default_marker) : file(text), marker(default_marker) {
    const std::size_t at = text.rfind('@');
    std::error_code ignored;
    if (at == std::string::npos || std::filesystem::exists(text, ignored)) return;
    file = text.substr(0, at);
    marker = chosen = text.substr(at + 1);
  }
};

/// Times, or the commands of the actuator that is compared by.
std::vector<double> parameter_of(const ReportedPath& path, const PathRequest& request) {
  std::vector<double> values;
  if (request.by_name())
    values = commands_of(path, request.by);
  else
    for (const ReportedStep& step : path.steps) values.push_back(step.time.value_or(NAN));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) return {};
    if (i > 0 && !(values[i] > values[i - 1]))
      throw InvalidInput({path.file}, (request.by_name() ? "the commands of '" + request.by + "'" : "the times") +
                                          " do not ascend from step to step, so nothing can be compared by them");
  }
  return values;
}

Track track_of(const ReportedPath& path, const std::string& marker, const PathRequest& request) {
  return {path.file,
          runs::places_of(path, runs::marker_of(path, marker)),
          {true, true, true},
          parameter_of(path, request),
          true};
}

/// A track of two coordinates, laid into a plane of the robot.
Track in_plane(const Track& track, const TrackPlane& plane) {
  std::vector<Index> known;
  for (Index a = 0; a < 3; ++a)
    if (track.axes[a]) known.push_back(a);
  if (known.size() != 2) return track;
  Track result = track;
  result.axes = {false, false, false};
  for (int c = 0; c < 2; ++c) result.axes[plane.axes[c]] = true;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    result.points[i].setZero();
    for (int c = 0; c < 2; ++c) result.points[i][plane.axes[c]] = plane.signs[c] * track.points[i][known[c]];
  }
  return result;
}

/// Sets the clocks of all tables but the first file back by the start.
void set_clocks(std::vector<Track>& tracks, double start) {
  bool any = false;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    Track& track = tracks[t];
    if (track.parameter.empty()) throw InvalidInput({track.name}, "it has no times, so a start means nothing to it");
    if (t == 0 || track.robot_frame) continue;
    for (double& time : track.parameter) time -= start;
    any = true;
  }
  if (!any) throw InvalidInput("the start is of the clock of a measured track: give one (.csv) after the first file");
}

/// A report in which one actuator moves, as a sweep of it.
struct ReportedSweep {
  ReportedPath path;
  std::string actuator;
  SingleSweep sweep;
};

ReportedSweep read_sweep(const std::string& file, const std::string& marker) {
  ReportedSweep result{runs::read_reported_path(file), "", {}};
  for (const auto& [name, value] : result.path.steps.front().actuation) {
    const std::vector<double> commands = commands_of(result.path, name);
    if (std::count(commands.begin(), commands.end(), value) == std::ssize(commands)) continue;
    if (!result.actuator.empty())
      throw InvalidInput({file}, "'" + result.actuator + "' and '" + name +
                                     "' both move: a sum is of reports in which one actuator moves");
    result.actuator = name;
  }
  if (result.actuator.empty()) throw InvalidInput({file}, "no actuator moves: a sum is of reports in which one does");
  result.sweep = {file, commands_of(result.path, result.actuator),
                  runs::places_of(result.path, runs::marker_of(result.path, marker))};
  return result;
}

/// Every actuator that the sum does not move stays at the start.
void check_others(const ReportedPath& path, const std::vector<ReportedSweep>& sweeps) {
  for (const auto& [name, value] : sweeps.front().path.steps.front().actuation) {
    const auto moves = [&name = name](const ReportedSweep& sweep) { return sweep.actuator == name; };
    const bool moved = std::any_of(sweeps.begin(), sweeps.end(), moves);
    for (const ReportedSweep& sweep : sweeps)
      if (!moves(sweep) && commands_of(sweep.path, name).front() != value && !moved)
        throw InvalidInput({sweep.path.file}, "'" + name + "' is not where it is in the other reports of the sum");
    if (moved) continue;
    for (const double command : commands_of(path, name))
      if (command != value)
        throw InvalidInput({path.file}, "'" + name + "' moves, and no report of the sum has its sweep");
  }
}

Track sum_track(const PathRequest& request, const ReportedPath& path) {
  std::vector<ReportedSweep> reports;
  for (const std::string& file : request.sum) {
    reports.push_back(read_sweep(file, request.marker));
    for (std::size_t s = 0; s + 1 < reports.size(); ++s)
      if (reports[s].actuator == reports.back().actuator)
        throw InvalidInput({file}, "'" + reports.back().actuator + "' moves in " + reports[s].path.file + " too");
  }
  check_others(path, reports);
  Track track{"sum of single actuators", {}, {true, true, true}, parameter_of(path, request), true};
  std::vector<SingleSweep> sweeps;
  std::vector<std::vector<double>> commands;
  for (const ReportedSweep& report : reports) {
    sweeps.push_back(report.sweep);
    commands.push_back(commands_of(path, report.actuator));
  }
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    std::vector<double> at;
    for (const std::vector<double>& each : commands) at.push_back(each[i]);
    track.points.push_back(superposed(sweeps, at));
  }
  return track;
}

}  // namespace

TrackPlane parse_plane(const std::string& text) {
  TrackPlane plane;
  std::size_t at = 0;
  int found = 0;
  for (; found < 2 && at < text.size(); ++found) {
    plane.signs[found] = text[at] == '-' ? -1 : 1;
    if (text[at] == '-') ++at;
    const std::size_t axis = at < text.size() ? std::string("xyz").find(text[at]) : std::string::npos;
    if (axis == std::string::npos) break;
    plane.axes[found] = axis;
    ++at;
  }
  if (found < 2 || at != text.size() || plane.axes[0] == plane.axes[1])
    throw InvalidInput("the plane " + excerpt(text) +
                       ": must name two different axes, such as xz or x-z (z turned round)");
  return plane;
}

std::vector<Track> read_tracks(const PathRequest& request) {
  std::vector<Track> tracks;
  std::optional<ReportedPath> commanded;
  for (const std::string& text : request.files) {
    const TrackSource source(text, request.marker);
    if (lower_extension(source.file) != ".json") {
      tracks.push_back(read_track(source.file, source.marker, request.by_name() ? request.by : std::string()));
      if (request.plane) tracks.back() = in_plane(tracks.back(), *request.plane);
      tracks.back().marker = source.chosen;
      continue;
    }
    const ReportedPath path = runs::read_reported_path(source.file);
    tracks.push_back(track_of(path, source.marker, request));
    tracks.back().marker = source.chosen;
    if (!commanded) commanded = path;
  }
  if (request.start) set_clocks(tracks, *request.start);
  if (request.sum.empty()) return tracks;
  if (!commanded)
    throw InvalidInput("a sum needs a report among the files, whose commands it adds up single predictions for");
  tracks.push_back(sum_track(request, *commanded));
  return tracks;
}

}  // namespace softkin::calibration
