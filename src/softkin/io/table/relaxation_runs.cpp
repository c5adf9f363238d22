#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/relaxation_runs.hpp>

namespace softkin {

namespace {

constexpr double greatest_stretch = 16;

double needed(const RunTable& table, const std::string& column, const std::optional<double>& size, const char* what) {
  if (!size) table.fail_header("column '" + column + "' needs " + what + ": give it too");
  return *size;
}

/// Stretches and stresses, whatever columns have them.
class StripColumns {
 public:
  StripColumns(const RunTable& table, const StripSize& size)
      : table_(table),
        strain_(table.one_of({"strain", "strain_percent", "stretch", "length_mm"}, "the stretch")),
        stress_(table.one_of({"stress_mpa", "stress_kpa", "force_n"}, "the stress")) {
    if (!table.find("t_s")) table.fail_header("column 't_s' is missing: the time in s");
    if (strain_ == "length_mm") over_ = needed(table, strain_, size.length_mm, "the specimen's length at rest [mm]");
    if (strain_ == "strain_percent") over_ = 100;
    if (stress_ == "stress_kpa") stress_over_ = 1000;
    if (stress_ == "force_n")
      stress_over_ = needed(table, stress_, size.area_mm2, "the area of the specimen's cross-section at rest [mm^2]");
  }

  [[nodiscard]] double stretch(std::size_t row) const {
    const double cell = table_.cell(row, strain_);
    const double value = (strain_.starts_with("strain") ? 1 : 0) + cell / over_;
    if (!(value > 0)) table_.fail(row, "column '" + strain_ + "': the stretch must be above 0, not " + number(value));
    if (value > greatest_stretch)
      table_.fail(row, "column '" + strain_ + "': a stretch of " + number(value) + " is more than " +
                           number(greatest_stretch) +
                           (strain_ == "strain" ? ": is it in percent? Then name the column 'strain_percent'" : ""));
    return value;
  }

  [[nodiscard]] double stress(std::size_t row) const {
    const double value = table_.cell(row, stress_) / stress_over_;
    if (!std::isfinite(value) || std::abs(value) > max_stress)
      table_.fail(
          row, "column '" + stress_ + "' holds " + number(table_.cell(row, stress_)) + ", which is beyond all measure");
    return value;
  }

 private:
  static constexpr double max_stress = 1e9;  // [MPa]

  const RunTable& table_;
  std::string strain_, stress_;
  double over_ = 1, stress_over_ = 1;
};

}  // namespace

std::vector<RelaxationRun> read_relaxation_runs(const std::filesystem::path& path, bool load_imposed,
                                                const StripSize& size) {
  const RunTable table(path,
                       {"strain", "strain_percent", "stretch", "length_mm", "stress_mpa", "stress_kpa", "force_n"},
                       {{"strain", "a strain has no unit, or is in percent: strain or strain_percent"},
                        {"stretch", "a stretch is a ratio of lengths, not a strain or percent: stretch"},
                        {"length", "a length is in mm: length_mm"},
                        {"stress", "stresses are in MPa or kPa: stress_mpa or stress_kpa"},
                        {"force", "a force is in N: force_n"},
                        {"t_", "a time is in s: t_s"},
                        {"time", "a time is in s: t_s"}});
  const StripColumns columns(table, size);
  std::vector<RelaxationRun> runs;
  for (const RunTable::Run& each : table.runs) {
    RelaxationRun& run = runs.emplace_back();
    run.file = table.file;
    run.name = each.name;
    run.load_imposed = load_imposed;
    for (const std::size_t row : each.rows) {
      run.time_s.push_back(table.cell(row, "t_s"));
      run.stretch.push_back(columns.stretch(row));
      run.stress_MPa.push_back(columns.stress(row));
      run.lines.push_back(table.lines[row]);
    }
    if (each.rows.size() < 2) table.fail(each.rows.front(), each.name + " has one row: a test over time needs more");
  }
  return runs;
}

}  // namespace softkin
