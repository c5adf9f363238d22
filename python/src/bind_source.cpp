#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/changes.hpp>
#include <softkin/io/scene/scene_file.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "source.hpp"

namespace softkin::python {

namespace {

using scene::Node;

/// Dicts, lists, words, numbers and truths as a scene's tree; `path` is where a value stands, for messages.
std::shared_ptr<Node> node_of(nb::handle value, const std::string& path, const std::string& name) {
  auto node = std::make_shared<Node>();
  node->origin.file = path;
  node->name = name;
  if (nb::isinstance<nb::dict>(value)) {
    node->kind = Node::Kind::map;
    for (const auto& [key, item] : nb::borrow<nb::dict>(value)) {
      const std::string word = nb::cast<std::string>(key);
      const std::string below = path.empty() ? word : path + "." + word;
      node->entries.push_back({word, {below}, node_of(item, below, excerpt(word))});
    }
  } else if (nb::isinstance<nb::list>(value)) {
    node->kind = Node::Kind::list;
    for (const nb::handle item : nb::borrow<nb::list>(value)) {
      const std::string number = std::to_string(node->items.size());
      node->items.push_back(node_of(item, path + "[" + number + "]", "entry " + number + " of " + name));
    }
  } else {
    node->kind = Node::Kind::scalar;
    node->plain = !nb::isinstance<nb::str>(value);
    if (nb::isinstance<nb::bool_>(value))
      node->text = nb::cast<bool>(value) ? "true" : "false";
    else if (nb::isinstance<nb::float_>(value))
      node->text = exact(nb::cast<double>(value));
    else
      node->text = nb::cast<std::string>(nb::str(value));
  }
  return node;
}

template <std::size_t N>
std::vector<std::array<Index, N>> cells_of(const CellsIn& array) {
  std::vector<std::array<Index, N>> cells(array.shape(0));
  for (std::size_t i = 0; i < cells.size(); ++i) std::copy_n(array.data() + i * array.shape(1), N, cells[i].begin());
  return cells;
}

std::vector<Index> indices_of(const IndicesIn& array) {
  std::vector<Index> indices(array.data(), array.data() + array.shape(0));
  sort_unique(indices);
  return indices;
}

/// A mesh as it is made in memory. Arrays are checked by the Python layer: shapes, ranges of indices.
void bind_mesh(nb::module_& module) {
  nb::class_<Mesh>(module, "Mesh", "A volume mesh in memory, lengths in its own unit.")
      .def(
          "__init__",
          [](Mesh* self, const PointsIn& vertices, const CellsIn& tetrahedra, const CellsIn& prisms) {
            auto* mesh = new (self) Mesh();
            mesh->vertices = points_of(vertices);
            mesh->tetrahedra = cells_of<4>(tetrahedra);
            mesh->prisms = cells_of<6>(prisms);
            if (tetrahedra.shape(1) != 10) return;
            for (std::size_t i = 0; i < tetrahedra.shape(0); ++i)
              std::copy_n(tetrahedra.data() + 10 * i + 4, 6, mesh->edge_nodes.emplace_back().begin());
          },
          nb::arg("vertices"), nb::arg("tetrahedra"), nb::arg("prisms"))
      .def(
          "add_volume",
          [](Mesh& mesh, const std::string& name, const IndicesIn& tetrahedra, const IndicesIn& prisms) {
            mesh.regions.push_back({name, 3, indices_of(tetrahedra), indices_of(prisms), {}, {}, {}});
          },
          nb::arg("name"), nb::arg("tetrahedra"), nb::arg("prisms"))
      .def(
          "add_faces",
          [](Mesh& mesh, const std::string& name, const CellsIn& triangles) {
            Region region{name, 2, {}, {}, {}, {}, {}};
            for (const Triangle& triangle : cells_of<3>(triangles)) {
              region.triangles.push_back(mesh.triangles.size());
              mesh.triangles.push_back(triangle);
            }
            mesh.regions.push_back(std::move(region));
          },
          nb::arg("name"), nb::arg("triangles"))
      .def(
          "add_vertices",
          [](Mesh& mesh, const std::string& name, const IndicesIn& vertices) {
            mesh.regions.push_back({name, 0, {}, {}, {}, {}, indices_of(vertices)});
          },
          nb::arg("name"), nb::arg("vertices"));
}

}  // namespace

void bind_source(nb::module_& module) {
  bind_mesh(module);
  nb::class_<Source>(module, "Source", "What a robot is made of, as plain data.")
      .def_static(
          "of_scene",
          [](const std::string& path, const std::string& formulation, const std::vector<std::string>& forces,
             const std::vector<std::string>& changes) {
            auto tree = scene::parse_yaml(read_scene_file(path), path);
            for (const std::string& each : changes) tree = scene::changed(tree, "changes", each, "");
            return Source{path, tree, formulation, forces};
          },
          nb::arg("path"), nb::arg("formulation"), nb::arg("forces"), nb::arg("changes"))
      .def_static(
          "of_mesh",
          [](const std::string& name, const Mesh& mesh, nb::typed<nb::dict, nb::str, nb::object> description,
             const std::string& formulation, const std::vector<std::string>& forces) {
            nb::dict mesh_entry = nb::borrow<nb::dict>(description["mesh"]);
            mesh_entry["file"] = mesh_in_memory;
            auto tree = node_of(description, "", "the description");
            tree->origin.file = name;
            return Source{name, tree, formulation, forces, {.meshes = {{mesh_in_memory, mesh}}}};
          },
          nb::arg("name"), nb::arg("mesh"), nb::arg("description"), nb::arg("formulation"), nb::arg("forces"))
      .def_static(
          "unpickled",
          [](nb::bytes bytes) {
            return unpickled({bytes.c_str(), bytes.size()});
          },
          nb::arg("bytes"));
}

}  // namespace softkin::python
