#pragma once

/// Code of exported maps, which their tables come before. "map_" and "MAP_" stand for the robot's name.

namespace softkin::runs {

extern const char* const c_evaluation;  // outputs and Jacobian
extern const char* const c_slack;       // which cables hang slack
extern const char* const c_inverse;
extern const char* const c_check;

extern const char* const js_evaluation;
extern const char* const js_shape;
extern const char* const js_inverse;
extern const char* const js_check;
extern const char* const js_types;

}  // namespace softkin::runs
