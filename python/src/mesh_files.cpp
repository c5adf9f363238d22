#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <softkin/core/memory.hpp>
#include <softkin/io/mesh/mesh_report.hpp>
#include <tuple>

#include "bindings.hpp"

namespace softkin::python {

namespace nb = nanobind;

void bind_mesh_files(nb::module_& module) {
  module.def("free_memory_bytes", &free_memory_bytes);
  module.def("memory_text", &memory_text, nb::arg("bytes"));
  module.def(
      "mesh_info", [](const std::string& file, const std::string& unit) { return to_json(mesh_info(file, unit)); },
      nb::arg("file"), nb::arg("unit"), nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "mesh_check",
      [](const std::string& file, const std::string& unit) {
        const MeshVerdict verdict = mesh_verdict(file, unit);
        return std::tuple(to_json(verdict), verdict.usable());
      },
      nb::arg("file"), nb::arg("unit"), nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "mesh_convert",
      [](const std::string& file, const std::string& output, bool ascii) {
        return to_json(convert_mesh(file, output, ascii));
      },
      nb::arg("file"), nb::arg("output"), nb::arg("ascii"), nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace softkin::python
