#pragma once

#include <softkin/calibration/curve_fit.hpp>
#include <softkin/model/measurements.hpp>

namespace softkin::calibration {

/// Samples of the runs of a dielectric elastomer, cut where the voltage turns, areas over that without voltage.
struct VoltageSamples {
  std::vector<CurveSample> samples;
  std::vector<double> rest_ratios;  // per run: area ratio of the table without voltage; the others were divided by it
};

/// A run's rows within a fiftieth of its highest voltage count as without voltage; those of its first sweep are taken.
///
/// throws  InvalidInput naming file and run: no row without voltage, a voltage that does not change
[[nodiscard]] VoltageSamples voltage_samples(const std::vector<VoltageRun>& runs);

}  // namespace softkin::calibration
