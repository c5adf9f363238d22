#include "compare_table.hpp"

#include <algorithm>
#include <softkin/core/error.hpp>

#include "terminal.hpp"

namespace softkin::cli {

namespace {

std::string first_marker(const ReportedPath& path) {
  const auto& markers = path.steps.front().markers;
  if (markers.empty()) throw InvalidInput({path.file}, "the report has no markers, so no distance is known");
  return markers.front().first;
}

std::vector<double> distances_of(const ReportedPath& path, const ReportedPath& from, const std::string& marker) {
  const std::vector<Vec3> here = places_of(path, marker), there = places_of(from, marker);
  std::vector<double> distances;
  for (std::size_t i = 0; i < here.size(); ++i) distances.push_back((here[i] - there[i]).norm());
  return distances;
}

/// "converged" where all did, else who did not: "2: limit".
std::string status_of(const std::vector<ReportedPath>& paths, std::size_t step) {
  std::string text;
  for (std::size_t p = 0; p < paths.size(); ++p)
    if (const std::string& status = paths[p].steps[step].status; status != "converged")
      text += (text.empty() ? "" : ", ") + std::to_string(p + 1) + ": " + status;
  return text.empty() ? "converged" : text;
}

std::vector<std::string> lines_of(const std::vector<std::vector<std::string>>& rows) {
  return aligned(rows, std::string(rows.front().size(), 'r'));
}

}  // namespace

Comparison::Comparison(std::vector<ReportedPath> paths, std::string marker, const std::vector<std::string>& turn,
                       std::vector<double> poses)
    : paths_(std::move(paths)), marker_(std::move(marker)), poses_(std::move(poses)) {
  if (marker_.empty()) marker_ = first_marker(paths_.front());
  for (const ReportedPath& path : paths_) {
    distances_.push_back(distances_of(path, paths_.front(), marker_));
    if (!turn.empty()) turns_.push_back(turns_of(path, turn[0], turn[1]));
  }
}

std::optional<double> Comparison::time_to(std::size_t path, double pose) const {
  for (std::size_t i = 0; i < turns_[path].size(); ++i)
    if (turns_[path][i] >= pose && paths_[path].steps[i].status == "converged") return paths_[path].steps[i].elapsed;
  return std::nullopt;
}

std::vector<std::string> Comparison::header() const {
  std::vector<std::string> cells{"step"};
  for (const auto& [name, value] : paths_.front().steps.front().actuation) cells.push_back(name);
  for (std::size_t p = 0; p < paths_.size(); ++p) {
    const std::string of = std::to_string(p + 1) + ": ";
    if (!turns_.empty()) cells.push_back(of + "turn [deg]");
    for (const auto& [name, load] : paths_[p].steps.front().loads) cells.push_back(of + name);
    if (p > 0) cells.push_back(of + marker_ + " off by [mm]");
  }
  cells.emplace_back("status");
  return cells;
}

std::vector<std::string> Comparison::row(std::size_t step) const {
  std::vector<std::string> cells{std::to_string(step)};
  for (const auto& [name, value] : paths_.front().steps[step].actuation) cells.push_back(number(value));
  for (std::size_t p = 0; p < paths_.size(); ++p) {
    if (!turns_.empty()) cells.push_back(decimal(turns_[p][step], 1));
    for (const auto& [name, load] : paths_[p].steps[step].loads) cells.push_back(decimal(load, 2));
    if (p > 0) cells.push_back(decimal(distances_[p][step], 2));
  }
  cells.push_back(status_of(paths_, step));
  return cells;
}

std::vector<std::vector<std::string>> Comparison::times() const {
  std::vector<std::string> head{"", "time to a turn of:"};
  if (poses_.empty()) head.back() = "time of:";
  for (const double pose : poses_) head.push_back(number(pose) + " deg");
  head.emplace_back("all steps");
  std::vector<std::vector<std::string>> rows{head};
  for (std::size_t p = 0; p < paths_.size(); ++p) {
    rows.push_back({std::to_string(p + 1), paths_[p].method});
    for (const double pose : poses_) {
      const std::optional<double> time = time_to(p, pose);
      rows.back().push_back(time ? decimal(*time, 2) + " s" : "not reached");
    }
    rows.back().push_back(decimal(paths_[p].steps.back().elapsed, 2) + " s");
  }
  return rows;
}

std::string Comparison::text() const {
  std::string text;
  for (std::size_t p = 0; p < paths_.size(); ++p)
    text += std::to_string(p + 1) + ": " + paths_[p].method + " (" + paths_[p].file + ")\n";
  std::vector<std::vector<std::string>> rows{header()};
  for (std::size_t i = 0; i < paths_.front().steps.size(); ++i) rows.push_back(row(i));
  text += joined(lines_of(rows), "") + "\n";
  return text + joined(lines_of(times()), "");
}

Json Comparison::json() const {
  Json reports = Json::array();
  for (std::size_t p = 0; p < paths_.size(); ++p) {
    Json report{{"file", paths_[p].file}, {"method", paths_[p].method}, {"seconds", paths_[p].steps.back().elapsed}};
    if (!turns_.empty()) report["turn_deg"] = turns_[p];
    report["distance_mm"] = distances_[p];
    Json elapsed = Json::array(), poses = Json::array();
    for (const ReportedStep& step : paths_[p].steps) elapsed.push_back(step.elapsed);
    for (const double pose : poses_) {
      const std::optional<double> time = time_to(p, pose);
      poses.push_back({{"turn_deg", pose}, {"seconds", time ? Json(*time) : Json()}});
    }
    report["elapsed_s"] = elapsed;
    report["poses"] = poses;
    reports.push_back(report);
  }
  return {{"marker", marker_}, {"reports", reports}};
}

}  // namespace softkin::cli
