#include <nlohmann/json.hpp>
#include <softkin/io/base64.hpp>
#include <softkin/runs/map_export_parts.hpp>
#include <softkin/runs/map_tables.hpp>

namespace softkin::runs {

namespace {

Json sums_table(const FlatSums& sums) {
  return {{"size", sums.size},       {"highest", sums.highest},
          {"cells", sums.cell_runs}, {"terms", sums.cell_terms},
          {"runs", sums.runs},       {"coefficients", to_base64(sums.coefficients.data(), sums.coefficients.size())}};
}

/// Values in rows of so many.
template <class Values>
Json in_rows(const Values& values, std::size_t size) {
  Json table = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % size == 0) table.push_back(Json::array());
    table.back().push_back(values[i]);
  }
  return table;
}

}  // namespace

Json map_tables(const MapData& data) {
  const FlatMap flat = flat_map(data);
  Json nodes = Json::array(), cables = Json::array();
  for (std::size_t n = 0; n < flat.node_at.size(); ++n) {
    const auto& [below, above] = flat.node_children[n];
    nodes.push_back(flat.node_inputs[n] < 0 ? Json{below} : Json{flat.node_inputs[n], flat.node_at[n], below, above});
  }
  for (const MapCable& cable : data.cables)
    cables.push_back(
        {{"input", cable.input}, {"command", cable.command}, {"tension", cable.tension}, {"ratio", cable.ratio}});
  return {{"pieces", flat.pieces},
          {"variables", in_rows(flat.variables, data.inputs.size())},
          {"roots", flat.roots},
          {"nodes", nodes},
          {"cables", cables},
          {"boxes", in_rows(flat.boxes, data.inputs.size())},
          {"outputs", sums_table(flat.outputs)},
          {"modes", sums_table(flat.modes)}};
}

Json inputs_table(const MapData& data) {
  Json table = Json::array();
  for (const MapInput& input : data.inputs)
    table.push_back({{"name", input.name}, {"unit", input.unit}, {"low", input.low}, {"high", input.high}});
  return table;
}

Json outputs_table(const MapData& data) {
  Json table = Json::array();
  for (std::size_t q = 0; q < data.outputs.size(); ++q) {
    const Index at = q;
    table.push_back({{"name", data.outputs[q].name},
                     {"unit", data.outputs[q].unit},
                     {"accuracy", data.outputs[q].accuracy},
                     {"largestError", data.check.largest[at]},
                     {"meanError", data.check.mean[at]}});
  }
  return table;
}

Json checked_table(const MapData& data) {
  Json table{{"points", data.check.points}, {"outside", data.check.outside}, {"equilibria", data.equilibria}};
  if (data.shape) {
    table["shapeLargestErrorMm"] = data.check.shape_largest_mm;
    table["shapeMeanErrorMm"] = data.check.shape_mean_mm;
  }
  return table;
}

Json shape_table(const MapShape& shape) {
  return {{"mean", to_base64(shape.mean.data(), shape.mean.size())},
          {"units", std::vector<double>(shape.units.begin(), shape.units.end())},
          {"modes", to_base64(shape.modes.data(), shape.modes.size())}};
}

MapShape shape_at(const MapShape& shape, const std::vector<Index>& vertices) {
  MapShape part{Eigen::VectorXf(3 * vertices.size()), {}, shape.units, shape.accuracy_mm};
  part.modes.resize(part.mean.size(), shape.modes.cols());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Index to = 3 * i, from = 3 * vertices[i];
    part.mean.segment<3>(to) = shape.mean.segment<3>(from);
    part.modes.middleRows<3>(to) = shape.modes.middleRows<3>(from);
  }
  return part;
}

}  // namespace softkin::runs
