#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/io/table/coupled_curves_file.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/model/names.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr Index time_target = -1;

/// The end of a column's name that holds inputs of an actuator's curve: "kPa" of air_kPa; empty: it holds none.
std::string curve_unit_of(const Actuator& actuator, const std::string& column) {
  for (const std::string& unit : curve_units(actuator))
    if (column == actuator.name + "_" + unit) return unit;
  return "";
}

}  // namespace

std::optional<Index> actuator_of_column(const Model& model, const std::string& column) {
  if (const std::optional<Index> a = find_actuator(model, column)) return a;
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (column == command_column(model.actuators[a]) || !curve_unit_of(model.actuators[a], column).empty())
      return static_cast<Index>(a);
  return std::nullopt;
}

namespace {

std::string curve_columns(const Actuator& actuator) {
  std::string text;
  for (const std::string& unit : curve_units(actuator))
    text += ", or by its curve '" + actuator.name + "_" + unit + "'";
  return text;
}

/// Where a column names an actuator with a unit that it does not take, says so; else what an unknown name says.
std::string unknown_column(const Model& model, const std::string& column) {
  const std::size_t underscore = column.rfind('_');
  const std::optional<Index> a =
      underscore == std::string::npos ? std::nullopt : find_actuator(model, column.substr(0, underscore));
  if (!a) return unknown_actuator(model, column) + "; a time is column t_s [s]";
  const Actuator& actuator = model.actuators[*a];
  return "actuator '" + actuator.name + "' takes a " + command_name(actuator) +
         (command_unit(actuator).empty()
              ? " without unit: its column is '" + actuator.name + "'" + curve_columns(actuator)
              : ": its column is '" + actuator.name + "' or '" + command_column(actuator) + "'");
}

std::vector<Index> column_targets(const Model& model, const CsvTable& table, const Settings& settings) {
  const std::string& file = table.file;
  std::vector<Index> targets;
  for (const std::string& column : table.columns) {
    const std::optional<Index> a = actuator_of_column(model, column);
    if (!a && column != time_column)
      throw InvalidInput({file}, "column " + excerpt(column) + ": " + unknown_column(model, column));
    if (a && settings[*a])
      throw InvalidInput({file}, "column " + excerpt(column) + ": '" + model.actuators[*a].name +
                                     "' is set for the whole path, too; leave out one of them");
    if (a && std::find(targets.begin(), targets.end(), *a) != targets.end())
      throw InvalidInput({file}, "column " + excerpt(column) + ": another column is of the same actuator");
    targets.push_back(a.value_or(time_target));
  }
  if (std::all_of(targets.begin(), targets.end(), [](Index target) { return target == time_target; }))
    throw InvalidInput({file}, "no column names an actuator, so there is nothing to follow");
  return targets;
}

class PathReader {
 public:
  PathReader(const Model& model, const CsvTable& table, const Settings& settings)
      : model_(model),
        table_(table),
        targets_(column_targets(model, table, settings)),
        start_{with_settings(model.rest_actuation(), settings), std::nullopt, 0} {}

  [[nodiscard]] std::vector<ActuationStep> steps() const {
    std::vector<ActuationStep> steps;
    for (std::size_t row = 0; row < table_.rows.size(); ++row) {
      steps.push_back(step(row));
      if (row > 0 && steps[row].time && *steps[row].time <= *steps[row - 1].time)
        table_.fail(row, std::string(time_column) + " must increase from row to row, but " +
                             number(*steps[row].time, 12) + " s follows " + number(*steps[row - 1].time, 12) + " s");
    }
    return steps;
  }

 private:
  /// What a cell asks of its actuator; a pressure or voltage becomes the ratio of the actuator's curve.
  [[nodiscard]] double command(std::size_t row, std::size_t column, const Actuator& actuator) const {
    const double given = table_.rows[row][column];
    const std::string unit =
        table_.columns[column] == actuator.name ? "" : curve_unit_of(actuator, table_.columns[column]);
    if (unit.empty()) return given;
    try {
      return ratio_of(actuator, {unit == "kPa_abs" ? given - actuator.curve->atmosphere_kPa : given, actuator.branch});
    } catch (const InvalidInput& error) {
      table_.fail(row, "column '" + table_.columns[column] + "': " + error.what());
    }
  }

