#pragma once

#include <softkin/model/model.hpp>
#include <string>

namespace softkin::runs {

/// "1,851 vertices, 5,556 tetrahedra of order 1; physical formulation (neo-hookean), solver newton", the actuators,
/// the model's warnings and its notes, a line each. solver: empty: none is used
[[nodiscard]] std::string model_summary(const Model& model, const std::string& solver);

}  // namespace softkin::runs
