#include <algorithm>
#include <softkin/calibration/sweeps.hpp>
#include <softkin/calibration/voltage.hpp>
#include <softkin/core/error.hpp>

namespace softkin::calibration {

namespace {

constexpr double rest_share = 0.02;  // of the highest voltage

/// Mean area ratio of the rows without voltage.
double rest_ratio(const VoltageRun& run, const Sweep& first) {
  double highest = 0, sum = 0, count = 0;
  for (const VoltageRow& row : run.rows) highest = std::max(highest, row.voltage_kV);
  for (std::size_t i = first.begin; i < first.end; ++i) {
    if (run.rows[i].voltage_kV > rest_share * highest) continue;
    sum += run.rows[i].area_ratio;
    ++count;
  }
  if (count == 0)
    throw InvalidInput({run.file}, run.name +
                                       ": its first sweep has no row without voltage, over whose area the "
                                       "others could be taken");
  return sum / count;
}

}  // namespace

VoltageSamples voltage_samples(const std::vector<VoltageRun>& runs) {
  VoltageSamples result;
  std::size_t repeat = 0;
  for (const VoltageRun& run : runs) {
    std::vector<double> drive;
    for (const VoltageRow& row : run.rows) drive.push_back(row.voltage_kV);
    const std::vector<Sweep> sweeps = sweeps_of(drive);
    if (sweeps.empty()) throw InvalidInput({run.file}, run.name + ": the voltage does not change");
    result.rest_ratios.push_back(rest_ratio(run, sweeps.front()));
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
