#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/measurements.hpp>
#include <softkin/io/table/tensile_file.hpp>

namespace softkin {

namespace {

constexpr double greatest_strain = 15;

/// A column that a table may have: its quantity and unit, "dl" and "mm". Units of no case of their own may be written
/// as usual: force_N, stress_MPa.
struct Quantity {
  std::string name, unit, usual;  // usual: as in "MPa", where the unit is written "mpa"
  bool required = true;

  [[nodiscard]] std::string column() const { return unit.empty() ? name : name + "_" + unit; }
  [[nodiscard]] bool is(const std::string& column_name) const {
    return column_name == column() || (!usual.empty() && column_name == name + "_" + usual);
  }
};

class MeasurementTable : public CsvTable {
 public:
  MeasurementTable(const std::filesystem::path& path, const std::vector<Quantity>& quantities)
      : CsvTable(read_csv(path)), quantities_(quantities), places_(quantities.size(), -1) {
    for (std::size_t c = 0; c < columns.size(); ++c) place(columns[c], static_cast<int>(c));
    for (std::size_t q = 0; q < quantities.size(); ++q)
      if (quantities[q].required && places_[q] < 0) fail_header("column '" + quantities[q].column() + "' is missing");
  }

  [[nodiscard]] std::optional<double> value(std::size_t row, const std::string& name) const {
    const int at = places_[index(name)];
    if (at < 0) return std::nullopt;
    return rows[row][at];
  }
  [[nodiscard]] double at(std::size_t row, const std::string& name) const { return *value(row, name); }
  [[nodiscard]] double positive(std::size_t row, const std::string& name) const {
    const double value = at(row, name);
    if (!(value > 0)) fail(row, called(name) + " must be greater than 0, not " + number(value));
    return value;
  }
  [[nodiscard]] std::optional<double> positive_if_there(std::size_t row, const std::string& name) const {
    if (!value(row, name)) return std::nullopt;
    return positive(row, name);
  }
  /// Returns the size of a part within a whole: 0 < part < whole.
  [[nodiscard]] double part(std::size_t row, const std::string& name, const std::string& whole) const {
    const double value = positive(row, name), all = at(row, whole);
    if (!(value < all))
      fail(row, called(name) + " must be less than " + called(whole) + ", but " + number(value) + " is not below " +
                    number(all));
    return value;
  }
  [[nodiscard]] std::string called(const std::string& name) const {
    return "'" + quantities_[index(name)].column() + "'";
  }

 private:
  [[nodiscard]] std::size_t index(const std::string& name) const {
    const auto found =
        std::find_if(quantities_.begin(), quantities_.end(), [&](const Quantity& q) { return q.name == name; });
    return found - quantities_.begin();
  }

  void place(const std::string& column, int at) {
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      if (!quantities_[q].is(column)) continue;
      if (places_[q] >= 0) fail_header("two columns are " + called(quantities_[q].name));
      places_[q] = at;
      return;
    }
    refuse(column);
  }

  [[noreturn]] void refuse(const std::string& column) const {
    const auto complain = [&](const std::string& why) { fail_header("column " + excerpt(column) + ": " + why); };
    for (const Quantity& q : quantities_) {
      if (q.unit.empty()) continue;
      if (column == q.name) complain("its unit is missing: write '" + q.column() + "'");
      if (column.starts_with(q.name + "_"))
        complain("this is taken in " + (q.usual.empty() ? q.unit : q.usual) + ", not in " +
                 excerpt(column.substr(q.name.size() + 1)) + ": convert it to '" + q.column() + "'");
    }
    std::vector<std::string> known;
    for (const Quantity& q : quantities_) known.push_back(q.column());
    fail_header("column " + excerpt(column) + ": there is no such column" + suggest_name(column, known));
  }

  std::vector<Quantity> quantities_;
  std::vector<int> places_;
};

/// The strains of a tensile test, without unit.
struct Strains {
  const MeasurementTable& table;
  bool percent;

  [[nodiscard]] std::string name() const { return percent ? "strain_percent" : "strain"; }
  [[nodiscard]] double at(std::size_t row) const {
    const double strain = table.at(row, name()) / (percent ? 100 : 1);
    if (strain < 0) table.fail(row, table.called(name()) + " must not be below 0: a tensile test begins at rest");
    if (strain > greatest_strain)
      table.fail(row, table.called(name()) + " is " + number(100 * strain) + " %, more than 1500 %" +
                          (percent ? "" : ": is it in percent? Then name the column 'strain_percent'"));
    if (row > 0) check_order(row, strain, table.at(row - 1, name()) / (percent ? 100 : 1));
    return strain;
  }

