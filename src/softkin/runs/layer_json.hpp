#pragma once

#include <optional>
#include <softkin/io/json_text.hpp>
#include <softkin/statics/electric_layer.hpp>

namespace softkin::runs {

/// The entries of a report on a layer under voltage, besides its voltage; none: null for every number.
[[nodiscard]] Json layer_json(const std::optional<ElectricLayer>& layer);
/// Reads the layer of an actuator from a report.
///
/// throws  Json::exception where a key is missing
[[nodiscard]] std::optional<ElectricLayer> layer_of(const Json& actuator);

}  // namespace softkin::runs
