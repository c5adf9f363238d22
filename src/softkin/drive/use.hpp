#pragma once

#include <softkin/drive/plan.hpp>
#include <vector>

namespace softkin::drive {

/// The ranges and speeds that a plan requires of a motor, backlash included.
struct MotorUse {
  double fastest_mm_per_s = 0;           // of cable or plunger
  std::int64_t lowest = 0, highest = 0;  // steps from home
  std::optional<double> turns;           // of drum or screw from home, at the end farther from it; none: neither
};

struct TendonUse : MotorUse {
  double shortest_mm = 0, longest_mm = 0;  // cable
};
[[nodiscard]] TendonUse use_of(const Plan& plan, std::size_t tendon);

/// A chamber on a syringe after a row: the request, and the result of the steps that are sent.
struct PlungerRow {
  std::size_t line = 0;  // of the commands
  std::optional<double> time_s;
  double ratio = 0, gauge_kpa = 0;  // requested; where the pushed volume is commanded, it [mL], and no pressure
  double plunger_mm = 0;            // from home, in whole steps, as the backlash leaves it
  double volume_mm3 = 0;            // pushed out of the syringe
  double reached = 0;               // ratio by Eq. (19) under the requested pressure; or pushed [mL]
};

/// A row each of the commands: a simulated run of the program that is sent. Moves too small for a board wait for the
/// rows that follow, and the plunger then stands where it was.
[[nodiscard]] std::vector<PlungerRow> plunger_rows(const Plan& plan, std::size_t syringe);

struct SyringeUse : MotorUse {
  double lowest_ratio = 0, highest_ratio = 0, lowest_kpa = 0, highest_kpa = 0;  // requested; as of PlungerRow
  double lowest_mm = 0, highest_mm = 0;                                         // plunger
  double error = 0;  // of the ratios reached, the largest [-]; or of what is pushed [mL]
};
[[nodiscard]] SyringeUse use_of_syringe(const Plan& plan, std::size_t syringe);

[[nodiscard]] double seconds_of(const std::vector<Move>& moves);

}  // namespace softkin::drive
