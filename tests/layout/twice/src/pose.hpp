#pragma once

/// Read by tests/layout/test_types.cpp, built by nothing.

namespace softkin {

struct Pose {
  double x;
};

namespace inner {

enum class Kind { cable, dea };

}  // namespace inner

/// The first program has a Row, too.
class Row {};

/// The second program's has another namespace.
class Column {};

}  // namespace softkin
