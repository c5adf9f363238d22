#include <algorithm>
#include <cmath>
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

const std::string& name_of_part(const Model& model, Index part) {
  return model.contact.parts[part].name;
}

}  // namespace

Json contacts_json(const Model& model, const std::optional<std::vector<PairForces>>& contacts) {
  if (!contacts) return {};
  Json all = Json::array();
  for (const PairForces& pair : *contacts) {
    all.push_back({{"on", name_of_part(model, pair.a)},
                   {"by", name_of_part(model, pair.b)},
                   {"force_N", json_of(pair.force)},
                   {"moment_N_mm", json_of(pair.moment)},
                   {"center_mm", json_of(pair.center)}});
    each_measure(pair, [&](const char* key, double value) { all.back()[key] = known(value); });
    if (pair.slipping) all.back()["slipping"] = *pair.slipping;
  }
  return all;
}

std::vector<std::array<std::string, 2>> sliding_pairs(const Model& model,
                                                      const std::optional<std::vector<PairForces>>& contacts) {
  std::vector<std::array<std::string, 2>> pairs;
  if (!contacts) return pairs;
  for (const PairForces& pair : *contacts)
    if (pair.slipping.value_or(0) > 0) pairs.push_back({name_of_part(model, pair.a), name_of_part(model, pair.b)});
  return pairs;
}

std::vector<PairForces> contacts_of(const Model& model, const Json& list) {
  const auto part = [&](const Json& reported) {
    const auto name = reported.get<std::string>();
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

Json anchors_json(const std::vector<Anchor>& anchors) {
  Json all = Json::array();
  for (const Anchor& a : anchors)
    all.push_back({a.vertex, a.part, a.triangle, a.weights[0], a.weights[1], a.weights[2], a.slipped_mm});
  return all;
}

std::vector<Anchor> anchors_of(const Model& model, const Json& list) {
  const auto below = [](const Json& number, std::size_t count) {
    const auto index = number.get<std::int64_t>();
    if (index < 0 || index >= static_cast<std::int64_t>(count)) throw std::out_of_range("no such place of contact");
    return static_cast<Index>(index);
  };
  const ContactModel& contact = model.contact;
  std::vector<Anchor> anchors;
  for (const Json& each : list) {
    if (each.size() != 7) throw std::out_of_range("an anchor of friction has seven numbers");
    Anchor anchor{below(each[0], contact.area.size()), below(each[1], contact.parts.size()),
                  below(each[2], contact.triangles.size())};
    if (contact.part_of[anchor.triangle] != anchor.part)
      throw std::out_of_range("an anchor of friction is on another part");
    for (int i = 0; i < 3; ++i) anchor.weights[i] = each[3 + i].get<double>();
    anchor.slipped_mm = each[6].get<double>();
    if (!anchor.weights.allFinite() || !std::isfinite(anchor.slipped_mm))
      throw std::out_of_range("an anchor of friction is not finite");
    anchors.push_back(anchor);
  }
  return anchors;
}

}  // namespace softkin::runs
