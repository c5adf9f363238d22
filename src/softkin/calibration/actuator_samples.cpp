#include <algorithm>
#include <cmath>
#include <softkin/calibration/actuator_samples.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>

namespace softkin::calibration {

namespace {

constexpr double noise_fraction = 0.1;             // of the drive's range
constexpr double rest_fraction = 0.02;             // of the drive's greatest value
constexpr double min_ratio = 0.2, max_ratio = 20;  // of a chamber that anybody builds
constexpr double rounding = 1e-9;

/// Where the drive turns, with its first row and its last extreme.
std::vector<std::size_t> turns_of(const std::vector<double>& drive, double noise) {
  std::vector<std::size_t> turns{0};
  std::size_t extreme = 0;
  int direction = 0;  // not known yet
  for (std::size_t i = 1; i < drive.size(); ++i) {
    const double from_extreme = drive[i] - drive[extreme];
    if (direction == 0) {
      if (from_extreme > noise || from_extreme < -noise) {
        direction = from_extreme > 0 ? 1 : -1;
        extreme = i;
      }
    } else if (direction * from_extreme >= 0) {
      extreme = i;
    } else if (-direction * from_extreme > noise) {
      turns.push_back(extreme);
      direction = -direction;
      extreme = i;
    }
  }
  turns.push_back(extreme);
  return turns;
}

template <class Run, class Row>
std::vector<Sweep> sweeps_of(const Run& run, double Row::*drive, const char* constant) {
  std::vector<double> values;
  for (const Row& row : run.rows) values.push_back(row.*drive);
  std::vector<Sweep> sweeps = calibration::sweeps_of(values);
  if (sweeps.empty()) throw InvalidInput({run.file}, run.name + ": " + constant);
  return sweeps;
}

const char* scale_name(PressureScale scale) {
  return scale == PressureScale::absolute ? "absolute" : "gauge";
}

PressureScale other(PressureScale scale) {
  return scale == PressureScale::absolute ? PressureScale::gauge : PressureScale::absolute;
}

double absolute(const SyringeSetup& setup, PressureScale scale, double pressure) {
  return scale == PressureScale::absolute ? pressure : pressure + setup.atmosphere_kPa;
}

/// How a run may have been written down instead.
struct Reinterpretation {
  PressureScale scale;
  double volume_factor = 1;
};

/// All ratios plausible, and those of the lowest and highest pressure in order.
bool makes_sense(const SyringeSetup& setup, const SyringeRun& run, const Reinterpretation& reading) {
  const auto ratio = [&](const SyringeRow& row) {
    return chamber_ratio(setup, absolute(setup, reading.scale, row.pressure_kPa),
                         reading.volume_factor * row.syringe_mm3);
  };
  for (const SyringeRow& row : run.rows)
    if (absolute(setup, reading.scale, row.pressure_kPa) <= 0 ||
        reading.volume_factor * row.syringe_mm3 > setup.syringe_mm3 || !(ratio(row) > min_ratio) ||
        !(ratio(row) < max_ratio))
      return false;
  const auto [low, high] =
      std::minmax_element(run.rows.begin(), run.rows.end(),
                          [](const SyringeRow& a, const SyringeRow& b) { return a.pressure_kPa < b.pressure_kPa; });
  return low->pressure_kPa == high->pressure_kPa || ratio(*high) > ratio(*low);
}

[[noreturn]] void refuse_scale(const SyringeRun& run, const std::string& why) {
  const PressureScale right = other(run.scale);
  throw InvalidInput({run.file}, run.name + ": " + why + ": these are " + scale_name(right) + " pressures, given as " +
                                     scale_name(run.scale) + " ones (column " +
                                     (right == PressureScale::gauge ? "p_gauge_kpa" : "p_abs_kpa") +
                                     ", or p_kpa, said to be of " + scale_name(right) + " pressures)");
}

/// Mean value of the first `count` rows at rest, where what drives the test is nearly 0; none where no row is.
template <class Row>
std::optional<double> mean_at_rest(const std::vector<Row>& rows, std::size_t count, double Row::*drive,
                                   double Row::*value) {
  double greatest = 0, sum = 0, found = 0;
  for (const Row& row : rows) greatest = std::max(greatest, std::abs(row.*drive));
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(rows[i].*drive) > rest_fraction * greatest) continue;
    sum += rows[i].*value;
    ++found;
  }
  return found > 0 ? std::optional(sum / found) : std::nullopt;
}

/// Pressures at rest as the run has them.
std::optional<double> given_at_rest(const SyringeRun& run) {
  return mean_at_rest(run.rows, run.rows.size(), &SyringeRow::syringe_mm3, &SyringeRow::pressure_kPa);
}

void check_scale(const SyringeSetup& setup, const SyringeRun& run) {
  const std::optional<double> rest = given_at_rest(run);
  const bool is_absolute = run.scale == PressureScale::absolute;
  const double expected = is_absolute ? setup.atmosphere_kPa : 0, swapped = setup.atmosphere_kPa - expected;
  if (rest && std::abs(*rest - swapped) < std::abs(*rest - expected))
    refuse_scale(run, "with the syringe at rest its pressure is " + number(*rest, 4) + " kPa, and " +
                          scale_name(run.scale) + " pressures are " + number(expected, 4) + " kPa there");
  if (!rest && !makes_sense(setup, run, {run.scale}) && makes_sense(setup, run, {other(run.scale)}))
    refuse_scale(run, "its volume ratios make no sense, but they would on the other scale");
}