  [[nodiscard]] ActuationStep step(std::size_t row) const {
    ActuationStep step = start_;
    step.line = table_.lines[row];
    for (std::size_t column = 0; column < targets_.size(); ++column) {
      if (targets_[column] == time_target) {
        step.time = table_.rows[row][column];
        continue;
      }
      const Actuator& actuator = model_.actuators[targets_[column]];
      const double value = command(row, column, actuator);
      if (!(value >= actuator.low && value <= actuator.high))
        table_.fail(row, "column '" + table_.columns[column] + "': " + number(value, 12) + " is outside " +
                             range_text(actuator));
      step.actuation[targets_[column]] = value;
    }
    return step;
  }

  const Model& model_;
  const CsvTable& table_;
  std::vector<Index> targets_;
  ActuationStep start_;
};

constexpr const char* pressure_end = "_pressure_kPa";

bool is_commanded_by_volume(const Actuator& actuator) {
  return actuator.is<ChamberDrive>() && actuator.control == Control::ratio;
}

class CommandReader {
 public:
  CommandReader(const Model& model, const std::string& file) : model_(model), table_(read_csv(file)) {
    commands_.file = file;
    commands_.commanded.assign(model.actuators.size(), false);
    commands_.pressure_known.assign(model.actuators.size(), false);
  }

  Commands read(const std::string& report) {
    take_pressures();
    take_curve_pressures();
    for (const std::string& column : table_.columns)
      if (const auto a = actuator_of_column(model_, column)) commands_.commanded[*a] = true;
    const std::vector<ActuationStep> steps = PathReader(model_, table_, Settings(model_.actuators.size())).steps();
    for (std::size_t row = 0; row < steps.size(); ++row) {
      const Eigen::VectorXd pressures =
          pressures_.empty() ? Eigen::VectorXd::Zero(model_.actuators.size()) : pressures_[row];
      commands_.rows.push_back({steps[row].actuation, pressures, steps[row].time, steps[row].line});
    }
    if (std::filesystem::path(report).extension() == ".csv")
      take_coupled(report);
    else if (!report.empty())
      take_report(report);
    return std::move(commands_);
  }

 private:
  /// Moves the columns of pressures out of the table.
  void take_pressures() {
    pressures_.assign(table_.rows.size(), Eigen::VectorXd::Zero(model_.actuators.size()));
    for (std::size_t column = 0; column < table_.columns.size();) {
      const auto a = chamber_of(table_.columns[column]);
      if (!a) {
        ++column;
        continue;
      }
      commands_.pressure_known[*a] = true;
      for (std::size_t row = 0; row < table_.rows.size(); ++row) {
        std::vector<double>& cells = table_.rows[row];
        pressures_[row][*a] = cells[column];
        cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(column));
      }
      table_.columns.erase(table_.columns.begin() + static_cast<std::ptrdiff_t>(column));
    }
  }

