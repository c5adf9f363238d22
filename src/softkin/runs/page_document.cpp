#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/base64.hpp>
#include <softkin/kinematics/maps/piece_solver.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/mesh/borders.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/map_export_parts.hpp>
#include <softkin/runs/map_tables.hpp>
#include <softkin/runs/obstacle_picture.hpp>
#include <softkin/runs/page_document.hpp>
#include <softkin/runs/records_json.hpp>

namespace softkin::runs {

namespace {

template <class Number>
Json page_array(const char* type, const std::vector<Number>& numbers) {
  return {{type, to_base64(numbers.data(), numbers.size())}};
}

std::vector<float> coordinates(const Points& points, const std::vector<Index>& vertices) {
  std::vector<float> numbers;
  numbers.reserve(3 * vertices.size());
  for (const Index v : vertices)
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(points(v, axis)));
  return numbers;
}

Json page_points(const Points& points) {
  const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> numbers = points.cast<float>();
  return {{"f32", to_base64(numbers.data(), numbers.size())}};
}

/// Numbers in rows of so many components, rounded; what is no number becomes the lowest of its component.
Json rounded_array(const std::vector<float>& numbers, std::size_t components) {
  constexpr float levels = std::numeric_limits<std::uint16_t>::max();
  std::vector<float> low(components), step(components);
  std::vector<std::uint16_t> all(numbers.size());
  for (std::size_t c = 0; c < components; ++c) {
    float least = std::numeric_limits<float>::max(), most = -least;
    for (std::size_t i = c; i < numbers.size(); i += components) {
      if (!std::isfinite(numbers[i])) continue;
      least = std::min(least, numbers[i]);
      most = std::max(most, numbers[i]);
    }
    if (most < least) continue;
    low[c] = least;
    step[c] = most / levels - least / levels;
    if (step[c] <= 0) continue;
    for (std::size_t i = c; i < numbers.size(); i += components)
      if (std::isfinite(numbers[i]))
        all[i] = static_cast<std::uint16_t>(std::clamp(std::round((numbers[i] - least) / step[c]), 0.0F, levels));
  }
  Json json = page_array("u16", all);
  json["low"] = low;
  json["step"] = step;
  return json;
}

/// The unit of what a robot answers with; "" where it answers nothing.
std::string load_unit(const Model& model, const Actuator& actuator) {
  if (model.formulation != Formulation::physical) return "";
  return !shows_measure(actuator) ? multiplier_unit(actuator) : flat_at_rest(actuator) ? "mL" : "× rest";
}

/// What one mT of its command adds to the flux density everywhere, a unit vector [mT]; none: it makes no uniform field.
std::optional<Vec3> uniform_flux_density(const Model& model, const Actuator& actuator) {
  const auto* drive = actuator.as<MagneticDrive>();
  if (!drive) return std::nullopt;
  const FieldSource& source = model.magnetism->sources[drive->source];
  const auto* uniform = std::get_if<UniformField>(&source.field);
  if (uniform == nullptr) return std::nullopt;
  const int axis = axis_of(drive->command);
  return axis < 0 ? uniform->direction : Vec3(Vec3::Unit(axis));
}

Json page_actuator(const Model& model, const Actuator& actuator) {
  Json json{{"name", actuator.name},
            {"kind", kind_name(actuator)},
            {"control", control_name(actuator)},
            {"unit", command_unit(actuator)},
            {"low", actuator.low},
            {"high", actuator.high},
            {"rest", actuator.rest},
            {"load_unit", load_unit(model, actuator)},
            {"measure_unit", page_measure_unit(model, actuator)}};
  if (const auto flux_density = uniform_flux_density(model, actuator)) json["flux_density"] = json_of(*flux_density);
  return json;
}

Json page_actuators(const Model& model) {
  Json list = Json::array();
  for (const Actuator& each : model.actuators) list.push_back(page_actuator(model, each));
  return list;
}

Json page_markers(const Model& model) {
  Json list = Json::array();
  for (const Marker& marker : model.markers)
    list.push_back({{"name", marker.name}, {"at", json_of(marker.at(model.rest))}});
  for (Json& marker : list)
    for (const FreeBody& body : model.bodies)
      if (marker.at("name") == body.name) marker["body"] = true;
  return list;
}

std::vector<Index> vertices_of_element(const Model& model, std::size_t element) {
  const auto all = [](const auto& of) { return std::vector<Index>(of.begin(), of.end()); };
  if (element >= model.elements.tetrahedra.size())
    return all(model.elements.prisms[element - model.elements.tetrahedra.size()]);
  std::vector<Index> vertices = all(model.elements.tetrahedra[element]);
  if (!model.elements.edge_nodes.empty())
    vertices.insert(vertices.end(), model.elements.edge_nodes[element].begin(),
                    model.elements.edge_nodes[element].end());
  return vertices;
}

double volume_of(const Model& model, std::size_t element) {
  const std::size_t tetrahedra = model.elements.tetrahedra.size();
  return element < tetrahedra ? model.elements.tetrahedron_volumes[element]
                              : model.elements.prism_volumes[element - tetrahedra];
}

bool is_body(const Model& model, std::size_t triangle) {
  const std::size_t part = model.contact.part_of[triangle];
  return model.contact.parts[part].rank == ContactRank::body;
}

/// Knots of a thread, not denser than a picture shows.
std::vector<EmbeddedPoint> drawn_knots(const Model& model, const Fibre& fibre) {
  const double least = model.diagonal_mm / 250;
  std::vector<EmbeddedPoint> knots;
  for (const EmbeddedPoint& knot : fibre.knots)
    if (knots.empty() || &knot == &fibre.knots.back() ||
        (knot.at(model.rest) - knots.back().at(model.rest)).norm() > least)
      knots.push_back(knot);
  return knots;
}

/// Threads, and the borders of layers.
std::vector<std::vector<EmbeddedPoint>> reinforcement_lines(const Model& model) {
  std::vector<std::vector<EmbeddedPoint>> lines;
  for (const Fibre& fibre : model.reinforcement.fibres) lines.push_back(drawn_knots(model, fibre));
  for (const auto& layer : model.reinforcement.layers) {
    std::vector<Triangle> triangles;
    std::vector<std::array<Index, 3>> beside;
    for (const CavityFace& face : layer->faces) {
      triangles.push_back(face.corners);
      beside.push_back(face.edges);
    }
    for (const std::vector<Index>& border : borders_of(triangles, beside)) {
      lines.emplace_back();
      for (const Index v : border) lines.back().push_back({{v}, {1}, 0});
    }
  }
  return lines;
}

/// Of cables, threads and layers.
std::vector<Index> line_vertices(const Model& model) {
  std::vector<Index> vertices;
  for (const std::vector<EmbeddedPoint>& line : reinforcement_lines(model))
    for (const EmbeddedPoint& point : line)
      vertices.insert(vertices.end(), point.vertices.begin(), point.vertices.end());
  for (const Actuator& actuator : model.actuators)
    if (const auto* cable = actuator.as<CableDrive>())
      for (const EmbeddedPoint& point : cable->points)
        vertices.insert(vertices.end(), point.vertices.begin(), point.vertices.end());
  return vertices;
}

std::vector<Index> body_vertices(const Model& model) {
  std::vector<Index> vertices;
  for (std::size_t t = 0; t < model.contact.triangles.size(); ++t)
    if (is_body(model, t))
      vertices.insert(vertices.end(), model.contact.triangles[t].begin(), model.contact.triangles[t].end());
  return vertices;
}

}  // namespace

