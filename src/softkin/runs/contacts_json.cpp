#include <algorithm>
#include <nlohmann/json.hpp>
#include <softkin/runs/contacts_json.hpp>
#include <stdexcept>

namespace softkin::runs {

namespace {

/// visit(key, number) of each.
template <class Pair, class Visit>
void each_measure(Pair& pair, const Visit& visit) {
  visit("normal_N", pair.normal_N);
  visit("pressure_kPa", pair.pressure_kPa);
  visit("area_mm2", pair.area_mm2);
  visit("gap_mm", pair.gap_mm);
}

}  // namespace

Json contacts_json(const Model& model, const std::optional<std::vector<PairForces>>& contacts) {
  if (!contacts) return {};
  const auto name = [&](Index part) { return model.contact.parts[static_cast<std::size_t>(part)].name; };
  Json all = Json::array();
  for (const PairForces& pair : *contacts) {
    all.push_back({{"on", name(pair.a)},
                   {"by", name(pair.b)},
                   {"force_N", json_of(pair.force)},
                   {"moment_N_mm", json_of(pair.moment)},
                   {"center_mm", json_of(pair.center)}});
    each_measure(pair, [&](const char* key, double value) { all.back()[key] = known(value); });
    if (pair.slipping) all.back()["slipping"] = *pair.slipping;
  }
  return all;
}

std::vector<PairForces> contacts_of(const Model& model, const Json& list) {
  const auto part = [&](const Json& name) {
    const std::vector<ContactPart>& parts = model.contact.parts;
    const auto found = std::find_if(parts.begin(), parts.end(), [&](const auto& each) { return each.name == name; });
    if (found == parts.end()) throw std::out_of_range("no such part");
    return static_cast<Index>(found - parts.begin());
  };
  std::vector<PairForces> contacts;
  for (const Json& each : list) {
    PairForces& pair = contacts.emplace_back(PairForces{part(each.at("on")), part(each.at("by"))});
    pair.force = point_of(each.at("force_N"));
    pair.moment = point_of(each.at("moment_N_mm"));
    pair.center = point_of(each.at("center_mm"));
    each_measure(pair, [&](const char* key, double& value) { value = number_or_nan(each.at(key)); });
    if (each.contains("slipping")) pair.slipping = each.at("slipping").get<double>();
  }
  return contacts;
}

}  // namespace softkin::runs
