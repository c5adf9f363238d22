#include <softkin/io/mesh/mesh_io.hpp>

#include "command.hpp"
#include "mesh_command.hpp"
#include "mesh_measures.hpp"
#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t most_regions = 40;

std::vector<std::string> region_row(const RegionMeasures& region) {
  const std::string dimension = std::to_string(region.dimension) + "D";
  const std::string vertices = counted(region.vertices, "vertex", "vertices");
  const std::string name = printable(region.name);
  if (region.dimension == 3)
    return {name, dimension, counted(region.cells, "element"), vertices, number(region.measure) + " mm^3"};
  if (region.dimension == 2)
    return {name, dimension, counted(region.cells, "face"), vertices, number(region.measure) + " mm^2"};
  return {name, dimension, "", vertices, ""};
}

std::string info_text(const MeshOptions& options, const MeshMeasures& m) {
  const Vec3 size = m.high - m.low;
  const std::vector<std::vector<std::string>> rows{
      {"file", options.input + " (" + mesh_form(options.input) + ", lengths in " + options.unit + ")"},
      {"vertices", std::to_string(m.vertices)},
      {"elements",
       tetrahedra_text(m.tetrahedra, m.order) + ", " + counted(m.prisms, "prism") + " in " + counted(m.parts, "part")},
      {"surface cells", counted(m.triangles, "triangle") + ", " + counted(m.quads, "quad")},
      {"bounding box", point_text(m.low) + " to " + point_text(m.high)},
      {"size", number(size[0]) + " x " + number(size[1]) + " x " + number(size[2]) + " mm"},
      {"volume", number(m.volume) + " mm^3"},
      {"boundary area", number(m.boundary) + " mm^2"},
      {"quality", "min " + number(m.quality[0], 3) + ", 1st percentile " + number(m.quality[1], 3) + ", median " +
                      number(m.quality[2], 3) + " (1: regular, 0: flat)"},
      {"edge lengths", "min " + number(m.edge_length[0], 4) + ", median " + number(m.edge_length[1], 4) + ", max " +
                           number(m.edge_length[2], 4) + " mm"},
      {"regions", std::to_string(m.regions.size())}};
  std::vector<std::vector<std::string>> regions;
  for (const RegionMeasures& region : m.regions) regions.push_back(region_row(region));
  return joined(aligned(rows, "ll"), "") + joined(cut(aligned(regions, "llrrr"), most_regions), "  ");
}

Json region_json(const RegionMeasures& region) {
  Json json{{"name", region.name}, {"dimension", region.dimension}, {"vertices", region.vertices}};
  if (region.dimension == 3) {
    json["elements"] = region.cells;
    json["volume_mm3"] = region.measure;
  } else if (region.dimension == 2) {
    json["faces"] = region.cells;
    json["area_mm2"] = region.measure;
  }
  return json;
}

Json info_json(const MeshOptions& options, const MeshMeasures& m) {
  Json regions = Json::array();
  for (const RegionMeasures& region : m.regions) regions.push_back(region_json(region));
  return {{"file", options.input},
          {"form", mesh_form(options.input)},
          {"unit", options.unit},
          {"vertices", m.vertices},
          {"order", m.order},
          {"tetrahedra", m.tetrahedra},
          {"prisms", m.prisms},
          {"parts", m.parts},
          {"surface_cells", {{"triangles", m.triangles}, {"quads", m.quads}}},
          {"bounding_box_mm", {{"low", point_json(m.low)}, {"high", point_json(m.high)}}},
          {"size_mm", point_json(m.high - m.low)},
          {"volume_mm3", m.volume},
          {"boundary_area_mm2", m.boundary},
          {"quality", {{"min", m.quality[0]}, {"percentile_1", m.quality[1]}, {"median", m.quality[2]}}},
          {"edge_lengths_mm", {{"min", m.edge_length[0]}, {"median", m.edge_length[1]}, {"max", m.edge_length[2]}}},
          {"regions", regions}};
}

}  // namespace

int mesh_info(const MeshOptions& options) {
  const Mesh mesh = read_mesh_in_mm(options);
  const MeshMeasures measures = measure_mesh(mesh, check_mesh(mesh));
  if (options.json)
    print(info_json(options, measures));
  else
    print(info_text(options, measures));
  return done;
}

}  // namespace softkin::cli
