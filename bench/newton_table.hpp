#pragma once

#include <string>
#include <vector>

#include "newton_runs.hpp"

namespace softkin::bench {

enum class Solution { local_global, anderson, newton, physical, calculix, physical_quadratic, calculix_quadratic };

[[nodiscard]] const std::vector<std::string>& solution_names();
/// throws  InvalidInput on an unknown name
[[nodiscard]] Solution solution_of(const std::string& name);
[[nodiscard]] FingerKind kind_of(Solution solution);
[[nodiscard]] bool is_calculix(Solution solution);

struct NewtonOptions {
  std::vector<double> sizes{5000, 15000, 45000, 200000};  // body tetrahedra
  std::string mesh;                                       // a file in place of the sizes
  std::vector<double> bends{90, 180, 240};                // [degrees]
  std::vector<std::string> solvers;
  std::vector<int> calculix_threads{1, 2};
  int repeat = 3;
  double quadratic_up_to = 8000;  // body tetrahedra
  double chamber_weight = 0.05;
  std::string folder;  // where CalculiX works; "": a temporary one
  RunOptions run;
};

/// One line of the table.
struct Row {
  Solution solution = Solution::newton;
  int threads = 0;  // CalculiX
  int body_tetrahedra = 0, vertices = 0;
  double bend = 0;
  Run run;  // times: medians
  int runs = 0;
  double peak_mib = 0;
  std::string remark;
};

/// Measures every solver at every size and bend and prints the rows as they come.
[[nodiscard]] std::vector<Row> measure_table(const NewtonOptions& options);

/// Prints times in the manner of the paper's Table III, the ratios between solvers and the growth of time per
/// iteration.
void print_summary(const std::vector<Row>& rows, const NewtonOptions& options);

}  // namespace softkin::bench
