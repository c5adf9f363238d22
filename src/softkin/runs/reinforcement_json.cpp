#include <nlohmann/json.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/runs/reinforcement_json.hpp>

namespace softkin::runs {

Json fibres_json(const Model& model, const std::vector<FibreForces>& fibres) {
  Json all = Json::array();
  for (std::size_t f = 0; f < fibres.size(); ++f)
    all.push_back({{"fibre", model.reinforcement.fibres[f].name},
                   {"mean_N", known(fibres[f].mean_N)},
                   {"largest_N", known(fibres[f].largest_N)},
                   {"least_N", known(fibres[f].min_N)},
                   {"at_mm", json_of(fibres[f].where)},
                   {"stretch", known(fibres[f].stretch)},
                   {"slack", known(fibres[f].slack)}});
  return all;
}

Json layers_json(const Model& model, const std::vector<LayerForces>& layers) {
  Json all = Json::array();
  for (std::size_t l = 0; l < layers.size(); ++l)
    all.push_back({{"layer", model.reinforcement.layers[l]->name},
                   {"largest_N_mm", known(layers[l].largest_N_mm)},
                   {"least_N_mm", known(layers[l].min_N_mm)},
                   {"at_mm", json_of(layers[l].where)},
                   {"strain", known(layers[l].strain)},
                   {"wrinkled", known(layers[l].wrinkled)},
                   {"slack", known(layers[l].slack)}});
  return all;
}

std::vector<LayerForces> layers_of(const Json& json) {
  std::vector<LayerForces> layers;
  for (const Json& layer : json)
    layers.push_back({number_or_nan(layer.at("largest_N_mm")), number_or_nan(layer.at("least_N_mm")),
                      point_of(layer.at("at_mm")), number_or_nan(layer.at("strain")),
                      number_or_nan(layer.at("wrinkled")), number_or_nan(layer.at("slack"))});
  return layers;
}

std::vector<FibreForces> fibres_of(const Json& json) {
  std::vector<FibreForces> fibres;
  for (const Json& fibre : json)
    fibres.push_back({number_or_nan(fibre.at("largest_N")), number_or_nan(fibre.at("least_N")),
                      number_or_nan(fibre.at("mean_N")), point_of(fibre.at("at_mm")),
                      number_or_nan(fibre.at("stretch")), number_or_nan(fibre.at("slack"))});
  return fibres;
}

}  // namespace softkin::runs
