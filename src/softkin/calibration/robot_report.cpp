#include <cmath>
#include <softkin/calibration/report_parts.hpp>
#include <softkin/calibration/robot_dots_report.hpp>
#include <softkin/calibration/robot_outlines_report.hpp>
#include <softkin/calibration/robot_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

constexpr double alike = 0.95;  // correlation from which two numbers are reported as inseparable
constexpr double vague = 0.5;   // deviation over the value from which a number is reported as poorly determined

/// Distance of a marker in a pose from where it was measured; NaN: it was not, or there is no equilibrium.
double marker_error(const RobotFitReport& r, Index pose, Index marker) {
  double squares = 0;
  bool any = false;
  for (Index c = 0; c < std::ssize(r.fit.named.columns); ++c) {
    const double measured = r.fit.named.values(pose, c);
    if (r.fit.named.columns[c].marker != marker || std::isnan(measured)) continue;
    squares += std::pow(r.fit.computed.values(pose, c) - measured, 2);
    any = true;
  }
  return any ? std::sqrt(squares) : std::nan("");
}

double rms_of(const std::vector<double>& errors) {
  double squares = 0;
  std::size_t count = 0;
  for (const double error : errors)
    if (std::isfinite(error)) squares += error * error, ++count;
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : std::nan("");
}

Cell known_cell(double value) {
  return std::isfinite(value) ? Cell(value) : Cell("-");
}

std::string numbers_text(const RobotFitReport& r) {
  Table table{{{.key = "number", .left = true},
               significant("fitted", "", 5),
               significant("deviation", "", 2),
               significant("start", "", 5),
               {.key = "", .left = true}}};
  int unreported = 0;
  for (std::size_t i = 0; i < r.robot.numbers().size(); ++i) {
    const FittedNumber& number = r.robot.numbers()[i];
    const Index k = i;
    unreported += r.fit.at_bound[i] == 0 && !std::isfinite(r.fit.deviations[k]);
    const double value = r.fit.values[k], deviation = r.fit.deviations[k];
    std::string remark;
    if (r.fit.at_bound[i] != 0)
      remark = r.fit.at_bound[i] < 0 ? "at its low bound" : "at its high bound";
    else if (!std::isfinite(deviation))
      remark = "the poses do not determine it";
    else if (!number.deviation && deviation > vague * std::abs(value) && !r.robot.of_frame(i))
      remark = "hardly determined";
    table.rows.push_back({number.name, value, known_cell(deviation), *number.start, remark});
  }
  std::string text = text_of(table);
  if (unreported > 1)
    text +=
        "the poses may determine the rest where one of these numbers is known: leave one out of the "
        "fit\n";
  for (Index i = 0; i < r.fit.correlations.rows(); ++i)
    for (Index j = 0; j < i; ++j)
      if (std::abs(r.fit.correlations(i, j)) > alike)
        text += "not distinguished: " + r.robot.numbers()[j].name + " and " + r.robot.numbers()[i].name +
                " (correlation " + decimal(r.fit.correlations(i, j), 3) + ")\n";
  return text;
}

std::string errors_by_pose(const RobotFitReport& r, const std::vector<Index>& markers) {
  Table table{{{.key = "pose"}, {.key = "line"}}};
  for (const Actuator& actuator : r.model.actuators)
    table.columns.push_back({.key = actuator.name, .unit = command_unit(actuator), .digits = 4});
  for (const Index m : markers) table.columns.push_back(decimals(marker_name(r, m) + " off by", "mm", 2));
  if (has_outlines(r)) {
    table.columns.push_back(decimals("outline off by", "mm", 2));
    table.columns.push_back({.key = "points"});
  }
  table.columns.push_back({.key = "", .left = true});
  for (Index pose = 0; pose < std::ssize(r.poses.commands); ++pose) {
    const std::size_t p = pose;
    Row row{static_cast<std::int64_t>(pose + 1), count_cell(r.poses.lines[p])};
    for (const double command : r.poses.commands[p]) row.emplace_back(command);
    for (const Index m : markers) row.push_back(known_cell(marker_error(r, pose, m)));
    if (has_outlines(r)) row.insert(row.end(), {known_cell(outline_error(r, p)), outline_counts(r, p)});
    const Equilibrium& found = r.fit.computed.equilibria[p];
    row.emplace_back(found.report.status != Status::converged ? std::string(name_of(found.report.status))
                     : kept(r, pose)                          ? std::string("kept aside")
                                                              : std::string());
    table.rows.push_back(std::move(row));
  }
  return text_of(table);
}

