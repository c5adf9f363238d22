#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/body_surface.hpp>
#include <softkin/runs/turns.hpp>

#include "bindings.hpp"
#include "convert.hpp"
#include "robot.hpp"

namespace softkin::python {

Index Robot::marker(const std::string& name) const {
  std::vector<std::string> names;
  for (const Marker& marker : model_.markers) names.push_back(marker.name);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return i;
  throw InvalidInput("no marker '" + name + "'" + (names.empty() ? "; the robot has none" : suggest_name(name, names)));
}

Index Robot::oriented_marker(const std::string& name) const {
  const Index found = marker(name);
  if (!runs::oriented_markers(model_)[static_cast<std::size_t>(found)])
    throw InvalidInput("marker '" + name +
                       "' is a point of the body, which has no orientation: give two markers, whose line turns, or one "
                       "that is a region");
  return found;
}

Index Robot::actuator(const std::string& name) const {
  if (const auto found = find_actuator(model_, name)) return *found;
  throw InvalidInput(unknown_actuator(model_, name));
}

namespace {

/// The elements of each region of the model, and the materials, as the solver has them.
std::vector<std::string> materials_of(const Model& model) {
  std::vector<std::string> names;
  for (const Material& material : model.elements.materials) names.push_back(material.region);
  return names;
}

template <class Of>
std::vector<Index> roles_of(const Model& model, const Of& of) {
  std::vector<Index> values;
  for (const ElementRole& role : model.elements.tetrahedron_roles) values.push_back(of(role));
  for (const ElementRole& role : model.elements.prism_roles) values.push_back(of(role));
  return values;
}

void bind_actuator(nb::module_& module) {
  nb::class_<Actuator>(module, "ActuatorInfo", "An actuator of a robot, as it is commanded.")
      .def_ro("name", &Actuator::name)
      .def_prop_ro(
          "kind", [](const Actuator& a) { return kind_name(a); },
          "'pneumatic', 'cable', 'dea', 'magnetic' or 'growth'; of surroundings 'motion', 'force' or 'hold', of a "
          "support 'turn'.")
      .def_prop_ro(
          "control", [](const Actuator& a) { return control_name(a); },
          "What is commanded: 'volume', 'length', 'area' (over that at rest), 'pressure', 'tension', 'voltage', "
          "'amount of gas', 'amount of liquid', 'pushed volume', "
          "'flux density', 'current', 'position', 'moment', 'stretch' or 'temperature'.")
      .def_prop_ro(
          "unit", [](const Actuator& a) { return command_unit(a); },
          "Of a command: 'kPa', 'N', 'kV', 'mL', 'mT', 'A', 'mm', 'A m^2' or 'deg'; '' for a ratio [-].")
      .def_prop_ro(
          "range", [](const Actuator& a) { return std::pair(a.low, a.high); }, "Of commands.")
      .def_ro("rest", &Actuator::rest, "The command where none is given.")
      .def_ro("rest_measure", &Actuator::rest_measure,
              "Length [mm], area [mm^2] or volume [mm^3] at rest; 1000 where a chamber is flat.")
      .def_prop_ro(
          "column", [](const Actuator& a) { return command_column(a); }, "Of tables: 'air', 'air_kPa'.")
      .def_prop_ro(
          "connected",
          [](const Actuator& a) {
            std::vector<std::string> regions;
            for (const ConnectedChamber& chamber : connected_chambers(a)) regions.push_back(chamber.region);
            return regions;
          },
          "Regions of chambers on one pipe; [] of others.")
      .def_prop_ro(
          "load_key", [](const Actuator& a) { return multiplier_key(a); },
          "'pressure_kPa', 'tension_N', 'voltage_kV' or ''.")
      .def(
          "command_text", [](const Actuator& a, double value) { return command_text(a, value); }, nb::arg("value"));
}

}  // namespace

void bind_robot(nb::module_& module) {
  bind_actuator(module);
  nb::class_<Robot>(module, "Robot", "A compiled robot; immutable.")
      .def(
          "__init__",
          [](Robot* self, const Source& source, bool read) {
            const nb::gil_scoped_release released;
            new (self) Robot(source, read);
          },
          nb::arg("source"), nb::arg("read"))
      .def("pickled",
           [](const Robot& robot) {
             const std::string bytes = pickled(robot.source());
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def_prop_ro("name", [](const Robot& r) { return r.model().name; })
      .def_prop_ro("formulation", [](const Robot& r) { return formulation_name(r.model().formulation); })
      .def_prop_ro("fingerprint", [](const Robot& r) { return fingerprint_of(r.model()); })
      .def_prop_ro("diagonal_mm", [](const Robot& r) { return r.model().diagonal_mm; })
      .def_prop_ro("robot_vertices", [](const Robot& r) { return r.model().robot_vertices(); })
      .def_prop_ro("notes", [](const Robot& r) { return r.model().notes; })
      .def_prop_ro("warnings", [](const Robot& r) { return r.model().warnings; })
      .def_prop_ro("materials", [](const Robot& r) { return materials_of(r.model()); })
      .def_prop_ro("region_names", [](const Robot& r) { return r.model().elements.region_names; })
      .def_prop_ro("actuators", [](const Robot& r) { return r.model().actuators; })
      .def_prop_ro("markers",
                   [](const Robot& r) {
                     std::vector<std::string> names;
                     for (const Marker& marker : r.model().markers) names.push_back(marker.name);
                     return names;
                   })
      .def_prop_ro("supports",
                   [](const Robot& r) {
                     std::vector<std::string> names;
                     for (const Support& support : r.model().held.supports) names.push_back(support.name);
                     return names;
                   })
      .def_prop_ro(
          "rest", [](nb::pointer_and_handle<Robot> self) { return view_of(self.p->model().rest, self.h); },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "tetrahedra", [](const Robot& r) { return cells_out(r.model().elements.tetrahedra); },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "edge_nodes", [](const Robot& r) { return cells_out(r.model().elements.edge_nodes); },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "prisms", [](const Robot& r) { return cells_out(r.model().elements.prisms); }, nb::rv_policy::automatic)
      .def_prop_ro(
          "surface", [](const Robot& r) { return cells_out(runs::body_surface(r.model()).triangles); },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "element_regions",
          [](const Robot& r) {
            const auto values = roles_of(r.model(), [](const ElementRole& role) { return role.region; });
            return list_of(values.data(), values.size());
          },
          nb::rv_policy::automatic)
      .def_prop_ro(
          "element_materials",
          [](const Robot& r) {
            const auto values = roles_of(r.model(), [](const ElementRole& role) { return role.material; });
            return list_of(values.data(), values.size());
          },
          nb::rv_policy::automatic)
      .def("rest_actuation", [](const Robot& r) { return vector_out(r.model().rest_actuation()); })
      .def(
          "parsed",
          [](const Robot& r, const std::string& option, const std::string& actuator, const std::string& text) {
            const auto values = read_settings(r.model(), option, {actuator + "=" + text});
            return *values[r.actuator(actuator)];
          },
          nb::arg("option"), nb::arg("actuator"), nb::arg("text"), "A command with its unit as a number.")
      .def("marker", &Robot::marker, nb::arg("name"))
      .def("actuator", &Robot::actuator, nb::arg("name"));
  nb::class_<Session>(module, "Session", "Threads and factors that are kept from call to call.")
      .def(
          "__init__",
          [](Session* self, RobotPtr robot, MapPtr map, bool polish) {
            const nb::gil_scoped_release released;
            new (self) Session(std::move(robot), std::move(map), polish);
          },
          nb::arg("robot"), nb::arg("map").none() = nb::none(), nb::arg("polish") = false)
      .def("forget", [](const Session& session) { session.statics.forget(); });
}

}  // namespace softkin::python
