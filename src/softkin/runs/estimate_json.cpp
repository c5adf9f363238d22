#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/runs/estimate_json.hpp>

namespace softkin::runs {

Json matrix_json(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json reported_numbers_json(const Estimate& reported) {
  Json numbers = Json::array();
  for (const EstimatedNumber& n : reported.numbers)
    numbers.push_back({{"name", n.name},
                       {"unit", n.unit},
                       {"value", n.value},
                       {"deviation", n.deviation},
                       {"known_mean", n.known_mean},
                       {"known_deviation", n.known_deviation},
                       {"at_bound", n.at_bound}});
  return numbers;
}

Json reported_places_json(const Estimate& reported) {
  Json places = Json::array();
  for (const EstimatedPlace& p : reported.places)
    places.push_back({{"force", p.force},
                      {"at_rest_mm", json_of(p.at_rest)},
                      {"present_mm", json_of(p.present)},
                      {"covariance_mm2", matrix_json(p.covariance)}});
  return places;
}

Json left_out_json(const Estimate& reported, const std::vector<ReadingGroup>& groups) {
  Json names = Json::array();
  for (const std::size_t g : reported.left_out) names.push_back(groups[g].name);
  return names;
}

Json read_json(const Estimate& reported, const std::vector<PoseColumn>& columns, const Eigen::VectorXd& values) {
  Json readings = Json::array();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Index at = c;
    if (std::isnan(values[at]) || reported.computed.size() == 0) continue;
    readings.push_back({{"column", columns[c].name},
                        {"read", values[at]},
                        {"computed", reported.computed[at]},
                        {"computed_deviation", reported.deviations[at]}});
  }
  return readings;
}

}  // namespace softkin::runs
