#include <algorithm>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/mesh_report.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/scene.hpp>
#include <softkin/model/compile/curving.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

namespace {

constexpr double largest_coordinate = 1e60;  // [mm]; its cube, times any number of elements, is a finite number

void refuse_huge(const Mesh& mesh, const std::string& file) {
  if (!(mesh.vertices.cwiseAbs().maxCoeff() <= largest_coordinate))
    throw InvalidInput({file}, "the mesh's coordinates are too large: above 1e60 mm");
}

Mesh read_mesh_in_mm(const std::string& file, const std::string& unit) {
  Mesh mesh = read_mesh(file);
  mesh.vertices *= mm_per(unit);
  refuse_huge(mesh, file);
  return mesh;
}

/// Regions that stand in files of their own, of which there is none, are lost without a word in the mesh's file.
std::vector<std::string> warnings_of(const Mesh& mesh) {
  return mesh.no_sidecars ? mesh.missing : std::vector<std::string>{};
}

MeshVerdict verdict_of(const Mesh& mesh, const std::string& file) {
  const MeshCheck check = check_mesh(mesh);
  return {file,
          order_of(mesh),
          static_cast<std::size_t>(mesh.vertices.rows()),
          mesh.tetrahedra.size(),
          mesh.prisms.size(),
          findings_of(mesh, check),
          measure_parts(mesh, check),
          {},
          std::nullopt,
          warnings_of(mesh)};
}

/// Adds the verdict of compile() on the scene, and the empty spaces of its body, or of the mesh where it is refused.
void judge_scene(const RobotSpec& spec, MeshVerdict& verdict) {
  try {
    Model model = compile(spec);
    verdict.empty_spaces = empty_spaces_in(model.rest, model.elements.tetrahedra, model.elements.prisms);
    verdict.scene = {std::move(model.warnings), std::move(model.notes), std::nullopt, spec.mesh_options.accept_errors};
  } catch (const InvalidInput& error) {
    verdict.scene = {{}, {}, error.what(), spec.mesh_options.accept_errors};
    verdict.empty_spaces = empty_spaces_in(spec.mesh.vertices, spec.mesh.tetrahedra, spec.mesh.prisms);
  }
}

std::size_t cells_of(const Region& region) {
  return region.tetrahedra.size() + region.prisms.size() + region.triangles.size() + region.quads.size();
}

std::string size_text(const Region& region) {
  if (region.dimension == 3) return counted(cells_of(region), "element");
  if (region.dimension == 2) return counted(cells_of(region), "face");
  return counted(region.vertices.size(), "vertex", "vertices");
}

/// How a region fared, or "".
std::string loss_of(const Region& region, const std::vector<Region>& written) {
  const std::string label =
      "region '" + printable(region.name) + "' (" + std::to_string(region.dimension) + "D, " + size_text(region) + ")";
  const auto found =
      std::find_if(written.begin(), written.end(), [&](const Region& other) { return other.name == region.name; });
  if (found == written.end()) return label;
  if (found->dimension != region.dimension) return label + " is now " + std::to_string(found->dimension) + "D";
  if (cells_of(*found) != cells_of(region) || found->vertices.size() != region.vertices.size())
    return label + " but for " + size_text(*found);
  return "";
}

void review_mesh(const Mesh& mesh, MeshConversion& result) {
  const Mesh written = read_mesh(result.output);
  result.vertices = written.vertices.rows();
  result.order = order_of(written);
  result.tetrahedra = written.tetrahedra.size();
  result.prisms = written.prisms.size();
  for (const Region& region : written.regions) result.regions.push_back(region.name);
  for (const Region& region : mesh.regions)
    if (std::string loss = loss_of(region, written.regions); !loss.empty()) result.not_kept.push_back(std::move(loss));
}

void review_surface(const Mesh& mesh, MeshConversion& result) {
  const TriangleSurface written = read_stl(result.output);
  result.vertices = written.vertices.rows();
  result.facets = written.triangles.size();
  result.not_kept = {"the elements: " + tetrahedra_text(mesh.tetrahedra.size(), order_of(mesh)) + ", " +
                         counted(mesh.prisms.size(), "prism"),
                     "digits of the coordinates beyond single precision"};
  for (const Region& region : mesh.regions) result.not_kept.push_back(loss_of(region, {}));
}

std::optional<CurvedInfo> curved_info(RobotSpec& spec) {
  Mesh& mesh = spec.mesh;
  if (mesh.tetrahedra.empty() || !mesh.prisms.empty()) return std::nullopt;
  const bool quadratic = !mesh.edge_nodes.empty();
  if (quadratic && !has_straight_edges(mesh)) return CurvedInfo{CurvedInfo::Of::mesh, {}, measure_curved(mesh)};
  const auto of = spec.mesh_options.curve ? CurvedInfo::Of::scene : CurvedInfo::Of::smooth;
  if (!spec.mesh_options.curve) spec.mesh_options.curve.emplace().smooth = true;
  Mesh curved = elevated(quadratic ? lowered(mesh) : mesh);
  std::vector<std::string> notes;
  const CurvedEdges done = curve_mesh(spec, curved, notes);
  if (done.moved == 0) return std::nullopt;
  return CurvedInfo{of, done, measure_curved(curved)};
}

Json curved_json(const CurvedInfo& info) {
  constexpr const char* names[] = {"mesh", "scene", "smooth"};
  Json json{{"of", names[static_cast<std::size_t>(info.of)]},
            {"volume_mm3", info.measures.volume},
            {"boundary_area_mm2", info.measures.boundary}};
  if (info.of == CurvedInfo::Of::mesh) return json;
  json["nodes_moved"] = info.done.moved;
  json["nodes_held_back"] = info.done.held_back;
  json["farthest_mm"] = info.done.farthest_mm;
  return json;
}

Json region_json(const RegionMeasures& region) {
  Json json{{"name", region.name}, {"dimension", region.dimension}, {"vertices", region.vertices}};
  if (region.dimension < 2) return json;
  json[region.dimension == 3 ? "elements" : "faces"] = region.cells;
  json[region.dimension == 3 ? "volume_mm3" : "area_mm2"] = region.measure;
  return json;
}

Json finding_json(const MeshFinding& finding) {
  Json first = Json::array();
  for (const MeshPlace& place : finding.first) {
    Json& json = first.emplace_back();
    if (!place.tetrahedra.empty()) json["tetrahedra"] = place.tetrahedra;
    if (!place.prisms.empty()) json["prisms"] = place.prisms;
    if (!place.vertices.empty()) json["vertices"] = place.vertices;
    json["position_mm"] = json_of(place.position);
  }
  return {{"kind", finding.kind},
          {"severity", name_of(finding.severity)},
          {"count", finding.count},
          {"meaning", finding.meaning},
          {"first", first}};
}

Json spaces_json(const std::vector<EmptySpace>& spaces) {
  Json json = Json::array();
  for (const EmptySpace& space : spaces)
    json.push_back(
        {{"volume_mm3", space.volume}, {"faces", space.triangles.size()}, {"center_mm", json_of(space.center)}});
  return json;
}

}  // namespace

