#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <softkin/core/error.hpp>
#include <softkin/runs/map_file.hpp>
#include <softkin/runs/page.hpp>

#include "bindings.hpp"
#include "robot.hpp"

namespace softkin::python {

namespace nb = nanobind;

namespace {

/// The page of a robot with these shapes as its steps, and a map to bend it by.
std::string page_of(const RobotPtr& robot, const std::vector<ShapePtr>& shapes, const MapPtr& map,
                    const std::string& command) {
  const nb::gil_scoped_release released;
  if (!runs::page_is_there()) throw InvalidInput(runs::no_page);
  if (map) runs::check_robot(map->map.data(), robot->model(), map->name);
  if (map && !map->map.data().shape) throw InvalidInput(map->name + ": the map has no shape to bend");
  runs::PageDocument document(robot->model(), command);
  for (const ShapePtr& shape : shapes) {
    if (shape->robot() != robot) throw InvalidInput("shapes: one is of another robot");
    document.add(shape->record(), shape->positions(), shape->deformation());
  }
  return runs::page_html(runs::embedded_page(), document.text(map ? &map->map.data() : nullptr));
}

}  // namespace

void bind_page(nb::module_& module) {
  module.def("page", page_of, nb::arg("robot"), nb::arg("shapes"), nb::arg("map").none(), nb::arg("command"));
}

}  // namespace softkin::python
