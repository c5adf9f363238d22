#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/table/actuation_path.hpp>
#include <softkin/io/table/commands.hpp>
#include <softkin/io/table/csv.hpp>

namespace softkin {

namespace {

using Json = nlohmann::json;

constexpr const char* pressure_end = "_pressure_kPa";

bool is_commanded_by_volume(const Actuator& actuator) {
  return actuator.kind == ActuatorKind::pneumatic && actuator.control == Control::ratio;
}

class Reader {
 public:
  Reader(const Model& model, const std::string& file) : model_(model), table_(read_csv(file)) {
    commands_.file = file;
    commands_.commanded.assign(model.actuators.size(), false);
    commands_.pressure_known.assign(model.actuators.size(), false);
  }

  Commands read(const std::string& report) {
    take_pressures();
    for (const std::string& column : table_.columns)
      if (const auto a = actuator_of_column(model_, column)) commands_.commanded[static_cast<std::size_t>(*a)] = true;
    const std::vector<ActuationStep> steps =
        actuation_path(model_, commands_.file, table_, Settings(model_.actuators.size()));
    for (std::size_t row = 0; row < steps.size(); ++row) {
      const Eigen::VectorXd pressures =
          pressures_.empty() ? Eigen::VectorXd::Zero(static_cast<Index>(model_.actuators.size())) : pressures_[row];
      commands_.rows.push_back({steps[row].actuation, pressures, steps[row].time, steps[row].line});
    }
    if (!report.empty()) take_report(report);
    return std::move(commands_);
  }

 private:
  /// Moves the columns of pressures out of the table.
  void take_pressures() {
    pressures_.assign(table_.rows.size(), Eigen::VectorXd::Zero(static_cast<Index>(model_.actuators.size())));
    for (std::size_t column = 0; column < table_.columns.size();) {
      const auto a = chamber_of(table_.columns[column]);
      if (!a) {
        ++column;
        continue;
      }
      commands_.pressure_known[*a] = true;
      for (std::size_t row = 0; row < table_.rows.size(); ++row) {
        std::vector<double>& cells = table_.rows[row];
        pressures_[row][static_cast<Index>(*a)] = cells[column];
        cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(column));
      }
      table_.columns.erase(table_.columns.begin() + static_cast<std::ptrdiff_t>(column));
    }
  }

  [[nodiscard]] std::optional<std::size_t> chamber_of(const std::string& column) const {
    for (std::size_t a = 0; a < model_.actuators.size(); ++a)
      if (is_commanded_by_volume(model_.actuators[a]) && column == model_.actuators[a].name + pressure_end) return a;
    return std::nullopt;
  }

  void take_report(const std::string& file) {
    std::vector<std::size_t> chambers;
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      if (!is_commanded_by_volume(model_.actuators[a]) || !commands_.commanded[a]) continue;
      if (commands_.pressure_known[a])
        throw InvalidInput("--pressures " + file + ": " + commands_.file + " has the column '" +
                           model_.actuators[a].name + pressure_end + "' already");
      chambers.push_back(a);
    }
    if (chambers.empty())
      throw InvalidInput("--pressures " + file + ": " + commands_.file + " commands no chamber by its volume");
    try {
      const Json steps = Json::parse(read_file(file)).at("steps");
      if (steps.size() != commands_.rows.size())
        throw InvalidInput({file}, "it has " + counted(steps.size(), "step") + ", but " + commands_.file + " has " +
                                       counted(commands_.rows.size(), "row") + "; it is of another run");
      for (std::size_t row = 0; row < steps.size(); ++row) take_step(file, steps[row], row, chambers);
    } catch (const Json::exception&) {
      throw InvalidInput({file},
                         "this is no report of softkin, or it has no pressures: those come from the physical "
                         "formulation");
    }
  }

  void take_step(const std::string& file, const Json& step, std::size_t index,
                 const std::vector<std::size_t>& chambers) {
    CommandRow& row = commands_.rows[index];
    for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
      const double asked = step.at("actuation").at(model_.actuators[a].name).get<double>();
      const double here = row.actuation[static_cast<Index>(a)];
      if (std::abs(asked - here) > 1e-9 * std::max(1.0, std::abs(here)))
        throw InvalidInput({file}, "its step " + std::to_string(index) + " is of " + model_.actuators[a].name + " = " +
                                       number(asked, 12) + ", but " + commands_.file + ":" + std::to_string(row.line) +
                                       " commands " + number(here, 12));
    }
    if (step.at("status").get<std::string>() != "converged")
      throw InvalidInput({file}, "its step " + std::to_string(index) + " has not converged: it has no pressures");
    for (const std::size_t a : chambers) {
      row.pressures_kpa[static_cast<Index>(a)] =
          step.at("actuators").at(model_.actuators[a].name).at("pressure_kPa").get<double>();
      commands_.pressure_known[a] = true;
    }
  }

  const Model& model_;
  CsvTable table_;
  Commands commands_;
  std::vector<Eigen::VectorXd> pressures_;  // per row
};

}  // namespace

Commands read_commands(const Model& model, const std::string& file, const std::string& report) {
  return Reader(model, file).read(report);
}

}  // namespace softkin