/// What would make sense of a run that makes none.
std::string hint(const SyringeSetup& setup, const SyringeRun& run) {
  if (makes_sense(setup, run, {run.scale, 1000})) return "; are its volumes in mL (column dv_sy_ml)?";
  if (makes_sense(setup, run, {run.scale, 0.001})) return "; are its volumes in mm^3 (column dv_sy_mm3)?";
  if (makes_sense(setup, run, {run.scale, -1}))
    return "; Delta V_sy is the air pushed out of the syringe, positive when pressure rises: is its sign turned round?";
  return "; check the volumes of chamber, tube and syringe";
}

[[noreturn]] void refuse_row(const SyringeRun& run, const SyringeRow& row, const std::string& why) {
  throw InvalidInput({run.file, row.line}, run.name + ": " + why);
}

double checked_ratio(const SyringeSetup& setup, const SyringeRun& run, const SyringeRow& row) {
  const double pressure = absolute(setup, run.scale, row.pressure_kPa);
  if (!(pressure > 0)) refuse_row(run, row, "an absolute pressure is above 0, not " + number(pressure, 4) + " kPa");
  if (row.syringe_mm3 > setup.syringe_mm3 * (1 + rounding))
    refuse_row(run, row,
               "the syringe cannot give " + number(row.syringe_mm3, 4) + " mm^3, it holds " +
                   number(setup.syringe_mm3, 4) + " mm^3" + hint(setup, run));
  const double ratio = chamber_ratio(setup, pressure, row.syringe_mm3);
  if (!(ratio > min_ratio && ratio < max_ratio))
    refuse_row(run, row, "the volume ratio of the chamber would be " + number(ratio, 4) + hint(setup, run));
  return ratio;
}

void check_setup(const SyringeSetup& setup) {
  const auto check = [](bool right, const char* what) {
    if (!right) throw InvalidInput(std::string("syringe test: ") + what);
  };
  check(setup.chamber_mm3 > 0 && std::isfinite(setup.chamber_mm3), "the chamber's volume must be above 0");
  check(setup.syringe_mm3 > 0 && std::isfinite(setup.syringe_mm3), "the syringe's volume must be above 0");
  check(setup.tube_mm3 >= 0 && std::isfinite(setup.tube_mm3), "the tube's volume must be 0 or more");
  check(setup.atmosphere_kPa > 0 && std::isfinite(setup.atmosphere_kPa), "the atmosphere must be above 0 kPa");
}

}  // namespace

std::vector<Sweep> sweeps_of(const std::vector<double>& drive) {
  if (drive.empty()) return {};
  const auto [low, high] = std::minmax_element(drive.begin(), drive.end());
  if (*low == *high) return {};
  std::vector<std::size_t> turns = turns_of(drive, noise_fraction * (*high - *low));
  std::vector<Sweep> sweeps;
  for (std::size_t t = 0; t + 1 < turns.size(); ++t)
    sweeps.push_back(
        {turns[t], turns[t + 1] + 1, drive[turns[t + 1]] > drive[turns[t]] ? Branch::loading : Branch::unloading});
  sweeps.back().end = drive.size();  // a dwell at the last extreme belongs to the sweep that led there
  return sweeps;
}

std::optional<double> rest_pressure(const SyringeSetup& setup, const SyringeRun& run) {
  const std::optional<double> given = given_at_rest(run);
  return given ? std::optional(absolute(setup, run.scale, *given)) : std::nullopt;
}

std::vector<SyringeSample> chamber_ratios(const SyringeSetup& setup, const std::vector<SyringeRun>& runs) {
  check_setup(setup);
  std::vector<SyringeSample> samples;
  std::size_t repeat = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const SyringeRun& run = runs[r];
    check_scale(setup, run);
    const std::vector<Sweep> sweeps = sweeps_of(run, &SyringeRow::syringe_mm3, "the syringe does not move");
    for (const Sweep& sweep : sweeps) {
      for (std::size_t i = sweep.begin; i < sweep.end; ++i) {
        const double gauge = absolute(setup, run.scale, run.rows[i].pressure_kPa) - setup.atmosphere_kPa;
        samples.push_back({{gauge, checked_ratio(setup, run, run.rows[i]), sweep.branch, repeat}, r, run.rows[i].line});
      }
      ++repeat;
    }
  }
  if (samples.empty()) throw InvalidInput("syringe test: no run");
  return samples;
}

VoltageSamples voltage_samples(const std::vector<VoltageRun>& runs) {
  VoltageSamples result;
  std::size_t repeat = 0;
  for (const VoltageRun& run : runs) {
    const std::vector<Sweep> sweeps = sweeps_of(run, &VoltageRow::voltage_kV, "the voltage does not change");
    const std::optional<double> rest =
        mean_at_rest(run.rows, sweeps.front().end, &VoltageRow::voltage_kV, &VoltageRow::area_ratio);
    if (!rest)
      throw InvalidInput({run.file}, run.name +
                                         ": its first sweep has no row without voltage, over whose area the "
                                         "others could be taken");
    result.rest_ratios.push_back(*rest);
    for (const Sweep& sweep : sweeps) {
      for (std::size_t i = sweep.begin; i < sweep.end; ++i)
        result.samples.push_back(
            {run.rows[i].voltage_kV, run.rows[i].area_ratio / result.rest_ratios.back(), sweep.branch, repeat});
      ++repeat;
    }
  }
  if (result.samples.empty()) throw InvalidInput("voltage test: no run");
  return result;
}

}  // namespace softkin::calibration
