#pragma once

#include <string>

namespace softkin::python {

/// A message in which options of the command, such as --x-axis, have the names of Python's arguments: x_axis.
[[nodiscard]] std::string with_arguments(const std::string& message);

}  // namespace softkin::python
