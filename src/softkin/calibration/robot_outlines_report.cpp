#include <cmath>
#include <softkin/calibration/robot_outlines_report.hpp>
#include <softkin/runs/records_json.hpp>

namespace softkin::calibration {

namespace {

struct OutlineCounts {
  std::size_t points = 0, counting = 0;
};

OutlineCounts counted_points(const RobotFitReport& r, std::size_t pose) {
  OutlineCounts counts;
  for (const OutlineReading& reading : r.fit.outlines.poses[pose]) {
    ++counts.points;
    counts.counting += reading.counts;
  }
  return counts;
}

OutlineCounts counted_points(const RobotFitReport& r) {
  OutlineCounts all;
  for (std::size_t pose = 0; pose < r.fit.outlines.poses.size(); ++pose) {
    const OutlineCounts counts = counted_points(r, pose);
    all.points += counts.points;
    all.counting += counts.counting;
  }
  return all;
}

std::string misfit_text(const char* what, const Misfit& misfit) {
  if (misfit.readings == 0) return "";
  return std::string(what) + ": " + decimal(misfit.rms, 2) + " mm root mean square, " + decimal(misfit.largest, 2) +
         " mm at most\n";
}

Json misfit_of_outlines(const Misfit& misfit) {
  return {{"rms_mm", misfit.rms}, {"largest_mm", misfit.largest}, {"points", misfit.readings}};
}

}  // namespace

bool has_outlines(const RobotFitReport& r) {
  return !r.fit.outlines.poses.empty();
}

double outline_error(const RobotFitReport& r, std::size_t pose) {
  double squares = 0;
  const OutlineCounts counts = counted_points(r, pose);
  for (const OutlineReading& reading : r.fit.outlines.poses[pose])
    if (reading.counts) squares += reading.off_mm * reading.off_mm;
  return counts.counting > 0 ? std::sqrt(squares / static_cast<double>(counts.counting)) : std::nan("");
}

std::string outline_counts(const RobotFitReport& r, std::size_t pose) {
  const OutlineCounts counts = counted_points(r, pose);
  return counts.points == 0 ? "-" : std::to_string(counts.counting) + " of " + std::to_string(counts.points);
}

std::string outlines_text(const RobotFitReport& r) {
  if (!has_outlines(r)) return "";
  const OutlineFit& outlines = r.fit.outlines;
  const OutlineCounts counts = counted_points(r);
  std::string text = misfit_text("outlines", outlines.fitted_mm) +
                     misfit_text("outlines of poses kept aside", outlines.kept_mm) + std::to_string(counts.counting) +
                     " of " + counted(counts.points, "point") + " of outlines count, within " +
                     number(outlines.within_mm, 4) + " mm of the robot's\n";
  if (outlines.scale_mm > 0) {
    const bool given = r.options.deviations[static_cast<std::size_t>(Reading::coordinate)] > 0;
    text += "deviation of a point of an outline as read: " + number(outlines.scale_mm, 3) + " mm " +
            (given ? "(given)" : "(by what is left)") + "\n";
  }
  return text;
}

Json outline_json(const RobotFitReport& r, std::size_t pose) {
  const OutlineCounts counts = counted_points(r, pose);
  if (counts.points == 0) return {};
  return {{"picture", r.poses.pictures[pose]},
          {"rms_mm", runs::known(outline_error(r, pose))},
          {"points", counts.points},
          {"counting", counts.counting}};
}

Json outlines_json(const RobotFitReport& r) {
  const OutlineFit& outlines = r.fit.outlines;
  const OutlineCounts counts = counted_points(r);
  return {{"file", r.poses.outlines.file},
          {"within_mm", outlines.within_mm},
          {"deviation_mm", outlines.scale_mm},
          {"points", counts.points},
          {"counting", counts.counting},
          {"fitted", misfit_of_outlines(outlines.fitted_mm)},
          {"kept", misfit_of_outlines(outlines.kept_mm)}};
}

std::vector<OutlineRow> outline_rows(const RobotFitReport& r, std::size_t pose) {
  std::vector<OutlineRow> rows;
  if (!has_outlines(r)) return rows;
  const std::vector<OutlineReading>& readings = r.fit.outlines.poses[pose];
  for (std::size_t k = 0; k < readings.size(); ++k)
    for (Index axis = 0; axis < 2; ++axis) {
      const bool found = std::isfinite(readings[k].off_mm);
      rows.push_back({"outline" + std::to_string(k + 1) + (axis == 0 ? "_x_mm" : "_y_mm"), readings[k].measured[axis],
                      found ? readings[k].nearest[axis] : std::nan(""), &readings[k]});
    }
  return rows;
}

std::array<Cell, 2> outline_cells(const OutlineReading& reading) {
  return {std::isfinite(reading.off_mm) ? ten_digits(reading.off_mm) : Cell(), std::int64_t{reading.counts}};
}

std::vector<PlotSeries> outline_series(const RobotFitReport& r) {
  PlotSeries computed, measured, ignored;
  computed.label = "computed outline";
  computed.marks = false;
  computed.pairs = true;
  measured.label = "measured outline";
  ignored.label = "does not count";
  for (PlotSeries* points : {&measured, &ignored}) {
    points->line = false;
    points->mark_radius = 1.5;
  }
  const auto add = [](PlotSeries& series, const Eigen::Vector2d& point) {
    series.x.push_back(point.x());
    series.y.push_back(point.y());
  };
  for (std::size_t pose = 0; pose < r.fit.outlines.poses.size(); ++pose) {
    if (r.fit.outlines.poses[pose].empty()) continue;
    for (const auto& line : r.fit.outlines.lines[pose])
      for (const Eigen::Vector2d& end : line) add(computed, end);
    for (const OutlineReading& reading : r.fit.outlines.poses[pose])
      add(reading.counts ? measured : ignored, reading.measured);
  }
  std::vector<PlotSeries> all{computed, measured, ignored};
  std::erase_if(all, [](const PlotSeries& series) { return series.x.empty(); });
  return all;
}

}  // namespace softkin::calibration