std::string page_measure_unit(const Model& model, const Actuator& actuator) {
  const bool is_load = model.formulation == Formulation::physical && shows_measure(actuator);
  if (is_load || !maps::answers_with_ratio(model, actuator)) return "";
  return flat_at_rest(actuator) ? "mL" : "× rest";
}

PageDocument::PageDocument(const Model& model, std::string command)
    : model_(model),
      command_(std::move(command)),
      surface_(body_surface(model)),
      numbers_(model.rest.rows(), -1),
      last_(model.rest) {
  std::vector<Index> all;
  for (const Triangle& t : surface_.triangles) all.insert(all.end(), t.begin(), t.end());
  take(all);
  for (const Index v : vertices_) drawn_.extend(vertex_at(model.rest, v));
  take(line_vertices(model));
  take(body_vertices(model));
}

void PageDocument::take(const std::vector<Index>& more) {
  std::vector<Index> fresh = more;
  sort_unique(fresh);
  for (const Index v : fresh) {
    Index& number = numbers_[v];
    if (number >= 0) continue;
    number = vertices_.size();
    vertices_.push_back(v);
  }
}

/// Of the elements around each, weighted by their volumes at rest; 0 where there are none.
std::vector<float> PageDocument::mean_at_vertices(const std::vector<double>& of_elements) const {
  std::vector<double> sums(vertices_.size()), volumes(vertices_.size());
  for (std::size_t e = 0; e < of_elements.size(); ++e) {
    if (!is_solid(model_, e)) continue;
    for (const Index v : vertices_of_element(model_, e)) {
      if (number(v) < 0) continue;
      const std::size_t at = number(v);
      sums[at] += volume_of(model_, e) * of_elements[e];
      volumes[at] += volume_of(model_, e);
    }
  }
  std::vector<float> means(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
    if (volumes[i] > 0) means[i] = static_cast<float>(sums[i] / volumes[i]);
  return means;
}

std::vector<VertexField> PageDocument::fields(const ElementDeformation& deformation) const {
  std::vector<double> strain;
  strain.reserve(deformation.strain.size());
  for (const auto& principal : deformation.strain) strain.push_back(principal[0]);
  std::vector<VertexField> fields{{"strain", mean_at_vertices(strain)},
                                  {"volume_ratio", mean_at_vertices(deformation.volume_ratio)}};
  if (!deformation.contacts) return fields;
  std::vector<float> pressure;
  for (const Index v : vertices_) pressure.push_back(static_cast<float>(deformation.contacts->pressure_kPa[v]));
  fields.push_back({"contact_pressure", std::move(pressure)});
  return fields;
}

void PageDocument::add(const StepRecord& record, const Points& positions, const ElementDeformation& deformation) {
  for (const Index v : vertices_)
    if (positions.row(v).allFinite()) drawn_.extend(vertex_at(positions, v));
  last_ = positions;
  Json fields = Json::object();
  for (const VertexField& field : this->fields(deformation)) fields[field.name] = rounded_array(field.values, 1);
  Json loads = Json::array(), measures = Json::array(), markers = Json::array(), commands = Json::array();
  for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
    commands.push_back(known(record.actuation[a]));
    const bool answers = !load_unit(model_, model_.actuators[a]).empty();
    const ActuatorRecord& of = record.actuators[a];
    loads.push_back(answers ? known(shows_measure(model_.actuators[a]) ? of.achieved : of.multiplier) : Json());
    measures.push_back(page_measure_unit(model_, model_.actuators[a]).empty() ? Json() : known(of.achieved));
  }
  for (const Vec3& marker : record.markers) markers.push_back(json_of(marker));
  steps_.push_back(line_of({{"commands", commands},
                            {"loads", loads},
                            {"measures", measures},
                            {"markers", markers},
                            {"status", name_of(record.status)},
                            {"remark", record.remark},
                            {"iterations", record.iterations},
                            {"seconds", record.seconds},
                            {"time_s", record.time_s ? Json(*record.time_s) : Json()},
                            {"positions", rounded_array(coordinates(positions, vertices_), 3)},
                            {"fields", fields}}));
}

