#pragma once

#include <optional>
#include <softkin/io/json_text.hpp>
#include <softkin/statics/electric_layer.hpp>

namespace softkin::runs {

/// What a report says of a layer under voltage, beside its voltage; none: null for every number.
[[nodiscard]] Json layer_json(const std::optional<ElectricLayer>& layer);
/// The layer that an actuator of a report tells of.
///
/// throws  Json::exception where a key is missing
[[nodiscard]] std::optional<ElectricLayer> layer_of(const Json& actuator);

}  // namespace softkin::runs
