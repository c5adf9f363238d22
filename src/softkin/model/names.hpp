#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>

namespace softkin {

/// "pneumatic", "cable", "dea", "magnetic" or "growth"; of what is done to it and its surroundings "motion", "force",
/// "hold", "turn", "moment" or "pressure".
[[nodiscard]] const char* kind_name(const Actuator& actuator);
/// Returns the name of the commanded quantity: "volume", "length", "area" (over that at rest), "pressure", "tension" or
/// "voltage"; of a sealed chamber "amount of gas", "amount of liquid" or "pushed volume"; of a magnetic field "flux
/// density", "current", "position" or "moment"; of a growth "stretch" or "temperature"; else its kind.
[[nodiscard]] const char* control_name(const Actuator& actuator);
/// "ratio", or control_name().
[[nodiscard]] const char* command_name(const Actuator& actuator);
/// Has it a length, an area or a volume?
[[nodiscard]] bool has_measure(const Actuator& actuator);
/// Returns the name of its measure: "length", "area" or "volume".
[[nodiscard]] const char* measure_name(const Actuator& actuator);
/// Is it commanded by its load or its filling, so that its achieved value is its measure?
[[nodiscard]] bool answers_with_measure(const Actuator& actuator);
/// Is the achieved value of a physical robot its load, as that is not commanded?
[[nodiscard]] bool answers_with_load(const Actuator& actuator);
/// Is it commanded by its load, and not a cable, so that its volume or area is shown instead of the commanded load?
[[nodiscard]] bool shows_measure(const Actuator& actuator);
/// The unit of what the user commands, bare: "", "kPa", "N", "kV", "mL", "mm", "mT", "A", "A m^2", "degC", "N mm"; as a
/// table has it: "[-]", "[kPa]", ....
[[nodiscard]] std::string command_unit(const Actuator& actuator);
[[nodiscard]] std::string bracketed_unit(const Actuator& actuator);
/// The column of a CSV file that holds the commands of an actuator: "tendon", "air_kPa", "magnet_mx_Am2",
/// "air_mL".
[[nodiscard]] std::string command_column(const Actuator& actuator);

/// Returns the key of the load of a physical robot's actuator: "pressure_kPa" (pneumatic), "tension_N" (cable),
/// "voltage_kV" (dea under voltage) or "" (dea).
[[nodiscard]] std::string multiplier_key(const Actuator& actuator);
/// "pressure [kPa]", "tension [N]", "voltage [kV]" or "": the same as a title, and its unit bare.
[[nodiscard]] std::string multiplier_title(const Actuator& actuator);
[[nodiscard]] std::string multiplier_unit(const Actuator& actuator);
/// "curve_pressure_kPa" or "curve_voltage_kV".
[[nodiscard]] const char* curve_key(const ActuatorCurve& curve);

/// "1.62" or "50 kPa".
[[nodiscard]] std::string command_text(const Actuator& actuator, double value, int digits = 6);
/// "its range, 1 to 2 [-]" or "its range, 0 to 80 kPa".
[[nodiscard]] std::string range_text(const Actuator& actuator);

/// "neo-hookean", "st-venant-kirchhoff", as scenes have it.
[[nodiscard]] const char* law_name(Law law);
/// "neo-hookean, mooney-rivlin, ... or ogden": the laws that can keep the volume. quote: around each name
[[nodiscard]] std::string laws_with_bulk_part(const std::string& quote = "");
/// "physical" or "target-shape".
[[nodiscard]] const char* formulation_name(Formulation formulation);
/// "printed" or "mesh-independent".
[[nodiscard]] const char* weights_name(ElementWeights weights);
/// "converged", "not converged", "interrupted" or "limit".
[[nodiscard]] const char* name_of(Status status);

/// The marker that shows where a foot is. foot: 0 the rear one, 1 the front one.
[[nodiscard]] const std::string& foot_name(const Model& model, std::size_t foot);

/// The place of an actuator of that name in model.actuators; none: there is none.
[[nodiscard]] std::optional<Index> find_actuator(const Model& model, const std::string& name);

}  // namespace softkin