namespace {

using Numbering = std::function<std::uint32_t(Index vertex)>;

Json page_triangles(const std::vector<Triangle>& triangles, const Numbering& number) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (const Index v : t) corners.push_back(number(v));
  return page_array("u32", corners);
}

Json page_regions(const Model& model, const BodySurface& surface) {
  std::vector<std::uint16_t> regions;  // 65535: none
  for (const Index element : surface.elements)
    regions.push_back(static_cast<std::uint16_t>(element < 0 ? -1 : role_of(model, element).region));
  return page_array("u16", regions);
}

Json page_line(const std::vector<EmbeddedPoint>& embedded, const Numbering& number) {
  Json points = Json::array();
  for (const EmbeddedPoint& point : embedded) {
    Json vertices = Json::array();
    for (const Index v : point.vertices) vertices.push_back(number(v));
    points.push_back({{"vertices", vertices}, {"weights", point.weights}});
  }
  return points;
}

Json page_fibres(const std::vector<std::vector<EmbeddedPoint>>& lines, const Numbering& number) {
  Json list = Json::array();
  for (const std::vector<EmbeddedPoint>& line : lines) {
    Json points = page_line(line, number);
    for (Json& point : points)
      for (Json& weight : point["weights"]) weight = std::round(1e4 * weight.get<double>()) / 1e4;
    list.push_back({{"points", std::move(points)}});
  }
  return list;
}

