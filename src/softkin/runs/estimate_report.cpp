#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/estimate_json.hpp>
#include <softkin/runs/estimate_report.hpp>

namespace softkin::runs {

namespace {

/// Standard deviations along the axes.
Vec3 deviations_of(const Mat3& covariance) {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

std::string plus_minus(double value, double deviation, const std::string& unit) {
  if (!(deviation > 1e-9)) return number(value) + (unit.empty() ? "" : " " + unit);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(deviation))), 0, 9);
  return decimal(value, decimals) + " +- " + decimal(deviation, decimals) + (unit.empty() ? "" : " " + unit);
}

std::string unit_key(std::string unit) {
  std::erase_if(unit, [](char c) { return c == ' ' || c == '^'; });
  return unit.empty() ? "" : "_" + unit;
}

std::string left_out_text(const EstimateReport& report, const Estimate& reported) {
  std::string text;
  for (const std::size_t g : reported.left_out) text += (text.empty() ? "" : "; ") + report.groups[g].name;
  return text;
}

Json plan_json(const EstimateReport& report) {
  Json plan = Json::array();
  for (const PlannedReading& reading : report.plan) {
    Json json{{"name", reading.name}, {"bits", reading.bits}};
    if (reading.vertex >= 0) json["vertex"] = reading.vertex;
    if (reading.vertex >= 0 || reading.name.starts_with("marker")) json["at_rest_mm"] = json_of(reading.at_rest);
    const Estimate& reported = report.reported.front();
    for (std::size_t n = 0; n < reported.numbers.size(); ++n)
      json["deviations"][reported.numbers[n].name + unit_key(reported.numbers[n].unit)] = reading.numbers[n];
    for (std::size_t p = 0; p < reported.places.size(); ++p)
      json["place_deviations_mm"][reported.places[p].force] = reading.places[p];
    plan.push_back(std::move(json));
  }
  return plan;
}

Json row_json(const EstimateReport& report, std::size_t row) {
  const Estimate& reported = report.reported[row];
  Json json{{"line", report.poses.lines[row]}, {"status", name_of(reported.status)}, {"remark", reported.remark}};
  if (!report.poses.times.empty()) json["t_s"] = report.poses.times[row];
  json["numbers"] = reported_numbers_json(reported);
  json["places"] = reported_places_json(reported);
  json["covariance"] = matrix_json(reported.covariance);
  json["chi_square"] = reported.chi_square;
  json["freedoms"] = reported.freedoms;
  json["misfit"] = reported.misfit();
  json["left_out"] = left_out_json(reported, report.groups);
  json["readings"] = read_json(reported, report.poses.columns, report.poses.values.row(row).transpose());
  json["words"] = report.words[row];
  json["equilibria"] = reported.equilibria;
  json["seconds"] = reported.seconds;
  return json;
}

}  // namespace

bool EstimateReport::good() const {
  constexpr double doubtful = 3;
  return !interrupted && std::all_of(reported.begin(), reported.end(), [](const Estimate& e) {
    return e.status == Status::converged && e.misfit() < doubtful;
  });
}

Eigen::VectorXd RequestedEstimates::deviations_of_columns() const {
  Eigen::VectorXd all(poses.columns.size());
  for (std::size_t c = 0; c < poses.columns.size(); ++c) {
    const auto kind = static_cast<std::size_t>(poses.columns[c].kind);
    if (!(deviations[kind] > 0))
      throw InvalidInput({poses.file}, "column '" + poses.columns[c].name + "' needs the deviation of a " +
                                           reading_names[kind] + ": " + options[kind] + in_unit(poses.columns[c].kind));
    all[c] = deviations[kind];
  }
  return all;
}

void RequestedEstimates::refuse_commanded(const std::vector<Index>& reported) const {
  for (const Index a : poses.commanded)
    if (std::find(reported.begin(), reported.end(), a) != reported.end())
      throw InvalidInput({poses.file}, "a column commands '" + model.actuators[a].name +
                                           "', which is to be estimated: leave out one of them");
}

EstimateReport estimate_poses(const RequestedEstimates& requested, const EstimatorOptions& how,
                              const EstimateCallback& row, const ProgressCallback& progress) {
  const MeasuredPoses& poses = requested.poses;
  if (how.fade_s > 0 && poses.times.empty())
    throw InvalidInput({poses.file}, "estimates that fade need the times of readings, column t_s [s]");
  Estimator estimator(requested.model, requested.unknowns, poses.columns, requested.deviations_of_columns(), how);
  requested.refuse_commanded(estimator.reported_actuators());
  EstimateReport report{requested.model, poses, requested.unknowns, requested.deviations, how.fade_s};
  report.groups = estimator.groups();
  for (std::size_t r = 0; r < poses.commands.size(); ++r) {
    const double elapsed = r > 0 && !poses.times.empty() ? poses.times[r] - poses.times[r - 1] : 0;
    const Estimate& reported = estimator.update(poses.commands[r], poses.values.row(r).transpose(), elapsed, progress);
    if (reported.status == Status::interrupted) {
      report.interrupted = true;
      break;
    }
    Estimate kept = reported;
    kept.moves.clear();
    kept.state = {};
    report.reported.push_back(std::move(kept));
    report.words.push_back(estimate_words(reported, report.groups));
    if (row) row(r, reported);
  }
  return report;
}

