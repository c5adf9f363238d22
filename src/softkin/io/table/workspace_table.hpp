#pragma once

#include <filesystem>
#include <softkin/model/equilibrium.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softkin {

/// Names of the columns of a workspace, in the order of the file: sample, actuators, markers, loads, status,
/// reached, iterations. Names carry their units: air_kPa, tip_x_mm, tendon_tension_N.
struct WorkspaceColumns {
  std::vector<std::string> actuators;  // commands
  std::vector<std::string> markers;    // x, y, z of each
  std::vector<std::string> loads;      // multipliers
  std::vector<Index> loaded;           // per load, its actuator
};

/// What stands above the columns, "# key: value" lines.
using WorkspaceHead = std::vector<std::pair<std::string, std::string>>;

struct WorkspaceTable {
  WorkspaceHead head;
  std::vector<WorkspaceSample> samples;  // in the order of the file
  std::vector<std::string> rows;         // their lines as they stand in the file, with the end of the line
  std::size_t whole_bytes = 0;           // up to the last line that is whole
  bool torn = false;                     // a last line without its end follows
};

/// throws  InvalidInput on a name that a CSV file cannot hold, and on one that stands twice
[[nodiscard]] std::string workspace_header(const WorkspaceHead& head, const WorkspaceColumns& columns);

/// A line of the file, its end included. Numbers are the shortest texts that read back as they were. Without
/// markers their cells, those of loads and that of reached are empty.
[[nodiscard]] std::string workspace_row(const WorkspaceSample& sample, const WorkspaceColumns& columns);

/// The sample of a line of workspace_row, with its end or without.
///
/// source  what names the row in errors, such as a file or a process
/// throws  InvalidInput naming source and column where the line is not a row of these columns
[[nodiscard]] WorkspaceSample read_workspace_row(std::string_view row, const WorkspaceColumns& columns,
                                                 const std::string& source);

/// "converged", "not_converged" or "limit".
[[nodiscard]] const char* workspace_status(Status status);

/// throws  InvalidInput naming file and line: another header than that of the columns, a line that is not a row, a
///         sample that stands twice
[[nodiscard]] WorkspaceTable read_workspace(const std::filesystem::path& path, const WorkspaceColumns& columns);

}  // namespace softkin
