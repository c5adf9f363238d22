#include <algorithm>
#include <cstdio>
#include <memory>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/mesh_report.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/table.hpp>

#include "command.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t max_regions = 40, max_parts = 20, max_notes = 20, max_losses = 20;

const Column left{.left = true}, right;

struct MeshOptions {
  std::string input;   // a mesh; for check also a scene
  std::string output;  // convert
  std::string unit = "mm";
  bool json = false, ascii = false, may_replace = false;
};

std::string curved_text(const CurvedInfo& curved, const MeshMeasures& straight) {
  std::string text = "volume " + number(curved.measures.volume) + " mm^3 (" +
                     number(100 * (curved.measures.volume / straight.volume - 1), 3) + " % more than by the corners)" +
                     ", boundary area " + number(curved.measures.boundary) + " mm^2";
  if (curved.of == CurvedInfo::Of::mesh) return text;
  text += "; " + counted(curved.done.moved, "node") + " moved by up to " + number(curved.done.farthest_mm, 3) + " mm";
  if (curved.done.held_back > 0) text += ", " + std::to_string(curved.done.held_back) + " of them held back";
  return text;
}

Row region_row(const RegionMeasures& region) {
  Row row{printable(region.name), std::to_string(region.dimension) + "D", "",
          counted(region.vertices, "vertex", "vertices"), ""};
  if (region.dimension < 2) return row;
  row[2] = counted(region.cells, region.dimension == 3 ? "element" : "face");
  row[4] = number(region.measure) + (region.dimension == 3 ? " mm^3" : " mm^2");
  return row;
}

/// "" where there is none.
std::string text_of(const std::vector<EmptySpace>& spaces) {
  if (spaces.empty()) return "";
  std::vector<std::string> lines;
  for (const EmptySpace& space : spaces) lines.push_back(text_of(space));
  return counted(spaces.size(), "empty space") + " that the elements enclose\n" + joined(cut(lines, max_parts), "    ");
}

std::string text_of(const MeshInfo& info) {
  const MeshMeasures& m = info.measures;
  const Vec3 size = m.high - m.low;
  Table table{
      {left, left},
      {{"file", info.file + (is_scene(info.file) ? " (the mesh of the scene)"
                                                 : " (" + mesh_form(info.file) + ", lengths in " + info.unit + ")")},
       {"vertices", std::to_string(m.vertices)},
       {"elements",
        tetrahedra_text(m.tetrahedra, m.order) + ", " + counted(m.prisms, "prism") + " in " + counted(m.parts, "part")},
       {"surface cells", counted(m.triangles, "triangle") + ", " + counted(m.quads, "quad")},
       {"bounding box", point_text(m.low) + " mm to " + point_text(m.high) + " mm"},
       {"size", number(size[0]) + " x " + number(size[1]) + " x " + number(size[2]) + " mm"},
       {"volume", number(m.volume) + " mm^3"},
       {"boundary area", number(m.boundary) + " mm^2"},
       {"quality", "min " + number(m.quality[0], 3) + ", 1st percentile " + number(m.quality[1], 3) + ", median " +
                       number(m.quality[2], 3) + " (1: regular, 0: flat)"},
       {"edge lengths", "min " + number(m.edge_length[0], 4) + ", median " + number(m.edge_length[1], 4) + ", max " +
                            number(m.edge_length[2], 4) + " mm"},
       {"regions", std::to_string(m.regions.size())}}};
  constexpr const char* curved_names[] = {"curved edges", "with 'curve'", "'curve: true'"};
  if (info.curved)
    table.rows.insert(table.rows.end() - 1,
                      {curved_names[static_cast<std::size_t>(info.curved->of)], curved_text(*info.curved, m)});
  Table regions{{left, left, right, right, right}};
  for (const RegionMeasures& region : m.regions) regions.rows.push_back(region_row(region));
  const std::string none = m.regions.empty() ? "  none: the file names no part of the mesh; a scene can define some by "
                                               "shapes (docs/scene.md, regions)\n"
                                             : "";
  return joined(table.body(), "") + none + joined(cut(regions.body(), max_regions), "  ") + text_of(info.empty_spaces);
}