std::string estimate_row_text(const EstimateReport& report, std::size_t row) {
  const Estimate& reported = report.reported[row];
  std::string text = "line " + std::to_string(report.poses.lines[row]);
  if (!report.poses.times.empty()) text += ", " + number(report.poses.times[row]) + " s";
  text += ":";
  if (reported.status != Status::converged)
    text += std::string(" ") + name_of(reported.status) + ": " + reported.remark;
  for (const EstimatedNumber& n : reported.numbers)
    text += " " + n.name + " " + plus_minus(n.value, n.deviation, n.unit) + ";";
  for (const EstimatedPlace& p : reported.places) {
    const Vec3 off = deviations_of(p.covariance);
    text += " " + p.force + " at rest at";
    for (Index axis = 0; axis < 3; ++axis)
      text += std::string(axis > 0 ? ", " : " ") + axis_names[axis] + " " + plus_minus(p.at_rest[axis], off[axis], "");
    text += " mm;";
  }
  text += " chi-square " + number(reported.chi_square, 3) + " for " + number(reported.freedoms, 3) + "\n";
  for (const std::string& words : report.words[row]) text += "  " + words + "\n";
  return text;
}

std::string estimate_text(const EstimateReport& report) {
  std::size_t fit = 0, left_out = 0;
  double chi_square = 0, freedoms = 0, seconds = 0;
  for (const Estimate& reported : report.reported) {
    fit += reported.status == Status::converged && reported.misfit() < 3;
    left_out += !reported.left_out.empty();
    chi_square += reported.chi_square;
    freedoms += reported.freedoms;
    seconds += reported.seconds;
  }
  std::string text = std::to_string(fit) + " of " + counted(report.reported.size(), "row") + " fit the model";
  if (left_out > 0) text += "; readings were left out of " + counted(left_out, "row");
  text += "; chi-square " + number(chi_square, 3) + " for " + number(freedoms, 3) + " freedoms of all; " +
          number(1e3 * seconds / std::max<double>(1, static_cast<double>(report.reported.size())), 3) + " ms a row\n";
  return text;
}

std::string estimate_json(const EstimateReport& report) {
  Json rows = Json::array(), unknowns = Json::array(), deviations = Json::object();
  for (std::size_t r = 0; r < report.reported.size(); ++r) rows.push_back(row_json(report, r));
  for (const EstimatedUnknown& u : report.unknowns) unknowns.push_back({{"name", u.name}, {"place", u.somewhere}});
  for (std::size_t k = 0; k < readings; ++k)
    if (report.deviations[k] > 0)
      deviations[std::string(reading_names[k]) + unit_key(reading_units[k])] = report.deviations[k];
  Json json{{"softkin_estimate", 1},    {"complete", !report.interrupted}, {"unknowns", unknowns},
            {"deviations", deviations}, {"fade_s", report.fade_s},         {"rows", rows}};
  if (report.planned) json["plan"] = plan_json(report);
  return json_text(json) + "\n";
}

Table estimate_table(const EstimateReport& report) {
  Table table;
  const auto add = [&](const std::string& key) { table.columns.push_back({.key = key}); };
  add("reading");
  add("line");
  add("t_s");
  if (!report.reported.empty()) {
    for (const EstimatedNumber& n : report.reported[0].numbers)
      for (const char* what : {"", "_deviation"}) add(n.name + what + unit_key(n.unit));
    for (const EstimatedPlace& p : report.reported[0].places)
      for (const char* what : {"_at_rest_", "_present_", "_deviation_"})
        for (const char* axis : axis_names) add(p.force + what + axis + "_mm");
  }
  for (const char* key : {"chi_square", "freedoms", "left_out", "status"}) add(key);
  for (std::size_t r = 0; r < report.reported.size(); ++r) {
    const Estimate& reported = report.reported[r];
    Row row{static_cast<std::int64_t>(r + 1), static_cast<std::int64_t>(report.poses.lines[r]),
            report.poses.times.empty() ? Cell() : Cell(report.poses.times[r])};
    for (const EstimatedNumber& n : reported.numbers) row.insert(row.end(), {Cell(n.value), Cell(n.deviation)});
    for (const EstimatedPlace& p : reported.places)
      for (const Vec3& v : {p.at_rest, p.present, deviations_of(p.covariance)})
        for (const double x : v) row.emplace_back(x);
    row.resize(table.columns.size() - 4);
    row.insert(row.end(), {Cell(reported.chi_square), Cell(reported.freedoms), Cell(left_out_text(report, reported)),
                           Cell(std::string(name_of(reported.status)))});
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace softkin::runs
