#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace softkin {

/// What the pressures of a syringe test are above: vacuum, or the air around.
enum class PressureScale { absolute, gauge };

struct SyringeRow {
  double pressure_kPa = 0;  // as its run's scale has it
  double syringe_mm3 = 0;   // Delta V_sy: air pushed out of the syringe since the start
  std::size_t line = 0;     // of the file
};

/// One syringe test, rows in the order of time.
struct SyringeRun {
  std::string file, name;  // name: "run 2"; for messages
  PressureScale scale = PressureScale::absolute;
  std::vector<SyringeRow> rows;
};

}  // namespace softkin
