#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace softkin {

struct VoltageRow {
  double voltage_kV = 0;
  double area_ratio = 1;  // over any fixed area [-]
  std::size_t line = 0;   // of the file
};

/// One test of a dielectric elastomer, rows in the order of time.
struct VoltageRun {
  std::string file, name;  // name: "run 2"; for messages
  std::vector<VoltageRow> rows;
};

}  // namespace softkin