 private:
  void check_order(std::size_t row, double strain, double before) const {
    if (strain > before) return;
    table.fail(row, table.called(name()) + " must ascend, but " + number(table.at(row, name())) + " follows " +
                        number(table.at(row - 1, name())) +
                        ": give the loading branch of one test, or choose it by the option 'branch'");
  }
};

/// A cell in softkin's unit; finite, as the cell itself.
double converted(const RunTable& table, std::size_t row, const std::string& column, double value) {
  if (!std::isfinite(value))
    table.fail(row,
               "column '" + column + "' holds " + number(table.cell(row, column)) + ", which is beyond all measure");
  return value;
}

PressureScale scale_of(const RunTable& table, const std::string& column, std::optional<PressureScale> requested) {
  if (column == "p_kpa") {
    if (!requested)
      table.fail_header(
          "column 'p_kpa' does not say above what: name it p_abs_kpa (above vacuum) or p_gauge_kpa (above the air "
          "around), or say which of the two it is (pressure: absolute or gauge)");
    return *requested;
  }
  const PressureScale named = column == "p_abs_kpa" ? PressureScale::absolute : PressureScale::gauge;
  if (requested && *requested != named)
    table.fail_header("column '" + column + "' is not of " +
                      (*requested == PressureScale::absolute ? "absolute" : "gauge") +
                      " pressures, as is said of the file");
  return named;
}

}  // namespace

std::vector<StretchedSpecimen> read_stretched_specimens(const std::filesystem::path& path) {
  const MeasurementTable table(path, {{"l", "mm", "", true},
                                      {"l1", "mm", "", true},
                                      {"dl", "mm", "", true},
                                      {"dl1", "mm", "", true},
                                      {"force", "n", "N", false},
                                      {"area", "mm2", "", false}});
  std::vector<StretchedSpecimen> specimens;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    StretchedSpecimen& s = specimens.emplace_back();
    s.length_mm = table.positive(row, "l");
    s.interface_mm = table.part(row, "l1", "l");
    s.stretch_mm = table.positive(row, "dl");
    s.interface_moved_mm = table.part(row, "dl1", "dl");
    s.force_n = table.positive_if_there(row, "force");
    s.area_mm2 = table.positive_if_there(row, "area");
    s.line = table.lines[row];
  }
  return specimens;
}

std::vector<TwistedSpecimen> read_twisted_specimens(const std::filesystem::path& path) {
  const MeasurementTable table(
      path,
      {{"l", "mm", "", true}, {"l1", "mm", "", true}, {"twist", "deg", "", true}, {"interface", "deg", "", false}});
  std::vector<TwistedSpecimen> specimens;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    TwistedSpecimen& s = specimens.emplace_back();
    s.length_mm = table.positive(row, "l");
    s.interface_mm = table.part(row, "l1", "l");
    s.twist_deg = table.positive(row, "twist");
    if (s.twist_deg > 180) table.fail(row, table.called("twist") + " must be at most 180, not " + number(s.twist_deg));
    if (table.value(row, "interface")) s.interface_deg = table.part(row, "interface", "twist");
    s.line = table.lines[row];
  }
  return specimens;
}

TensileCurve read_tensile_curve(const std::filesystem::path& path) {
  if (is_machine_file(read_file(path))) return read_tensile_file(path, {});
  const MeasurementTable table(
      path, {{"strain_percent", "", "", false}, {"strain", "", "", false}, {"stress", "mpa", "MPa", true}});
  const bool percent = table.value(0, "strain_percent").has_value();
  if (percent == table.value(0, "strain").has_value())
    table.fail_header(percent ? "two columns are the strain: leave one of 'strain' and 'strain_percent'"
                              : "a column of the strain is missing: 'strain' (without unit) or 'strain_percent'");
  const Strains strains{table, percent};
  TensileCurve curve;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    curve.strain.push_back(strains.at(row));
    curve.stress.push_back(table.at(row, "stress"));
    curve.lines.push_back(table.lines[row]);
  }
  constexpr std::size_t min_rows = 5;
  if (table.rows.size() < min_rows)
    throw InvalidInput({table.file},
                       "a tensile test needs at least five rows, not " + std::to_string(table.rows.size()));
  if (!(*std::max_element(curve.stress.begin(), curve.stress.end()) > 0))
    throw InvalidInput({table.file}, "no stress is greater than 0: tension counts positive");
  return curve;
}

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
  for (const RunTable::Run& each : table.runs) {
    runs.push_back({table.file, each.name, given, {}});
    for (const std::size_t row : each.rows)
      runs.back().rows.push_back({table.cell(row, pressure),
                                  converted(table, row, volume, factor * table.cell(row, volume)), table.lines[row]});
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
  for (const RunTable::Run& each : table.runs) {
    runs.push_back({table.file, each.name, {}});
    for (const std::size_t row : each.rows) {
      const double kV = factor * table.cell(row, voltage), value = table.cell(row, ratio);
      if (kV < 0)
        table.fail(row, "column '" + voltage + "' must not be below 0: the stretch has no sign of the voltage");
      const double areas = ratio == "stretch" ? value * value : value;
      if (!(value > 0 && areas > 0)) table.fail(row, "column '" + ratio + "' must be above 0");
      runs.back().rows.push_back({kV, converted(table, row, ratio, areas), table.lines[row]});
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
    if (!parse_real(digits, value) || value < 0) break;
    if (unit != "mm3") value *= mm3_per_ml;
    if (std::isfinite(value)) return value;
  }
  throw InvalidInput(option + " " + excerpt(text) + ": must be a volume with its unit, mm3, mL or cm3, such as 12.5mL");
}

}  // namespace softkin
