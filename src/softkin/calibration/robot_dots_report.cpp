#include <cmath>
#include <softkin/calibration/robot_dots_report.hpp>

namespace softkin::calibration {

namespace {

struct DotCounts {
  std::size_t seen = 0, matched = 0, doubtful = 0;
};

DotCounts counted_dots(const RobotFitReport& r) {
  DotCounts counts;
  for (const auto& pose : r.fit.dots)
    for (const DotMatch& match : pose) {
      counts.seen += match.seen;
      counts.matched += match.marker >= 0;
      counts.doubtful += match.rival.has_value();
    }
  return counts;
}

std::string in_pose(const RobotFitReport& r, std::size_t pose) {
  return "pose " + std::to_string(pose + 1) + " (line " + std::to_string(r.poses.lines[pose]) + "): ";
}

/// What a dot is not without doubt; empty: it is a marker.
std::string doubt_text(const RobotFitReport& r, const std::string& dot, const DotMatch& match) {
  if (!match.seen || match.nearest < 0) return "";
  const std::string nearest = marker_name(r, match.nearest);
  if (match.marker < 0)
    return dot + " is no marker; " + nearest + " is nearest, " + decimal(match.distance_mm, 2) + " mm off";
  if (!match.rival) return "";
  return dot + " is taken for " + nearest + " but may as well be " +
         (*match.rival < 0 ? "no marker" : marker_name(r, *match.rival));
}

}  // namespace

std::string dots_text(const RobotFitReport& r) {
  if (!has_dots(r)) return "";
  constexpr std::size_t most = 20;
  std::string lines;
  std::size_t doubts = 0;
  for (std::size_t pose = 0; pose < r.fit.dots.size(); ++pose)
    for (std::size_t d = 0; d < r.poses.dots.names.size(); ++d) {
      const std::string doubt = doubt_text(r, r.poses.dots.names[d], r.fit.dots[pose][d]);
      if (!doubt.empty() && ++doubts <= most) lines += "  " + in_pose(r, pose) + doubt + "\n";
    }
  if (doubts > most) lines += "  and " + std::to_string(doubts - most) + " more\n";
  const DotCounts counts = counted_dots(r);
  return std::to_string(counts.matched) + " of " + counted(counts.seen, "dot") + " matched to markers within " +
         number(r.options.match_within_mm) + " mm\n" + lines;
}

Json dots_json(const RobotFitReport& r, std::size_t pose) {
  const auto name = [&](Index marker) { return marker < 0 ? Json() : Json(marker_name(r, marker)); };
  Json dots = Json::object();
  for (std::size_t d = 0; d < r.poses.dots.names.size(); ++d) {
    const DotMatch& match = r.fit.dots[pose][d];
    if (!match.seen) continue;
    dots[r.poses.dots.names[d]] = {{"marker", name(match.marker)},
                                   {"nearest", name(match.nearest)},
                                   {"distance_mm", std::isfinite(match.distance_mm) ? Json(match.distance_mm) : Json()},
                                   {"doubtful", match.rival.has_value()},
                                   {"rival", match.rival ? name(*match.rival) : Json()}};
  }
  return dots;
}

Json dot_counts_json(const RobotFitReport& r) {
  const DotCounts counts = counted_dots(r);
  return {{"within_mm", r.options.match_within_mm},
          {"seen", counts.seen},
          {"matched", counts.matched},
          {"doubtful", counts.doubtful}};
}

std::array<Cell, 2> dot_cells(const RobotFitReport& r, const DotMatch& match) {
  const auto name = [&](Index marker) { return Cell(marker < 0 ? "none" : marker_name(r, marker)); };
  return {name(match.marker), match.rival ? name(*match.rival) : Cell()};
}

}  // namespace softkin::calibration
