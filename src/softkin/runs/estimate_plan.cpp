#include <algorithm>
#include <set>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/body_surface.hpp>
#include <softkin/runs/estimate_plan.hpp>

namespace softkin::runs {

std::vector<Index> marker_vertices(const Model& model) {
  std::set<Index> inside, outside;
  for (const Actuator& actuator : model.actuators)
    if (const auto* chamber = actuator.as<ChamberDrive>())
      for (const CavityFace& face : chamber->cavity)
        for (const Index v : nodes_of(face)) inside.insert(v);
  for (const Triangle& triangle : body_surface(model).triangles) {
    if (std::all_of(triangle.begin(), triangle.end(), [&](Index v) { return inside.contains(v); })) continue;
    outside.insert(triangle.begin(), triangle.end());
  }
  return {outside.begin(), outside.end()};
}

EstimatePlanner::EstimatePlanner(const Model& model, const MeasuredPoses& poses,
                                 const std::array<double, readings>& deviations, int count)
    : model_(model), options_{marker_vertices(model), deviations, poses.columns, count} {}

void EstimatePlanner::add(const Estimate& reported) {
  if (reported.status == Status::converged) rows_.emplace_back(reported);
}

std::vector<PlannedReading> EstimatePlanner::plan() const {
  return rows_.empty() ? std::vector<PlannedReading>{} : plan_readings(model_, rows_, options_);
}

std::string plan_text(const EstimateReport& report) {
  if (!report.planned) return "";
  if (report.plan.empty()) return "plan: no further reading would add information\n";
  const Estimate& reported = report.reported.front();
  std::string text =
      "the most informative readings, one after the other, and the deviations then (root mean square of the rows):\n";
  for (const PlannedReading& reading : report.plan) {
    text += "  " + reading.name;
    if (reading.vertex >= 0 || reading.name.starts_with("marker")) {
      text += " at rest at";
      for (Index axis = 0; axis < 3; ++axis)
        text += std::string(axis > 0 ? ", " : " ") + axis_names[axis] + " " + number(reading.at_rest[axis], 4);
      text += " mm";
    }
    text += ": " + number(reading.bits, 3) + " bits;";
    for (std::size_t n = 0; n < reported.numbers.size(); ++n)
      text += " " + reported.numbers[n].name + " +- " + number(reading.numbers[n], 2) +
              (reported.numbers[n].unit.empty() ? "" : " ") + reported.numbers[n].unit + ";";
    for (std::size_t p = 0; p < reported.places.size(); ++p)
      text += " place of " + reported.places[p].force + " +- " + number(reading.places[p], 2) + " mm;";
    text.back() = '\n';
  }
  return text;
}

}  // namespace softkin::runs
