#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <softkin/calibration/path_comparison.hpp>
#include <softkin/calibration/path_tracks.hpp>
#include <softkin/io/file.hpp>
#include <softkin/runs/report_comparison.hpp>

#include "bindings.hpp"
#include "convert.hpp"

namespace softkin::python {

using calibration::PathReport;
using runs::ReportComparison;

void bind_compare(nb::module_& module) {
  nb::class_<ReportComparison>(module, "ReportComparison", "Reports of the same steps side by side.")
      .def_ro("marker", &ReportComparison::marker)
      .def_ro("distances", &ReportComparison::distances)
      .def_ro("turns", &ReportComparison::turns)
      .def("steps", &ReportComparison::steps)
      .def("times", &ReportComparison::times)
      .def("json", &ReportComparison::json)
      .def(
          "save_plot",
          [](const ReportComparison& comparison, const std::string& path) { write_svg(path, comparison.plot()); },
          nb::arg("path"));
  nb::class_<PathReport>(module, "PathReport", "Paths of markers beside a reference.")
      .def("heads", &PathReport::heads)
      .def("waypoints", &PathReport::waypoints)
      .def("summary", &PathReport::summary)
      .def("errors", &PathReport::errors)
      .def("json", &PathReport::json)
      .def(
          "save_plot", [](const PathReport& report, const std::string& path) { write_svg(path, report.plot()); },
          nb::arg("path"));
  module.def("compare_reports", &runs::compare_reports, nb::arg("files"), nb::arg("marker"), nb::arg("turn"),
             nb::arg("poses"), nb::call_guard<nb::gil_scoped_release>());
  module.def(
      "compare_paths",
      [](const std::vector<std::string>& files, const std::vector<std::string>& sum, const std::string& marker,
         const std::string& by, const std::string& plane, std::optional<double> start_s, bool align) {
        calibration::PathRequest request{files, sum, marker, by, {}, start_s};
        if (!plane.empty()) request.plane = calibration::parse_plane(plane);
        return calibration::path_report(calibration::read_tracks(request), by, align);
      },
      nb::arg("files"), nb::arg("sum"), nb::arg("marker"), nb::arg("by"), nb::arg("plane"), nb::arg("start_s").none(),
      nb::arg("align"), nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace softkin::python
