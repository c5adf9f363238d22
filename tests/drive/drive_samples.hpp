#pragma once

#include <softkin/drive/machine.hpp>
#include <softkin/drive/plan.hpp>
#include <softkin/model/model.hpp>

namespace softkin::testing {

/// Cables of 40 and 60 mm under length control, ratios 0.5 to 1.
inline Model two_tendons() {
  Model model;
  for (const auto& [name, length] : {std::pair("a", 40.0), std::pair("b", 60.0)}) {
    Actuator actuator;
    actuator.name = name;
    actuator.low = 0.5;
    actuator.high = 1;
    actuator.rest_measure = length;
    model.actuators.push_back(actuator);
  }
  return model;
}

inline HardwareSpec two_motors() {
  HardwareSpec hardware;
  hardware.file = "hardware.yaml";
  for (const auto& [name, axis, line] : {std::tuple("a", 'X', 3u), std::tuple("b", 'Y', 4u)}) {
    TendonSpec tendon;
    tendon.origin = {"hardware.yaml", line};
    tendon.actuator = name;
    tendon.axis = axis;
    hardware.tendons.push_back(tendon);
  }
  return hardware;
}

/// Returns ratios of two cables, a row each, with times [s] (none: no times); lines 2, 3, ...
inline Commands two_commands(const std::vector<std::array<double, 2>>& ratios, const std::vector<double>& times = {}) {
  Commands commands{"commands.csv", {true, true}, {false, false}, {}};
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    CommandRow row;
    row.actuation = Eigen::Vector2d(ratios[i][0], ratios[i][1]);
    row.pressures_kpa = Eigen::VectorXd::Zero(2);
    if (!times.empty()) row.time_s = times[i];
    row.line = i + 2;
    commands.rows.push_back(row);
  }
  return commands;
}

}  // namespace softkin::testing
