#pragma once

#include <string>

namespace softkin {

/// Memory that a program can still take [bytes]: free memory and swap, within the limits of its process and control
/// group; infinite where the system does not report it.
[[nodiscard]] double free_memory_bytes();

/// "1.5 GiB", "320 MiB".
[[nodiscard]] std::string memory_text(double bytes);

}  // namespace softkin
