#pragma once

#include <nanobind/nanobind.h>

#include <softkin/io/table/table.hpp>

namespace softkin::python {

// A part of the module each.
void bind_source(nanobind::module_& module);
void bind_robot(nanobind::module_& module);
void bind_shape(nanobind::module_& module);
void bind_solve(nanobind::module_& module);
void bind_sensitivity(nanobind::module_& module);
void bind_inverse(nanobind::module_& module);
void bind_examples(nanobind::module_& module);
void bind_mesh_files(nanobind::module_& module);
void bind_runs(nanobind::module_& module);
void bind_grasp(nanobind::module_& module);
void bind_estimate(nanobind::module_& module);
void bind_workspace(nanobind::module_& module);
void bind_map(nanobind::module_& module);
void bind_page(nanobind::module_& module);
void bind_compare(nanobind::module_& module);
void bind_calibrate(nanobind::module_& module);
void bind_calibrate_robot(nanobind::module_& module);
void bind_drive(nanobind::module_& module);

}  // namespace softkin::python
