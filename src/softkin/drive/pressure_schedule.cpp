#include <cstdio>
#include <softkin/core/text.hpp>
#include <softkin/drive/pressure_schedule.hpp>

namespace softkin::drive {

PressureSchedule plan_pressures(const Machine& machine, const Commands& commands) {
  PressureSchedule schedule;
  for (const Chamber& chamber : machine.chambers) schedule.channels.push_back(chamber.channel);
  if (schedule.channels.empty()) return schedule;
  if (!commands.rows.front().time_s)
    throw InvalidInput({commands.file}, "has no column t_s [s]: a schedule of pressures needs the times");
  for (const CommandRow& row : commands.rows) {
    PressureSchedule::Row out{*row.time_s, {}};
    for (const Chamber& chamber : machine.chambers) {
      const bool known = commands.pressure_known[static_cast<std::size_t>(chamber.actuator)];
      const double kpa = known ? row.pressures_kpa[chamber.actuator] : row.actuation[chamber.actuator];
      const bool low = kpa < chamber.low_kpa;
      if (low || kpa > chamber.high_kpa)
        throw InvalidInput({commands.file, row.line}, "chamber '" + chamber.name + "': pressure " + number(kpa, 6) +
                                                          " kPa is " + (low ? "below" : "above") + " its limit of " +
                                                          number(low ? chamber.low_kpa : chamber.high_kpa, 6) +
                                                          " kPa (" + chamber.origin.text() + ")");
      out.kpa.push_back(kpa);
    }
    schedule.rows.push_back(std::move(out));
  }
  return schedule;
}

std::string schedule_csv(const PressureSchedule& schedule) {
  std::string text = "t_s";
  for (const std::string& channel : schedule.channels) text += "," + channel + "_kPa";
  text += "\n";
  for (const PressureSchedule::Row& row : schedule.rows) {
    text += number(row.time_s, 12);
    for (const double kpa : row.kpa) text += "," + number(kpa, 9);
    text += "\n";
  }
  return text;
}

}  // namespace softkin::drive