bool is_scene(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".yaml" || extension == ".yml";
}

MeshInfo mesh_info(const std::string& file, const std::string& unit) {
  RobotSpec spec;
  if (is_scene(file))
    spec = read_scene(file);
  else
    spec.mesh = read_mesh_in_mm(file, unit);
  const Mesh& mesh = spec.mesh;
  MeshInfo info{file, unit, measure_mesh(mesh, check_mesh(mesh)),
                empty_spaces_in(mesh.vertices, mesh.tetrahedra, mesh.prisms)};
  info.warnings = warnings_of(mesh);
  if (std::string missing = missing_volume(mesh); !missing.empty() && !is_scene(file))
    info.warnings.push_back(file + ": " + missing);
  info.curved = curved_info(spec);
  return info;
}

bool MeshVerdict::usable() const {
  const bool blocked = std::any_of(findings.begin(), findings.end(), [](const MeshFinding& finding) {
    return finding.severity == MeshSeverity::error && finding.count > 0;
  });
  return no_volume.empty() && (!blocked || errors_accepted()) && !(scene && scene->error);
}

bool MeshVerdict::errors_accepted() const {
  return scene && !scene->error && scene->accepts_errors;
}

MeshVerdict mesh_verdict(const std::string& file, const std::string& unit) {
  if (!is_scene(file)) {
    const Mesh mesh = read_mesh_in_mm(file, unit);
    MeshVerdict verdict = verdict_of(mesh, file);
    verdict.no_volume = missing_volume(mesh);
    verdict.empty_spaces = empty_spaces_in(mesh.vertices, mesh.tetrahedra, mesh.prisms);
    return verdict;
  }
  const RobotSpec spec = read_scene(file);
  refuse_huge(spec.mesh, file);
  MeshVerdict verdict = verdict_of(spec.mesh, file);
  judge_scene(spec, verdict);
  return verdict;
}

