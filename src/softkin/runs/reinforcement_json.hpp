#pragma once

#include <softkin/runs/records_json.hpp>

namespace softkin::runs {

/// What threads and layers of a robot carry; a number that is not known is null.
[[nodiscard]] Json fibres_json(const Model& model, const std::vector<FibreForces>& fibres);
[[nodiscard]] Json layers_json(const Model& model, const std::vector<LayerForces>& layers);
/// The same of a report.
///
/// throws  Json::exception where a key is missing
[[nodiscard]] std::vector<FibreForces> fibres_of(const Json& json);
[[nodiscard]] std::vector<LayerForces> layers_of(const Json& json);

}  // namespace softkin::runs
