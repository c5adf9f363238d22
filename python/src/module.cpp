#include <filesystem>
#include <softkin/core/error.hpp>
#include <softkin/core/target.hpp>
#include <softkin/core/version.hpp>

#include "bindings.hpp"
#include "watch.hpp"

namespace nb = nanobind;

NB_MODULE(_core, module) {
  using namespace softkin;
  // objects that other libraries still hold when Python ends, such as a plot's, are nothing that a user can mend
  nb::set_leak_warnings(false);
  module.doc() = "What softkin does in C++; the public interface is the package softkin.";
  module.attr("version") = version();
  module.attr("instruction_set") = name_of(target());
  nb::list others;
  for (const Target each : targets_here()) others.append(name_of(each));
  module.attr("instruction_sets_here") = nb::tuple(others);
  nb::exception<InvalidInput>(module, "InvalidInput", PyExc_ValueError).doc() =
      "Input that softkin refuses: one sentence that begins with where it stands.";
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        try {
          std::rethrow_exception(thrown);
        } catch (const std::filesystem::filesystem_error& error) {
          throw InvalidInput({error.path1().string()}, error.code().message());
        }
      },
      nullptr);
  nb::module_::import_("atexit").attr("register")(nb::cpp_function([] {
    const nb::gil_scoped_release released;
    python::Abandoned::join();
  }));
  python::bind_source(module);
  python::bind_robot(module);
  python::bind_shape(module);
  python::bind_solve(module);
  python::bind_sensitivity(module);
  python::bind_inverse(module);
  python::bind_examples(module);
  python::bind_mesh_files(module);
  python::bind_runs(module);
  python::bind_grasp(module);
  python::bind_estimate(module);
  python::bind_workspace(module);
  python::bind_map(module);
  python::bind_page(module);
  python::bind_compare(module);
  python::bind_calibrate(module);
  python::bind_calibrate_robot(module);
  python::bind_drive(module);
}
