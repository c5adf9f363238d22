#pragma once

#include <softkin/io/table/commands.hpp>
#include <string>
#include <vector>

namespace softkin::python {

/// Steps that a run goes through, of an array or a file, and what they are called.
struct NamedSteps {
  std::vector<ActuationStep> steps;
  std::string name;
};

}  // namespace softkin::python