MeshConversion convert_mesh(const std::string& input, const std::string& output, bool ascii) {
  const Mesh mesh = read_mesh(input);
  if (ascii)
    write_gmsh(output, mesh, false);
  else
    write_mesh(output, mesh);
  MeshConversion result{input, output};
  result.warnings = warnings_of(mesh);
  if (lower_extension(output) == ".stl")
    review_surface(mesh, result);
  else
    review_mesh(mesh, result);
  return result;
}

std::string tetrahedra_text(std::size_t count, int order) {
  return counted(count, "tetrahedron", "tetrahedra") + (order == 2 ? " of order 2" : "");
}

const char* name_of(MeshSeverity severity) {
  constexpr const char* names[] = {"remark", "warning", "error"};
  return names[static_cast<std::size_t>(severity)];
}

std::string to_json(const MeshInfo& info) {
  const MeshMeasures& m = info.measures;
  Json regions = Json::array();
  for (std::size_t r = 0; r < m.regions.size(); ++r) {
    Json& region = regions.emplace_back(region_json(m.regions[r]));
    if (info.curved && info.curved->measures.regions[r] > 0)
      region[m.regions[r].dimension == 3 ? "curved_volume_mm3" : "curved_area_mm2"] = info.curved->measures.regions[r];
  }
  Json json = {
      {"file", info.file},
      {"form", is_scene(info.file) ? "scene" : mesh_form(info.file)},
      {"unit", info.unit},
      {"vertices", m.vertices},
      {"order", m.order},
      {"tetrahedra", m.tetrahedra},
      {"prisms", m.prisms},
      {"parts", m.parts},
      {"surface_cells", {{"triangles", m.triangles}, {"quads", m.quads}}},
      {"bounding_box_mm", {{"low", json_of(m.low)}, {"high", json_of(m.high)}}},
      {"size_mm", json_of(Vec3(m.high - m.low))},
      {"volume_mm3", m.volume},
      {"boundary_area_mm2", m.boundary},
      {"curved", info.curved ? curved_json(*info.curved) : Json(nullptr)},
      {"quality", {{"min", m.quality[0]}, {"percentile_1", m.quality[1]}, {"median", m.quality[2]}}},
      {"edge_lengths_mm", {{"min", m.edge_length[0]}, {"median", m.edge_length[1]}, {"max", m.edge_length[2]}}},
      {"empty_spaces", spaces_json(info.empty_spaces)},
      {"regions", regions}};
  if (!info.warnings.empty()) json["warnings"] = info.warnings;
  return json_text(json);
}

std::string to_json(const MeshVerdict& verdict) {
  Json findings = Json::array(), parts = Json::array();
  for (const MeshFinding& finding : verdict.findings) findings.push_back(finding_json(finding));
  for (const PartMeasures& part : verdict.parts)
    parts.push_back(
        {{"vertices", part.vertices}, {"volume_mm3", part.volume}, {"centroid_mm", json_of(part.centroid)}});
  Json json{{"file", verdict.file},     {"vertices", verdict.vertices},
            {"order", verdict.order},   {"tetrahedra", verdict.tetrahedra},
            {"prisms", verdict.prisms}, {"findings", findings},
            {"parts", parts},           {"empty_spaces", spaces_json(verdict.empty_spaces)}};
  if (verdict.scene) {
    json["scene"]["warnings"] = verdict.scene->warnings;
    json["scene"]["notes"] = verdict.scene->notes;
    json["scene"]["error"] = verdict.scene->error ? Json(*verdict.scene->error) : Json(nullptr);
  }
  if (!verdict.no_volume.empty()) json["no_volume"] = verdict.no_volume;
  json["usable"] = verdict.usable();
  if (!verdict.warnings.empty()) json["warnings"] = verdict.warnings;
  return json_text(json);
}

std::string to_json(const MeshConversion& result) {
  Json json{{"input", result.input},       {"output", result.output},         {"form", mesh_form(result.output)},
            {"vertices", result.vertices}, {"tetrahedra", result.tetrahedra}, {"prisms", result.prisms}};
  if (result.facets > 0)
    json["facets"] = result.facets;
  else
    json["order"] = result.order;
  json["regions"] = result.regions;
  json["not_kept"] = result.not_kept;
  if (!result.warnings.empty()) json["warnings"] = result.warnings;
  return json_text(json);
}

}  // namespace softkin
