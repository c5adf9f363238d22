#pragma once

#include <softkin/drive/machine.hpp>
#include <string>

namespace softkin::drive {

/// Gauge pressures over time; between rows they change linearly.
struct PressureSchedule {
  std::vector<std::string> channels;
  struct Row {
    double time_s = 0;
    std::vector<double> kpa;  // per channel
  };
  std::vector<Row> rows;
};

/// The pressures that the chambers are commanded to, one row for each of the commands.
///
/// throws  InvalidInput naming file:line, chamber, pressure and limit; or the file where it has no times
[[nodiscard]] PressureSchedule plan_pressures(const Machine& machine, const Commands& commands);

/// CSV: t_s, then a column CHANNEL_kPa for each.
[[nodiscard]] std::string schedule_csv(const PressureSchedule& schedule);

}  // namespace softkin::drive
