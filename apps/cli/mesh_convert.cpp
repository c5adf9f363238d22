#include <algorithm>
#include <softkin/io/mesh/gmsh.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/io/mesh/stl.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>

#include "command.hpp"
#include "mesh_command.hpp"
#include "mesh_measures.hpp"
#include "mesh_text.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t most_losses = 20;

struct Conversion {
  int order = 1;
  std::size_t vertices = 0, tetrahedra = 0, prisms = 0, facets = 0;
  std::vector<std::string> regions, not_kept;
};

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

/// What the file holds is read from the file, not from what was meant to be written.
Conversion review_mesh(const Mesh& mesh, const std::string& file) {
  const Mesh written = read_mesh(file);
  Conversion result;
  result.vertices = static_cast<std::size_t>(written.vertices.rows());
  result.order = order_of(written);
  result.tetrahedra = written.tetrahedra.size();
  result.prisms = written.prisms.size();
  for (const Region& region : written.regions) result.regions.push_back(region.name);
  for (const Region& region : mesh.regions) {
    const std::string loss = loss_of(region, written.regions);
    if (!loss.empty()) result.not_kept.push_back(loss);
  }
  return result;
}

Conversion review_surface(const Mesh& mesh, const std::string& file) {
  const TriangleSurface written = read_stl(file);
  Conversion result;
  result.vertices = static_cast<std::size_t>(written.vertices.rows());
  result.facets = written.triangles.size();
  result.not_kept = {"the elements: " + tetrahedra_text(mesh.tetrahedra.size(), order_of(mesh)) + ", " +
                         counted(mesh.prisms.size(), "prism"),
                     "digits of the coordinates beyond single precision"};
  for (const Region& region : mesh.regions) result.not_kept.push_back(loss_of(region, {}));
  return result;
}

std::string conversion_text(const MeshOptions& options, const Conversion& result) {
  std::string text = "wrote " + options.output + " (" + mesh_form(options.output) +
                     "): " + counted(result.vertices, "vertex", "vertices");
  if (result.facets > 0)
    text += ", " + counted(result.facets, "facet") + " of the boundary\n";
  else
    text += ", " + tetrahedra_text(result.tetrahedra, result.order) + ", " + counted(result.prisms, "prism") + ", " +
            counted(result.regions.size(), "region") + "\n";
  if (result.not_kept.empty()) return text;
  return text + "not kept:\n" + joined(cut(result.not_kept, most_losses), "    ");
}

Json conversion_json(const MeshOptions& options, const Conversion& result) {
  Json json{{"input", options.input},      {"output", options.output},        {"form", mesh_form(options.output)},
            {"vertices", result.vertices}, {"tetrahedra", result.tetrahedra}, {"prisms", result.prisms}};
  if (result.facets > 0)
    json["facets"] = result.facets;
  else
    json["order"] = result.order;
  json["regions"] = result.regions;
  json["not_kept"] = result.not_kept;
  return json;
}

}  // namespace

int mesh_convert(const MeshOptions& options) {
  const Mesh mesh = read_mesh(options.input);
  if (options.ascii)
    write_gmsh(options.output, mesh, false);
  else
    write_mesh(options.output, mesh);
  const bool surface = lower_extension(options.output) == ".stl";
  const Conversion result = surface ? review_surface(mesh, options.output) : review_mesh(mesh, options.output);
  if (options.json)
    print(conversion_json(options, result));
  else
    print(conversion_text(options, result));
  return done;
}

}  // namespace softkin::cli
