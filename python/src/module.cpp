#include <softkin/core/error.hpp>
#include <softkin/core/version.hpp>

#include "arguments.hpp"
#include "bindings.hpp"
#include "watch.hpp"

namespace nb = nanobind;

namespace {

/// Raises type, in the words of Python's arguments.
void translate(const std::exception_ptr& raised, void* type) {
  try {
    std::rethrow_exception(raised);
  } catch (const softkin::InvalidInput& error) {
    PyErr_SetString(static_cast<PyObject*>(type), softkin::python::with_arguments(error.what()).c_str());
  }
}

}  // namespace

NB_MODULE(_core, module) {
  using namespace softkin;
  module.doc() = "What softkin does in C++; the public interface is the package softkin.";
  module.attr("version") = version();
  const nb::exception<InvalidInput> invalid(module, "InvalidInput", PyExc_ValueError);
  invalid.doc() = "Input that softkin refuses: one sentence that begins with where it stands.";
  nb::register_exception_translator(translate, invalid.ptr());
  nb::module_::import_("atexit").attr("register")(nb::cpp_function([] {
    const nb::gil_scoped_release released;
    python::Abandoned::join();
  }));
  python::bind_source(module);
  python::bind_robot(module);
  python::bind_shape(module);
  python::bind_solve(module);
  python::bind_inverse(module);
  python::bind_mesh_files(module);
  python::bind_runs(module);
  python::bind_workspace(module);
  python::bind_compare(module);
  python::bind_calibrate(module);
  python::bind_drive(module);
}
