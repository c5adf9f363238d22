#include "mesh_command.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <memory>
#include <softkin/io/mesh/length_unit.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>

#include "command.hpp"

namespace softkin::cli {

namespace {

constexpr double largest_coordinate = 1e60;  // [mm]; its cube, times any number of elements, is a finite number

using Shared = std::shared_ptr<MeshOptions>;

void add_unit(CLI::App& command, MeshOptions& options) {
  command.add_option("--unit", options.unit, "Unit of the file's lengths: mm, cm, m, um, in (default: mm)")
      ->type_name("UNIT")
      ->check(CLI::IsMember(length_units()).description(""));
}

void add_json(CLI::App& command, MeshOptions& options) {
  command.add_flag("--json", options.json, "Print JSON; its keys name the units");
}

void add_info(CLI::App& mesh, Run& run) {
  const auto options = std::make_shared<MeshOptions>();
  CLI::App& command = *mesh.add_subcommand("info", "Counts, regions, size, volume, quality and edge lengths of a mesh");
  command.add_option("MESH", options->input, "Mesh: .msh .vtk .vtu .mesh .node .ele .inp .tet")
      ->type_name("")
      ->required();
  add_unit(command, *options);
  add_json(command, *options);
  command.footer(
      "Box, volume and area are those of the elements, reversed ones included; volume, area, quality and edge lengths "
      "of order 2 are those of the corners.\n"
      "Example:\n  softkin mesh info finger.msh --unit cm");
  command.callback([&run, options] { run = [options] { return mesh_info(*options); }; });
}

void check_check(const CLI::App& command, MeshOptions& options, const std::string& scene) {
  if (options.input.empty() == scene.empty())
    throw CLI::ValidationError("MESH, --scene", "give one of the two; a scene names its mesh");
  if (!scene.empty() && !is_scene(scene))
    throw CLI::ValidationError("--scene", "a scene is a .yaml file, not " + scene);
  if (options.input.empty()) options.input = scene;
  if (is_scene(options.input) && command.count("--unit") > 0)
    throw CLI::ValidationError("--unit", "a scene names its own unit");
}

void add_check(CLI::App& mesh, Run& run) {
  const auto options = std::make_shared<MeshOptions>();
  const auto scene = std::make_shared<std::string>();
  CLI::App& command =
      *mesh.add_subcommand("check", "What is wrong with a mesh: elements, faces, vertices, loose parts");
  command.add_option("MESH", options->input, "Mesh: .msh .vtk .vtu .mesh .node .ele .inp .tet; or a scene: .yaml")
      ->type_name("");
  command
      .add_option("--scene", *scene, "Scene in place of MESH: its mesh, and whether the scene holds every part of it")
      ->type_name("SCENE");
  add_unit(command, *options);
  add_json(command, *options);
  command.footer(
      "Vertices, tetrahedra and prisms count from 0 each. Exit code: 0 usable, 1 not usable, 2 bad usage or bad "
      "input.\n"
      "Examples:\n  softkin mesh check finger.msh\n  softkin mesh check finger.yaml --json");
  command.callback([&run, &command, options, scene] {
    check_check(command, *options, *scene);
    run = [options] { return mesh_check(*options); };
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
  add_json(command, *options);
  command.footer("A file OUT that exists is replaced.\nExample:\n  softkin mesh convert finger.inp finger.msh --ascii");
  command.callback([&run, options] {
    if (options->ascii && lower_extension(options->output) != ".msh")
      throw CLI::ValidationError("--ascii", "only a .msh can be written as text, not " + options->output);
    run = [options] { return mesh_convert(*options); };
  });
}

}  // namespace

bool is_scene(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".yaml" || extension == ".yml";
}

void refuse_huge(const Mesh& mesh, const std::string& file) {
  if (!(mesh.vertices.cwiseAbs().maxCoeff() <= largest_coordinate))
    throw InvalidInput({file}, "the mesh's coordinates are too large: above 1e60 mm");
}

Mesh read_mesh_in_mm(const MeshOptions& options) {
  Mesh mesh = read_mesh(options.input);
  mesh.vertices *= mm_per(options.unit);
  refuse_huge(mesh, options.input);
  return mesh;
}

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