std::string text_of(const std::vector<MeshFinding>& findings) {
  Table table{{left, left, right, left}};
  for (const MeshFinding& finding : findings)
    table.rows.push_back({finding.count == 0 ? "ok" : name_of(finding.severity), words_of(finding),
                          static_cast<std::int64_t>(finding.count), finding.count == 0 ? "" : finding.meaning});
  const std::vector<std::string> lines = table.body();
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += lines[i] + "\n";
    for (const MeshPlace& place : findings[i].first) text += "    " + text_of(place) + "\n";
    const std::size_t more = findings[i].count - findings[i].first.size();
    if (more > 0) text += "    ... and " + std::to_string(more) + " more\n";
  }
  return text;
}

std::string parts_text(const MeshVerdict& verdict) {
  Table table{{right, right, left}};
  for (const PartMeasures& part : verdict.parts)
    table.rows.push_back({counted(part.vertices, "vertex", "vertices"), number(part.volume) + " mm^3",
                          "centroid " + point_text(part.centroid) + " mm"});
  const char* hint = verdict.scene               ? ""
                     : verdict.parts.size() == 1 ? ": a scene must hold it"
                                                 : ": a scene must hold each";
  return counted(verdict.parts.size(), "part") + " connected through elements" + hint + "\n" +
         joined(cut(table.body(), max_parts), "    ");
}

std::string text_of(const SceneVerdict& scene) {
  if (scene.error) return "scene refused: " + *scene.error + "\n";
  std::string text = "scene compiles";
  if (!scene.warnings.empty()) text += ", but warns:\n" + joined(scene.warnings, "    ");
  if (scene.notes.empty()) return scene.warnings.empty() ? text + "\n" : text;
  return text + (scene.warnings.empty() ? ", and" : "it") + " notes:\n" + joined(cut(scene.notes, max_notes), "    ");
}

std::string judgement(const MeshVerdict& verdict) {
  std::string errors = verdict.scene && verdict.scene->error ? "the scene is refused" : verdict.no_volume, warnings;
  for (const MeshFinding& finding : verdict.findings) {
    if (finding.count == 0 || finding.severity == MeshSeverity::remark) continue;
    std::string& text = finding.severity == MeshSeverity::error ? errors : warnings;
    text += (text.empty() ? "" : ", ") + words_of(finding) + " (" + std::to_string(finding.count) + ")";
  }
  if (!errors.empty() && verdict.errors_accepted())
    return "usable, since the scene accepts errors: " + errors + (warnings.empty() ? "" : ", " + warnings) + "\n";
  if (!errors.empty()) return "not usable: " + errors + "\n";
  return "usable" + (warnings.empty() ? "" : ", but look at: " + warnings) + "\n";
}

std::string text_of(const MeshVerdict& verdict) {
  return verdict.file + ": " + counted(verdict.vertices, "vertex", "vertices") + ", " +
         tetrahedra_text(verdict.tetrahedra, verdict.order) + ", " + counted(verdict.prisms, "prism") +
         ", each numbered from 0\n" + text_of(verdict.findings) + parts_text(verdict) + text_of(verdict.empty_spaces) +
         (verdict.scene ? text_of(*verdict.scene) : "") + judgement(verdict);
}

std::string text_of(const MeshConversion& result) {
  std::string text = "wrote " + result.output + " (" + mesh_form(result.output) +
                     "): " + counted(result.vertices, "vertex", "vertices");
  if (result.facets > 0)
    text += ", " + counted(result.facets, "facet") + " of the boundary\n";
  else
    text += ", " + tetrahedra_text(result.tetrahedra, result.order) + ", " + counted(result.prisms, "prism") + ", " +
            counted(result.regions.size(), "region") + "\n";
  if (result.not_kept.empty()) return text;
  return text + "not kept:\n" + joined(cut(result.not_kept, max_losses), "    ");
}

template <class Result>
void show(const Result& result, const MeshOptions& options) {
  print(options.json ? to_json(result) + "\n" : text_of(result));
  for (const std::string& warning : result.warnings) std::fprintf(stderr, "softkin: warning: %s\n", warning.c_str());
}

int run_info(const MeshOptions& options) {
  show(mesh_info(options.input, options.unit), options);
  return done;
}

int run_check(const MeshOptions& options) {
  const MeshVerdict verdict = mesh_verdict(options.input, options.unit);
  show(verdict, options);
  return verdict.usable() ? done : not_converged;  // 1: not what was hoped for, yet the input could be read
}

int run_convert(const MeshOptions& options) {
  check_outputs({{"OUT", options.output}}, {options.input}, options.may_replace);
  show(convert_mesh(options.input, options.output, options.ascii), options);
  return done;
}