std::string errors_text(const RobotFitReport& r) {
  const std::vector<Index> markers = markers_of(r);
  if (markers.empty() && !has_outlines(r)) return "";
  std::string text = errors_by_pose(r, markers) + "\n";
  double sum = 0;
  int seen = 0;
  for (const Index m : markers) {
    std::vector<double> errors;
    for (Index pose = 0; pose < std::ssize(r.poses.commands); ++pose)
      if (!kept(r, pose)) errors.push_back(marker_error(r, pose, m));
    const double rms = rms_of(errors);
    if (std::isnan(rms)) continue;  // in poses that were kept aside alone
    sum += rms;
    ++seen;
    text += "marker " + marker_name(r, m) + ": " + decimal(rms, 2) + " mm root mean square\n";
  }
  if (seen > 1) text += "mean over the markers: " + decimal(sum / seen, 2) + " mm\n";
  return text;
}

/// What of the fit the scene takes.
std::string scene_text(const RobotFitReport& r) {
  std::string text;
  for (std::size_t i = 0; i < r.robot.numbers().size(); ++i)
    if (!r.robot.of_frame(i)) text += "  " + r.robot.numbers()[i].name + "=" + number(r.fit.values[i], 6) + "\n";
  return text.empty() ? "" : "for the scene, by path:\n" + text;
}

std::string scale_text(const char* what, double scale, double given, const char* unit) {
  if (scale == 0) return "";
  return std::string("deviation of a ") + what + " as read: " + number(scale, 3) + (*unit == 0 ? "" : " ") + unit +
         (given > 0 ? " (given)" : " (by what is left)") + "\n";
}

Json misfit_json(const Misfit& misfit) {
  return {{"rms_mm", misfit.rms}, {"largest_mm", misfit.largest}, {"readings", misfit.readings}};
}

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json numbers_json(const RobotFitReport& r) {
  Json numbers = Json::array();
  for (std::size_t i = 0; i < r.robot.numbers().size(); ++i) {
    const Index k = i;
    const bool reported = r.fit.deviations.size() > 0;
    Json correlations = Json::object();
    for (std::size_t j = 0; reported && j < r.robot.numbers().size(); ++j)
      if (j != i) correlations[r.robot.numbers()[j].name] = r.fit.correlations(k, j);
    numbers.push_back({{"name", r.robot.numbers()[i].name},
                       {"value", r.fit.values[k]},
                       {"deviation", reported ? finite(r.fit.deviations[k]) : Json()},
                       {"start", *r.robot.numbers()[i].start},
                       {"at_bound", reported ? Json(r.fit.at_bound[i]) : Json()},
                       {"correlations", correlations}});
  }
  return numbers;
}

Json poses_json(const RobotFitReport& r) {
  Json poses = Json::array();
  for (Index pose = 0; pose < std::ssize(r.poses.commands); ++pose) {
    const std::size_t p = pose;
    Json errors = Json::object(), commands = Json::object();
    for (const Index m : markers_of(r)) errors[marker_name(r, m)] = finite(marker_error(r, pose, m));
    for (std::size_t a = 0; a < r.model.actuators.size(); ++a)
      commands[r.model.actuators[a].name] = r.poses.commands[p][a];
    poses.push_back({{"line", r.poses.lines[p]},
                     {"commands", commands},
                     {"status", name_of(r.fit.computed.equilibria[p].report.status)},
                     {"kept", kept(r, pose)},
                     {"error_mm", errors}});
    if (has_dots(r)) poses.back()["dots"] = dots_json(r, p);
    if (has_outlines(r)) poses.back()["outline"] = outline_json(r, p);
  }
  return poses;
}

/// A row of a reading, without the columns of dots and outlines.
Row& add_reading(const RobotFitReport& r, Index pose, Table& table, const std::string& column, double measured,
                 double computed) {
  const bool found = std::isfinite(computed);
  return table.rows.emplace_back(Row{static_cast<std::int64_t>(pose + 1), count_cell(r.poses.lines[pose]), column,
                                     ten_digits(measured), found ? ten_digits(computed) : Cell(),
                                     found ? ten_digits(computed - measured) : Cell(), std::int64_t{kept(r, pose)}});
}

void add_columns_of(const RobotFitReport& r, Index pose, Table& table) {
  for (Index c = 0; c < std::ssize(r.poses.columns); ++c) {
    const PoseColumn& column = r.poses.columns[c];
    if (std::isnan(r.poses.values(pose, c))) continue;
    Row& row = add_reading(r, pose, table, column.name, r.poses.values(pose, c), r.fit.computed.values(pose, c));
    if (has_dots(r)) row.emplace_back(column.marker >= 0 ? Cell(marker_name(r, column.marker)) : Cell());
  }
}

