#include <algorithm>
#include <map>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/coupled_curves_file.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

constexpr std::size_t max_chambers = 6;  // a cell has 2^n corners
constexpr double max_nodes = 1e6;
const std::string end_of_pressure = "_pressure_kPa";

struct ChamberColumns {
  std::size_t chamber = 0, pressure = 0, ratio = 0;
};

std::vector<ChamberColumns> chamber_columns(const Model& model, const CsvTable& table) {
  std::vector<ChamberColumns> found;
  std::vector<bool> used(table.columns.size(), false);
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    if (!actuator.is<ChamberDrive>() || actuator.control != Control::ratio) continue;
    const auto pressure = table.find(actuator.name + end_of_pressure), ratio = table.find(actuator.name);
    if (!pressure && !ratio) continue;
    if (!pressure || !ratio)
      table.fail_header("chamber '" + actuator.name + "' needs both columns, '" + actuator.name +
                        "' (its ratio) and '" + actuator.name + end_of_pressure + "'");
    used[*pressure] = used[*ratio] = true;
    found.push_back({a, *pressure, *ratio});
  }
  for (std::size_t c = 0; c < used.size(); ++c)
    if (!used[c])
      table.fail_header("column " + excerpt(table.columns[c]) +
                        " is of no chamber that is commanded by its volume: a table of coupled chambers has columns "
                        "such as air1 and air1" +
                        end_of_pressure);
  if (found.size() < 2 || found.size() > max_chambers)
    table.fail_header("a table of coupled chambers has 2 to " + std::to_string(max_chambers) + " of them, not " +
                      std::to_string(found.size()) + "; a chamber alone has a curve (docs/pressure.md)");
  return found;
}

std::vector<double> axis_of(const CsvTable& table, std::size_t column) {
  std::vector<double> values;
  for (const std::vector<double>& row : table.rows) values.push_back(row[column]);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() < 2) table.fail_header("column '" + table.columns[column] + "' needs two pressures at least");
  return values;
}

std::string missing_text(const CsvTable& table, const std::vector<ChamberColumns>& columns, const CoupledCurves& curves,
                         std::size_t node) {
  std::string text;
  for (std::size_t k = columns.size(); k-- > 0;) {
    const std::vector<double>& axis = curves.pressures_kPa[k];
    text = table.columns[columns[k].pressure] + " = " + number(axis[node % axis.size()], 9) +
           (text.empty() ? "" : ", ") + text;
    node /= axis.size();
  }
  return text;
}

/// Nodes of the grid; not in integers, for axes of a table without a grid multiply beyond them.
double nodes_of(const CsvTable& table, const CoupledCurves& curves) {
  double nodes = 1;
  for (const std::vector<double>& axis : curves.pressures_kPa) nodes *= static_cast<double>(axis.size());
  if (nodes > max_nodes)
    table.fail_header("its pressures are of no grid: a row for every combination would be " + number(nodes, 3) +
                      " rows");
  return nodes;
}

/// The row of every node.
std::map<std::size_t, std::size_t> rows_of_nodes(const CsvTable& table, const std::vector<ChamberColumns>& columns,
                                                 const CoupledCurves& curves) {
  const double nodes = nodes_of(table, curves);
  std::map<std::size_t, std::size_t> row_of;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const std::vector<double>& axis = curves.pressures_kPa[k];
      const auto at = std::lower_bound(axis.begin(), axis.end(), table.rows[row][columns[k].pressure]);
      places.push_back(at - axis.begin());
    }
    const auto [other, is_new] = row_of.emplace(curves.node(places), row);
    if (!is_new)
      table.fail(row, "these pressures stand in line " + std::to_string(table.lines[other->second]) + " already");
  }
  std::size_t node = 0;
  while (row_of.count(node) != 0) ++node;
  if (static_cast<double>(node) < nodes)
    table.fail_header("it needs a row for every combination of its pressures, " + number(nodes, 9) + ", and has " +
                      std::to_string(table.rows.size()) + "; there is none with " +
                      missing_text(table, columns, curves, node));
  return row_of;
}

/// Checks that a chamber grows along its own pressure; else ratios cannot be converted back to pressures.
void check_rise(const CsvTable& table, const std::vector<ChamberColumns>& columns, const CoupledCurves& curves,
                const std::vector<std::size_t>& rows) {
  std::size_t stride = 1;
  for (std::size_t k = columns.size(); k-- > 0;) {
    const std::size_t count = curves.pressures_kPa[k].size();
    for (std::size_t node = 0; node < rows.size(); ++node) {
      const double ratio = curves.ratios[node][k];
      if (!(ratio > 0)) table.fail(rows[node], "'" + table.columns[columns[k].ratio] + "' must be greater than 0");
      if (node / stride % count == 0) continue;
      const double before = curves.ratios[node - stride][k];
      if (!(ratio > before))
        table.fail(rows[node], "'" + table.columns[columns[k].ratio] +
                                   "' must rise with its own pressure, the others being equal, but is " +
                                   number(ratio, 9) + " after " + number(before, 9) + " in line " +
                                   std::to_string(table.lines[rows[node - stride]]));
    }
    stride *= count;
  }
}

}  // namespace

CoupledCurves read_coupled_curves(const Model& model, const std::filesystem::path& path) {
  const CsvTable table = read_csv(path);
  const std::vector<ChamberColumns> columns = chamber_columns(model, table);
  CoupledCurves curves;
  curves.file = table.file;
  for (const ChamberColumns& each : columns) {
    curves.chambers.push_back(each.chamber);
    curves.pressures_kPa.push_back(axis_of(table, each.pressure));
  }
  std::vector<std::size_t> rows;
  for (const auto& [node, row] : rows_of_nodes(table, columns, curves)) {
    rows.push_back(row);
    curves.ratios.emplace_back(static_cast<Index>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k) curves.ratios.back()[k] = table.rows[row][columns[k].ratio];
  }
  check_rise(table, columns, curves, rows);
  return curves;
}

}  // namespace softkin