  /// What is commanded by a curve of pressure is what a pump is to be sent.
  void take_curve_pressures() {
    for (std::size_t column = 0; column < table_.columns.size(); ++column)
      for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
        const Actuator& actuator = model_.actuators[a];
        const std::string unit = curve_unit_of(actuator, table_.columns[column]);
        if (unit.empty() || !is_commanded_by_volume(actuator)) continue;
        if (commands_.pressure_known[a])
          throw InvalidInput({table_.file}, "columns '" + actuator.name + pressure_end + "' and '" +
                                                table_.columns[column] +
                                                "' both say its pressure; leave out one of them");
        commands_.pressure_known[a] = true;
        const double gauge_zero = unit == "kPa_abs" ? actuator.curve->atmosphere_kPa : 0;
        for (std::size_t row = 0; row < table_.rows.size(); ++row)
          pressures_[row][a] = table_.rows[row][column] - gauge_zero;
      }
  }

  [[nodiscard]] std::optional<std::size_t> chamber_of(const std::string& column) const {
    for (std::size_t a = 0; a < model_.actuators.size(); ++a)
      if (is_commanded_by_volume(model_.actuators[a]) && column == model_.actuators[a].name + pressure_end) return a;
    return std::nullopt;
  }

  /// Pressures of a measured table, of which each chamber's ratio is a function of all.
  void take_coupled(const std::string& file) {
    const std::vector<std::size_t> chambers = chambers_without_pressures(model_, commands_, file);
    const CoupledCurves curves = read_coupled_curves(model_, file);
    if (curves.chambers != chambers)
      throw InvalidInput({file}, "it is of chambers " + names_of(curves.chambers) + ", but " + commands_.file +
                                     " commands " + names_of(chambers) + " by volume");
    for (CommandRow& row : commands_.rows) {
      Eigen::VectorXd requested(chambers.size());
      for (std::size_t k = 0; k < chambers.size(); ++k) requested[k] = row.actuation[chambers[k]];
      const std::vector<Eigen::VectorXd> found = curves.pressures_for(requested);
      if (found.size() != 1)
        throw InvalidInput({commands_.file, row.line}, (found.empty() ? "no pressures" : "several pressures") +
                                                           std::string(" within ") + file + " lead to its ratios");
      for (std::size_t k = 0; k < chambers.size(); ++k) row.pressures_kpa[chambers[k]] = found.front()[k];
    }
    for (const std::size_t a : chambers) commands_.pressure_known[a] = true;
  }

  [[nodiscard]] std::string names_of(const std::vector<std::size_t>& chambers) const {
    std::string text;
    for (const std::size_t a : chambers) text += (text.empty() ? "'" : ", '") + model_.actuators[a].name + "'";
    return text;
  }

  void take_report(const std::string& file) {
    const std::vector<std::size_t> chambers = chambers_without_pressures(model_, commands_, file);
    try {
      const Json steps = parse_json(read_file(file)).at("steps");
      if (steps.size() != commands_.rows.size())
        throw InvalidInput({file}, "it has " + counted(steps.size(), "step") + ", but " + commands_.file + " has " +
                                       counted(commands_.rows.size(), "row") + "; it is of another run");
      for (std::size_t row = 0; row < steps.size(); ++row) take_step(file, steps[row], row, chambers);
    } catch (const Json::exception&) {
      throw InvalidInput({file},
                         "this is no report of softkin, or it has no pressures: those come from the physical "
                         "formulation, or from measured curves");
    }
  }

  void take_step(const std::string& file, const Json& step, std::size_t index,
                 const std::vector<std::size_t>& chambers) {
    CommandRow& row = commands_.rows[index];
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      const double requested = step.at("actuation").at(model_.actuators[a].name).get<double>();
      const double here = row.actuation[a];
      if (std::abs(requested - here) > 1e-9 * std::max(1.0, std::abs(here)))
        throw InvalidInput({file}, "its step " + std::to_string(index) + " is of " + model_.actuators[a].name + " = " +
                                       number(requested, 12) + ", but " + commands_.file + ":" +
                                       std::to_string(row.line) + " commands " + number(here, 12));
    }
    if (step.at("status").get<std::string>() != "converged")
      throw InvalidInput({file}, "its step " + std::to_string(index) + " has not converged: it has no pressures");
    for (const std::size_t a : chambers) {
      row.pressures_kpa[a] =
          pressure_of(file, index, step.at("actuators").at(model_.actuators[a].name), model_.actuators[a]);
      commands_.pressure_known[a] = true;
    }
  }

  /// The gauge pressure that a report has of a chamber: that of its measured curve, where there is one, before the
  /// model's.
  [[nodiscard]] static double pressure_of(const std::string& file, std::size_t index, const Json& reported,
                                          const Actuator& actuator) {
    if (!actuator.curve || !reported.contains(curve_key(*actuator.curve)))
      return reported.at("pressure_kPa").get<double>();
    const Json& by_curve = reported.at(curve_key(*actuator.curve));
    if (by_curve.is_null())
      throw InvalidInput({file}, "its step " + std::to_string(index) + " has no pressure of '" + actuator.name +
                                     "': its curve does not reach so far");
    return by_curve.get<double>();
  }

  const Model& model_;
  CsvTable table_;
  Commands commands_;
  std::vector<Eigen::VectorXd> pressures_;  // per row
};

}  // namespace

std::vector<ActuationStep> read_actuation_path(const Model& model, const std::string& file, const Settings& settings) {
  return actuation_steps(model, read_csv(file), settings);
}

std::vector<ActuationStep> actuation_steps(const Model& model, const CsvTable& table, const Settings& settings) {
  return PathReader(model, table, settings).steps();
}

Commands read_commands(const Model& model, const std::string& file, const std::string& report) {
  return CommandReader(model, file).read(report);
}

std::vector<std::size_t> chambers_without_pressures(const Model& model, const Commands& commands,
                                                    const std::string& file) {
  std::vector<std::size_t> chambers;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    if (!is_commanded_by_volume(model.actuators[a]) || !commands.commanded[a]) continue;
    if (commands.pressure_known[a])
      throw InvalidInput({file}, "its pressures are of no use: " + commands.file + " has the column '" +
                                     model.actuators[a].name + pressure_end + "' already" +
                                     (model.actuators[a].curve ? curve_columns(model.actuators[a]) : ""));
    chambers.push_back(a);
  }
  if (chambers.empty())
    throw InvalidInput({file}, "its pressures are of no use: " + commands.file + " commands no chamber by its volume");
  return chambers;
}

}  // namespace softkin
