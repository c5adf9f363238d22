#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/drive/curve_pressures.hpp>

namespace softkin::drive {

void take_curve_pressures(const Model& model, Commands& commands) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    if (!commands.commanded[a] || commands.pressure_known[a] || !actuator.is<ChamberDrive>() ||
        actuator.control != Control::ratio || !actuator.curve)
      continue;
    for (CommandRow& row : commands.rows) {
      const double ratio = row.actuation[a];
      const std::optional<double> gauge_kpa = input_by_curve(actuator, ratio, actuator.branch);
      if (!gauge_kpa)
        throw InvalidInput({commands.file, row.line}, "chamber '" + actuator.name + "': the " +
                                                          branch_name(actuator.branch) + " branch of curve " +
                                                          actuator.curve->file + " does not reach ratio " +
                                                          number(ratio, 6));
      row.pressures_kpa[a] = *gauge_kpa;
    }
    commands.pressure_known[a] = true;
  }
}

}  // namespace softkin::drive
