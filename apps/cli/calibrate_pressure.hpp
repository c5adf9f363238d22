#pragma once

#include <filesystem>
#include <optional>
#include <softkin/calibration/syringe.hpp>
#include <string>
#include <vector>

#include <softkin/io/output_files.hpp>

namespace softkin::cli {

/// What the user asks of `softkin calibrate pressure`. An empty text: not given.
struct PressureOptions {
  std::vector<std::string> tests;
  std::string scale;  // absolute or gauge
  std::string scene, actuator;
  std::string chamber, tube, syringe;  // volumes with their unit
  std::optional<double> atmosphere_kPa;
  std::string output, table, plot;
  bool predict = false, json = false;
  int threads = 0;

  [[nodiscard]] std::vector<Output> outputs() const;
};

/// "12.5mL", "800 mm3" or "60cm3" in mm^3. Throws InvalidInput, naming the option, on anything else.
[[nodiscard]] double volume_of(const char* option, const std::string& text);

[[nodiscard]] int calibrate_pressure(const PressureOptions& options);

}  // namespace softkin::cli
