#pragma once

#include <softkin/statics/solver_option_groups.hpp>
#include <string>
#include <vector>

namespace softkin {

/// All tuned constants of the solvers. A file of --options sets them, and docs/path_tracking.md lists them.
struct SolverOptions {
  PathOptions path{};                 // of path tracking
  NewtonOptions newton{};             // of Newton's method and of its factors
  ContactOptions contact{};           // of contact continuation and friction updates
  WrinklingOptions wrinkling{};       // of sheets that wrinkle or begin flat
  TargetShapeOptions target_shape{};  // of the target-shape formulation

  /// Have all options the same values?
  friend bool operator==(const SolverOptions&, const SolverOptions&) = default;
};

/// How the default of an option was found: it follows from a textbook or an estimate of rounding; it was measured, and
/// decides how fast a path is or which one is found; or it was chosen for its order of magnitude.
enum class OptionKind { derived, measured, order_of_magnitude };
/// Admissible values: 0 < x < 1, 0 < x <= 1, x > 1, x > 0, a whole number of at least 1, any finite number.
enum class OptionRange { reduction, fraction, growth, positive, count, any };

/// The description of an option.
struct OptionField {
  const char* name;      // its name in a file of --options
  const char* unit;      // "-": a ratio; "path": a fraction of the path; "diagonal": over that of the robot; ...
  OptionRange range;     // the values that it may have
  OptionKind kind;       // how its default was found
  const char* sentence;  // what it decides
};

/// The value of an option, with its group and its default.
struct OptionValue {
  std::string group;    // its name in a file of --options
  OptionField field{};  // its description
  double value = 0;     // whole where the range is a count
  double standard = 0;  // its default
};

/// Returns all options in the order of their groups.
[[nodiscard]] std::vector<OptionValue> list_options(const SolverOptions& options = {});
/// Returns the options that differ from their defaults.
[[nodiscard]] std::vector<OptionValue> changed_options(const SolverOptions& options);
/// Returns the changed options as text, "step.max_turn = 20, ..."; "" where there are none.
[[nodiscard]] std::string changes_text(const SolverOptions& options);

/// Sets an option.
///
/// throws  InvalidInput on an unknown group or name, with the nearest one, and on a value that is not admissible
void set_option(SolverOptions& options, const std::string& group, const std::string& name, double value);
/// Throws InvalidInput where a value is not admissible.
void check_options(const SolverOptions& options);
/// Throws InvalidInput where a group is unknown, with the nearest one.
void check_option_group(const std::string& group);

/// Returns the tables of docs/path_tracking.md: Markdown, one for each group.
[[nodiscard]] std::string option_tables();

}  // namespace softkin
