#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A bar of two materials, A up to the interface and B beyond, held at A's end and stretched at B's (Fang et al. 2020,
/// Fig. 7a).
struct StretchedSpecimen {
  double length_mm = 0;            // L, > 0
  double interface_mm = 0;         // L_1, from the fixed end, 0 < L_1 < L
  double stretch_mm = 0;           // Delta L, > 0
  double interface_moved_mm = 0;   // Delta L_1, 0 < Delta L_1 < Delta L
  std::optional<double> force_n;   // of the testing machine, > 0
  std::optional<double> area_mm2;  // of the cross-section at rest, > 0
  std::size_t line = 0;            // of the file; 0: not from a file
};

/// Such a bar, its free end turned about the axis of the bar (Fig. 7d).
struct TwistedSpecimen {
  double length_mm = 0, interface_mm = 0;  // as above
  double twist_deg = 0;                    // of the free end, 0 < twist
  std::optional<double> interface_deg;     // turn of the interface; none: not measured
  std::size_t line = 0;                    // of the file; 0: not from a file
};

/// A tensile test of one material: nominal strain [-], strictly ascending from 0 or more, and nominal stress [MPa].
struct TensileCurve {
  std::vector<double> strain, stress;  // as many, row by row
  std::vector<std::size_t> lines;      // of the file; empty: not from a file
  std::vector<std::string> notes{};    // what was taken of the file, a sentence each
};

/// The reference of the pressures of a syringe test: vacuum, or the atmosphere.
enum class PressureScale { absolute, gauge };

/// One row of a syringe test.
struct SyringeRow {
  double pressure_kPa = 0;  // as its run's scale has it
  double syringe_mm3 = 0;   // Delta V_sy: air pushed out of the syringe since the start
  std::size_t line = 0;     // of the file
};

/// One syringe test, rows in the order of time.
struct SyringeRun {
  std::string file, name;                         // name: "run 2"; for messages
  PressureScale scale = PressureScale::absolute;  // of the pressures of its rows
  std::vector<SyringeRow> rows;                   // in the order of time
};

/// One row of a test of a dielectric elastomer.
struct VoltageRow {
  double voltage_kV = 0;  // between the electrodes [kV]
  double area_ratio = 1;  // over any fixed area [-]
  std::size_t line = 0;   // of the file
};

/// One test of a dielectric elastomer, rows in the order of time.
struct VoltageRun {
  std::string file, name;        // name: "run 2"; for messages
  std::vector<VoltageRow> rows;  // in the order of time
};

/// One test of a strip under tension or compression along one axis over time, with free sides. Before its first row the
/// strip is at rest and relaxed.
struct RelaxationRun {
  std::string file, name;                           // name: "run 2"; for messages
  bool load_imposed = false;                        // creep: the stretch is measured; else the stress
  std::vector<double> time_s, stretch, stress_MPa;  // times ascend; length over that at rest > 0; nominal
  std::vector<std::size_t> lines;                   // of the file; empty: not from a file
};

/// The trajectory of one marker: measured, predicted, or computed elsewhere.
struct Track {
  std::string name;                            // for messages: its file
  std::vector<Vec3> points;                    // [mm]; 0 along axes that are not known
  std::array<bool, 3> axes{true, true, true};  // coordinates that are known
  std::vector<double> parameter;               // time [s], or another ascending quantity; empty: none
  bool robot_frame = false;                    // coordinates are those of the scene, as a prediction has them
  std::string marker{};                        // chosen of a file that has several; empty: not chosen
};

}  // namespace softkin