void add_dots_of(const RobotFitReport& r, Index pose, Table& table) {
  for (std::size_t d = 0; d < r.poses.dots.names.size(); ++d) {
    const DotMatch& match = r.fit.dots[pose][d];
    const Vec3 seen = dot_place(r, pose, d);
    const Vec3 computed =
        match.marker < 0 ? Vec3(Vec3::Constant(std::nan(""))) : places_of(r, pose, match.marker).second;
    for (const int axis : r.poses.dots.axes) {
      if (!match.seen) continue;
      Row& row = add_reading(r, pose, table, r.poses.dots.names[d] + "_" + axis_names[axis] + "_mm", seen[axis],
                             computed[axis]);
      for (const Cell& cell : dot_cells(r, match)) row.push_back(cell);
    }
  }
}

void add_outline_of(const RobotFitReport& r, Index pose, Table& table) {
  for (const OutlineRow& outline : outline_rows(r, pose)) {
    Row& row = add_reading(r, pose, table, outline.name, outline.measured, outline.computed);
    row.resize(table.columns.size() - 2);
    for (const Cell& cell : outline_cells(*outline.reading)) row.push_back(cell);
  }
}

}  // namespace

std::string robot_fit_text(const RobotFitReport& r) {
  const RobotFit& fit = r.fit;
  std::string text = std::string(name_of(fit.status)) + (fit.remark.empty() ? "" : ": " + fit.remark) + ", " +
                     counted(static_cast<std::size_t>(fit.iterations), "iteration") + ", " + decimal(fit.seconds, 1) +
                     " s\n\n";
  if (!r.robot.numbers().empty() && fit.deviations.size() > 0) text += numbers_text(r) + "\n";
  text += errors_text(r) + dots_text(r) + outlines_text(r);
  for (std::size_t kind = 0; kind < readings; ++kind)
    text += scale_text(reading_names[kind], fit.scales[kind], r.options.deviations[kind], reading_units[kind]);
  if (fit.markers_mm.readings > 0)
    text += "all markers: " + decimal(fit.markers_mm.rms, 2) + " mm root mean square, " +
            decimal(fit.markers_mm.largest, 2) + " mm at most\n";
  if (fit.kept_mm.readings > 0)
    text += "poses kept aside: " + decimal(fit.kept_mm.rms, 2) + " mm root mean square, " +
            decimal(fit.kept_mm.largest, 2) + " mm at most\n";
  return text + (fit.deviations.size() > 0 ? "\n" + scene_text(r) : "");
}

std::string robot_fit_json(const RobotFitReport& r) {
  Json json{{"softkin_robot_fit", 1},
            {"status", name_of(r.fit.status)},
            {"remark", r.fit.remark},
            {"iterations", r.fit.iterations},
            {"seconds", r.fit.seconds},
            {"numbers", numbers_json(r)},
            {"poses", poses_json(r)},
            {"deviation_mm", r.fit.scales[0]},
            {"deviation_kPa", r.fit.scales[1]},
            {"deviation_N", r.fit.scales[2]},
            {"deviation_length_mm", r.fit.scales[3]},
            {"deviation_volume_mm3", r.fit.scales[4]},
            {"deviation_force_N", r.fit.scales[5]},
            {"markers", misfit_json(r.fit.markers_mm)},
            {"kept", misfit_json(r.fit.kept_mm)}};
  if (has_dots(r)) json["dots"] = dot_counts_json(r);
  if (has_outlines(r)) json["outlines"] = outlines_json(r);
  for (const GivenNumber& given : r.robot.given()) json["given"][given.name] = given.value;
  return text_of(json);
}

Table robot_fit_table(const RobotFitReport& r) {
  Table table = csv_table({"pose", "line", "column", "measured", "computed", "difference", "kept"});
  if (has_dots(r))
    for (const char* key : {"marker", "may_be"}) table.columns.push_back({.key = key});
  if (has_outlines(r))
    for (const char* key : {"outline_off_mm", "counts"}) table.columns.push_back({.key = key});
  for (Index pose = 0; pose < std::ssize(r.poses.commands); ++pose) {
    add_columns_of(r, pose, table);
    add_dots_of(r, pose, table);
    add_outline_of(r, pose, table);
  }
  for (Row& row : table.rows) row.resize(table.columns.size());
  return table;
}

void begin_where_fit_ended(const std::string& file, std::vector<FittedNumber>& numbers) {
  const auto refuse = [&](const std::string& why) { throw InvalidInput({file}, why); };
  Json json;
  try {
    json = Json::parse(read_file(file));
    if (json.at("softkin_robot_fit") != 1) refuse("is no report of a robot's fit of this version");
    const Json& found = json.at("numbers");
    if (found.size() != numbers.size()) refuse("is of other numbers than those requested");
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (found[i].at("name").get<std::string>() != numbers[i].name) refuse("is of other numbers than those requested");
      const double value = found[i].at("value").get<double>();
      if (!numbers[i].deviation) numbers[i].start = value;
    }
  } catch (const Json::exception&) {
    refuse("is no report of a robot's fit");
  }
}

}  // namespace softkin::calibration
