#pragma once

#include <softkin/io/json_text.hpp>
#include <softkin/runs/records.hpp>

namespace softkin::runs {

/// Present volume of a chamber, of those that are connected together [mL].
[[nodiscard]] double volume_mL(const Actuator& chamber, const ActuatorRecord& record);
/// Of a sealed one: its gas or liquid, that in dead volumes and its syringe with it [mL under atmospheric pressure].
[[nodiscard]] double amount_mL(const Actuator& chamber, const ActuatorRecord& record);

/// What a report adds of a chamber: of a sealed one its volume and its amount; of connected ones the volume of each. A
/// number that is not known is null.
[[nodiscard]] Json chamber_json(const Actuator& chamber, const ActuatorRecord& record);
/// Reads the numbers that no other entry of a report contains: the volumes of connected chambers.
///
/// throws  Json::exception where a key is missing
void read_chamber(const Actuator& chamber, const Json& json, ActuatorRecord& record);

}  // namespace softkin::runs
