#include "method_options.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <softkin/core/error.hpp>

#include "solve_options.hpp"

namespace softkin::cli {

namespace {

constexpr double tolerance_of_gradient_mm = 0.2;  // the paper's lambda

}  // namespace

InverseOptions MethodOptions::by_method() const {
  InverseOptions result;
  if (method == "gradient") {
    result.method = InverseMethod::gradient;
    result.tolerance_mm = tolerance_of_gradient_mm;
  }
  result.tolerance_mm = tolerance_asked_mm.value_or(result.tolerance_mm);
  result.max_iterations = descents.value_or(result.max_iterations);
  return result;
}

void add_method(CLI::App& command, MethodOptions& options, const std::string& tolerance) {
  command
      .add_option("--method", options.method,
                  "newton (default), or gradient: Algorithm 2 of Fang et al. 2020\nwith central differences")
      ->type_name("NAME")
      ->check(one_of({"newton", "gradient"}));
  command.add_option("--tolerance", options.tolerance_asked_mm, tolerance + " [mm] (default:\n0.001; gradient: 0.2)")
      ->type_name("MM")
      ->check(positive_length());
}

void check_method(const MethodOptions& options) {
  if (options.descents && options.method != "gradient")
    throw InvalidInput("--descents are iterations of Algorithm 2: it needs --method gradient");
}

}  // namespace softkin::cli
