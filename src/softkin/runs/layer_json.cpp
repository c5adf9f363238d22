#include <nlohmann/json.hpp>
#include <softkin/runs/layer_json.hpp>
#include <softkin/runs/records_json.hpp>

namespace softkin::runs {

Json layer_json(const std::optional<ElectricLayer>& layer) {
  const auto reported = [&](double ElectricLayer::*number) { return layer ? known((*layer).*number) : Json(); };
  return {{"charge_nC", reported(&ElectricLayer::charge_nC)},
          {"capacitance_pF", reported(&ElectricLayer::capacitance_pF)},
          {"field_kV_mm", reported(&ElectricLayer::field_kV_mm)},
          {"thickness_mm", reported(&ElectricLayer::thickness_mm)},
          {"field_at_mm", layer ? json_of(layer->at) : Json()}};
}

std::optional<ElectricLayer> layer_of(const Json& actuator) {
  const Json& at = actuator.at("field_at_mm");
  if (at.is_null()) return std::nullopt;
  ElectricLayer layer;
  layer.charge_nC = number_or_nan(actuator.at("charge_nC"));
  layer.capacitance_pF = number_or_nan(actuator.at("capacitance_pF"));
  layer.field_kV_mm = number_or_nan(actuator.at("field_kV_mm"));
  layer.thickness_mm = number_or_nan(actuator.at("thickness_mm"));
  layer.at = point_of(at);
  return layer;
}

}  // namespace softkin::runs
