#pragma once

namespace softkin::drive {

/// Any rate that the driver takes, such as the 250000 baud of many boards. False where it does not.
[[nodiscard]] bool set_baud(int file, int baud);

}  // namespace softkin::drive
