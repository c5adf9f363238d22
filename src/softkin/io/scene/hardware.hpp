#pragma once

#include <filesystem>
#include <softkin/model/hardware_spec.hpp>

namespace softkin {

/// Reads a hardware file (YAML, docs/drive.md).
/// throws  InvalidInput naming file and line; unknown keys are errors with the nearest valid name
[[nodiscard]] HardwareSpec read_hardware(const std::filesystem::path& path);

}  // namespace softkin