void add_unit(CLI::App& command, MeshOptions& options) {
  add_value(command, "--unit", options.unit, "UNIT", "Unit of the file's lengths: mm, cm, m, um, in (default: mm)",
            CLI::IsMember(length_units()).description(""));
}

void add_json(CLI::App& command, MeshOptions& options) {
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void refuse_unit_of_scene(const CLI::App& command, const MeshOptions& options) {
  if (is_scene(options.input) && command.count("--unit") > 0)
    throw CLI::ValidationError("--unit", "a scene names its own unit");
}

void add_info(CLI::App& mesh, Run& run) {
  const auto options = std::make_shared<MeshOptions>();
  CLI::App& command = *mesh.add_subcommand("info", "Counts, regions, size, volume, quality and edge lengths of a mesh");
  command.add_option("MESH", options->input, "Mesh: .msh .vtk .vtu .mesh .node .ele .inp .tet, or a scene: .yaml")
      ->type_name("")
      ->required();
  add_unit(command, *options);
  add_json(command, *options);
  command.footer(
      "Box, volume and area are those of the elements, reversed ones included; volume, area, quality and edge lengths "
      "of order 2 are those of the corners.\n"
      "Example:\n  softkin mesh info finger.msh --unit cm");
  command.callback([&run, &command, options] {
    refuse_unit_of_scene(command, *options);
    run = [options] { return run_info(*options); };
  });
}

void check_check(const CLI::App& command, MeshOptions& options, const std::string& scene) {
  if (options.input.empty() == scene.empty())
    throw CLI::ValidationError("MESH, --scene", "give one of the two; a scene names its mesh");
  if (!scene.empty() && !is_scene(scene))
    throw CLI::ValidationError("--scene", "a scene is a .yaml file, not " + scene);
  if (options.input.empty()) options.input = scene;
  refuse_unit_of_scene(command, options);
}

void add_check(CLI::App& mesh, Run& run) {
  const auto options = std::make_shared<MeshOptions>();
  const auto scene = std::make_shared<std::string>();
  CLI::App& command =
      *mesh.add_subcommand("check", "What is wrong with a mesh: elements, faces, vertices, loose parts");
  add_value(command, "MESH", options->input, "", "Mesh: .msh .vtk .vtu .mesh .node .ele .inp .tet; or a scene: .yaml");
  add_value(command, "--scene", *scene, "SCENE",
            "Scene in place of MESH: its mesh, and whether the scene holds every part of it");
  add_unit(command, *options);
  add_json(command, *options);
  command.footer(
      "Vertices, tetrahedra and prisms count from 0 each. Exit code: 0 usable, 1 not usable, 2 bad usage or bad "
      "input.\n"
      "Examples:\n  softkin mesh check finger.msh\n  softkin mesh check finger.yaml --json");
  command.callback([&run, &command, options, scene] {
    check_check(command, *options, *scene);
    run = [options] { return run_check(*options); };
  });
}

void add_convert(CLI::App& mesh, Run& run) {
  const auto options = std::make_shared<MeshOptions>();
  CLI::App& command = *mesh.add_subcommand("convert", "Write a mesh in another form; lengths stay as they are");
  command.add_option("IN", options->input, "Mesh: .msh .vtk .vtu .mesh .node .ele .inp .tet")
      ->type_name("")
      ->required();
  command
      .add_option("OUT", options->output, "File to write: .msh (all regions), .vtu (volume regions), .stl (boundary)")
      ->type_name("")
      ->required();
  command.add_flag("--ascii", options->ascii, "Write a .msh as text");
  add_overwriting(command, options->may_replace);
  add_json(command, *options);
  command.footer("Example:\n  softkin mesh convert finger.inp finger.msh --ascii");
  command.callback([&run, options] {
    if (options->ascii && lower_extension(options->output) != ".msh")
      throw CLI::ValidationError("--ascii", "only a .msh can be written as text, not " + options->output);
    run = [options] { return run_convert(*options); };
  });
}

}  // namespace

void add_mesh(CLI::App& app, Run& run) {
  CLI::App& mesh = *app.add_subcommand("mesh", "Look at a mesh, check it, convert it");
  mesh.require_subcommand(0, 1);  // "1" would hide the name of one that does not exist
  mesh.callback([&mesh] {
    if (mesh.get_subcommands().empty()) throw CLI::RequiredError("a subcommand of mesh (info, check, convert)");
  });
  mesh.footer("Example:\n  softkin mesh check finger.msh");
  add_info(mesh, run);
  add_check(mesh, run);
  add_convert(mesh, run);
}

}  // namespace softkin::cli
