#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <softkin/core/error.hpp>
#include <softkin/io/examples.hpp>

#include "bindings.hpp"

namespace softkin::python {

namespace nb = nanobind;

void bind_examples(nb::module_& module) {
  module.def(
      "example_scene",
      [](const std::string& beside, const std::string& name) {
        const std::filesystem::path folder = examples_above(std::filesystem::weakly_canonical(beside));
        const Example example = find_example(folder, name);
        if (example.scene.empty()) throw InvalidInput("examples: " + example.name + " has no scene");
        return (folder / example.scene).string();
      },
      nb::arg("beside"), nb::arg("name"));
}

}  // namespace softkin::python
