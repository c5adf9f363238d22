#pragma once

#include <cstddef>
#include <softkin/calibration/actuator_curves.hpp>
#include <softkin/model/actuator_curve.hpp>
#include <softkin/model/gas_law.hpp>
#include <softkin/model/measurements.hpp>
#include <vector>

namespace softkin::calibration {

/// Rows from one turning point of what drives a test to the next, both included.
struct Sweep {
  std::size_t begin = 0, end = 0;   // [begin, end)
  Branch branch = Branch::loading;  // does the drive rise or fall
};

/// Cuts a test where its drive turns. A turn is a retreat by more than a tenth of the drive's range: smaller ones are
/// noise. Rows before the first turn and after the last are sweeps as well.
///
/// drive    what the experimenter moves, row by row in time; finite
/// returns  none where the drive does not change
[[nodiscard]] std::vector<Sweep> sweeps_of(const std::vector<double>& drive);

using softkin::chamber_ratio;
using softkin::syringe_volume;
using softkin::SyringeSetup;

/// A row of a test after Eq. (19).
struct SyringeSample {
  CurveSample sample;    // gauge pressure [kPa]
  std::size_t run = 0;   // of the runs given
  std::size_t line = 0;  // of the run's file
};

/// Returns the volume ratios of all runs, cut into loading and unloading where the syringe turns.
///
/// throws  InvalidInput naming file, and run or line: a setup out of range; a run on the wrong pressure scale, detected
///         from its pressures at rest, or ratios that only make sense on the other scale; a syringe that delivers more
///         than its volume; ratios outside 0.2 to 20, with the correction if a factor of 1000 or a sign would be one
[[nodiscard]] std::vector<SyringeSample> chamber_ratios(const SyringeSetup& setup, const std::vector<SyringeRun>& runs);

/// Returns the mean pressure [kPa absolute] of the rows of a run in which the syringe has moved by at most a fiftieth
/// of its travel; none where there is no such row.
[[nodiscard]] std::optional<double> rest_pressure(const SyringeSetup& setup, const SyringeRun& run);

/// Samples of the runs of a dielectric elastomer, cut where the voltage turns, areas over that without voltage.
struct VoltageSamples {
  std::vector<CurveSample> samples;  // of all runs
  std::vector<double> rest_ratios;   // per run: area ratio of the table without voltage; the others were divided by it
};

/// A run's rows within a fiftieth of its highest voltage count as without voltage; those of its first sweep are taken.
///
/// throws  InvalidInput naming file and run: no row without voltage, a voltage that does not change
[[nodiscard]] VoltageSamples voltage_samples(const std::vector<VoltageRun>& runs);

}  // namespace softkin::calibration