Json page_cables(const Model& model, const Numbering& number) {
  Json list = Json::array();
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    if (const auto* cable = model.actuators[a].as<CableDrive>())
      list.push_back({{"actuator", a}, {"points", page_line(cable->points, number)}});
  }
  return list;
}

/// What stands around the robot, and bodies, which move with the vertices.
void add_what_is_around(const Model& model, const Points& positions, const Bounds& drawn, const Numbering& number,
                        Json& document) {
  document["obstacles"] = Json::array();
  if (const auto layer = obstacle_layer(model, positions, drawn))
    document["obstacles"].push_back({{"points", page_points(layer->points)},
                                     {"triangles", page_triangles(layer->triangles, [](Index v) { return v; })}});
  std::vector<Triangle> bodies;
  for (std::size_t t = 0; t < model.contact.triangles.size(); ++t)
    if (is_body(model, t)) bodies.push_back(model.contact.triangles[t]);
  if (!bodies.empty()) document["bodies"] = {{"triangles", page_triangles(bodies, number)}};
}

Json page_map(const MapData& map, const Model& model, const std::vector<Index>& vertices) {
  Json json{{"inputs", inputs_table(map)},
            {"outputs", outputs_table(map)},
            {"markers", marker_names(map)},
            {"checked", checked_table(map)},
            {"tables", map_tables(map)}};
  if (!map.shape) return json;
  if (map.shape->mean.size() != model.rest.size()) throw InvalidInput("the map's shape is of another robot");
  json["shapeTables"] = shape_table(shape_at(*map.shape, vertices));
  return json;
}

}  // namespace

void PageDocument::show_reach(Index marker, const Points& positions) {
  for (Index i = 0; i < positions.rows(); ++i) drawn_.extend(vertex_at(positions, i));
  reach_ = line_of({{"marker", marker}, {"points", page_points(positions)}});
}

std::string PageDocument::map_text(const MapData& map) const {
  return line_of(page_map(map, model_, vertices_));
}

std::string PageDocument::text(const MapData* map) const {
  const Numbering numbering = [this](Index v) { return static_cast<std::uint32_t>(number(v)); };
  Json document{{"softkin", version()},
                {"command", command_},
                {"robot", model_.name},
                {"formulation", formulation_name(model_.formulation)},
                {"actuators", page_actuators(model_)},
                {"markers", page_markers(model_)},
                {"regions", model_.elements.region_names},
                {"surface",
                 {{"rest", page_array("f32", coordinates(model_.rest, vertices_))},
                  {"triangles", page_triangles(surface_.triangles, numbering)},
                  {"region", page_regions(model_, surface_)}}},
                {"cables", page_cables(model_, numbering)}};
  if (const auto lines = reinforcement_lines(model_); !lines.empty())
    document["fibres"] = page_fibres(lines, numbering);
  add_what_is_around(model_, last_, drawn_, numbering, document);
  document["map"] = map == nullptr ? Json() : page_map(*map, model_, vertices_);
  std::string text = line_of(document);
  text.pop_back();
  if (!reach_.empty()) text += ",\"workspace\":" + reach_;
  text += ",\"steps\":[";
  for (std::size_t s = 0; s < steps_.size(); ++s) text += (s == 0 ? "" : ",") + steps_[s];
  return text + "]}";
}

}  // namespace softkin::runs
