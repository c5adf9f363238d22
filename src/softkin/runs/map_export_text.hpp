#pragma once

#include <string_view>

/// Code of exported maps, which their tables come before. "map_" and "MAP_" stand for the robot's name.

namespace softkin::runs {

extern const char* const c_evaluation;  // outputs and Jacobian
extern const char* const c_slack;       // which cables hang slack
extern const char* const c_inverse;
extern const char* const c_estimate;  // of commands, from outputs; after c_inverse
extern const char* const c_check;

/// The code of maps that pages run: exported() of apps/view/web/src/exported_map.ts, in a variable softkinMap.
///
/// throws  InvalidInput where softkin was built without its page
[[nodiscard]] std::string_view js_script();

}  // namespace softkin::runs
