#include <nlohmann/json.hpp>
#include <softkin/runs/chamber_json.hpp>
#include <softkin/runs/records_json.hpp>

namespace softkin::runs {

namespace {

constexpr double mm3_of_a_mL = 1000, MPa_of_a_kPa = 1e-3;

}  // namespace

double volume_mL(const Actuator& chamber, const ActuatorRecord& record) {
  return record.achieved * chamber.rest_measure / mm3_of_a_mL;
}

double amount_mL(const Actuator& chamber, const ActuatorRecord& record) {
  return filling_of(chamber)->amount_mL(mm3_of_a_mL * volume_mL(chamber, record), MPa_of_a_kPa * record.multiplier);
}

Json chamber_json(const Actuator& chamber, const ActuatorRecord& record) {
  Json json = Json::object();
  if (filling_of(chamber)) {
    json["volume_mL"] = known(volume_mL(chamber, record));
    json["amount_mL"] = known(amount_mL(chamber, record));
  }
  for (std::size_t i = 0; i < record.volumes_mL.size(); ++i)
    json["volumes_mL"][connected_chambers(chamber)[i].region] = known(record.volumes_mL[i]);
  return json;
}

void read_chamber(const Actuator& chamber, const Json& json, ActuatorRecord& record) {
  for (const ConnectedChamber& each : connected_chambers(chamber))
    record.volumes_mL.push_back(number_or_nan(json.at("volumes_mL").at(each.region)));
}

}  // namespace softkin::runs
