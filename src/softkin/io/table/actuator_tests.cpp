#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/actuator_tests.hpp>
#include <softkin/io/table/run_table.hpp>

namespace softkin {

namespace {

PressureScale scale_of(const RunTable& table, const std::string& column, std::optional<PressureScale> asked) {
  if (column == "p_kpa") {
    if (!asked)
      table.fail_header(
          "column 'p_kpa' does not say above what: name it p_abs_kpa (above vacuum) or p_gauge_kpa (above the air "
          "around), or add --pressure absolute or gauge");
    return *asked;
  }
  const PressureScale named = column == "p_abs_kpa" ? PressureScale::absolute : PressureScale::gauge;
  if (asked && *asked != named)
    table.fail_header("column '" + column + "' and --pressure " +
                      (*asked == PressureScale::absolute ? "absolute" : "gauge") + " contradict each other");
  return named;
}

}  // namespace

std::vector<SyringeRun> read_syringe_runs(const std::filesystem::path& path, std::optional<PressureScale> scale) {
  const RunTable table(path, {"p_abs_kpa", "p_gauge_kpa", "p_kpa", "dv_sy_mm3", "dv_sy_ml"},
                       {{"p_", "pressures are in kPa: p_abs_kpa or p_gauge_kpa"},
                        {"pressure", "pressures are in kPa: p_abs_kpa or p_gauge_kpa"},
                        {"dv_", "volumes are in mm^3 or mL: dv_sy_mm3 or dv_sy_ml"},
                        {"t_", "a time is in s: t_s"}});
  const std::string pressure = table.one_of({"p_abs_kpa", "p_gauge_kpa", "p_kpa"}, "the pressure");
  const std::string volume = table.one_of({"dv_sy_mm3", "dv_sy_ml"}, "the air pushed out of the syringe");
  const PressureScale given = scale_of(table, pressure, scale);
  const double factor = volume == "dv_sy_ml" ? 1000 : 1;
  std::vector<SyringeRun> runs;
  for (const RunTable::Run& each : table.runs()) {
    runs.push_back({table.file(), each.name, given, {}});
    for (const std::size_t row : each.rows)
      runs.back().rows.push_back({table.cell(row, pressure), factor * table.cell(row, volume), table.line(row)});
  }
  return runs;
}

std::vector<VoltageRun> read_voltage_runs(const std::filesystem::path& path) {
  const RunTable table(path, {"voltage_kv", "voltage_v", "area_ratio", "stretch"},
                       {{"voltage", "voltages are in kV or V: voltage_kv or voltage_v"},
                        {"area", "areas are ratios: area_ratio"},
                        {"stretch", "stretches are ratios of lengths, not strains or percents: stretch"},
                        {"t_", "a time is in s: t_s"}});
  const std::string voltage = table.one_of({"voltage_kv", "voltage_v"}, "the voltage");
  const std::string ratio = table.one_of({"area_ratio", "stretch"}, "the stretch");
  const double factor = voltage == "voltage_v" ? 0.001 : 1;
  std::vector<VoltageRun> runs;
  for (const RunTable::Run& each : table.runs()) {
    runs.push_back({table.file(), each.name, {}});
    for (const std::size_t row : each.rows) {
      const double kV = factor * table.cell(row, voltage), value = table.cell(row, ratio);
      if (kV < 0)
        table.fail(row, "column '" + voltage + "' must not be below 0: the stretch has no sign of the voltage");
      if (!(value > 0)) table.fail(row, "column '" + ratio + "' must be above 0");
      runs.back().rows.push_back({kV, ratio == "stretch" ? value * value : value, table.line(row)});
    }
  }
  return runs;
}

double read_volume(const std::string& option, const std::string& text) {
  constexpr double mm3_per_ml = 1000;
  for (const std::string unit : {"mm3", "mL", "ml", "cm3"}) {
    if (!text.ends_with(unit)) continue;
    std::string digits = text.substr(0, text.size() - unit.size());
    if (digits.ends_with(' ')) digits.pop_back();
    double value = 0;
    if (parse_real(digits, value) && value >= 0) return unit == "mm3" ? value : mm3_per_ml * value;
  }
  throw InvalidInput(option + " " + excerpt(text) + ": must be a volume with its unit, mm3, mL or cm3, such as 12.5mL");
}

}  // namespace softkin
