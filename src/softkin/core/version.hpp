#pragma once

namespace softkin {

/// Of the library that is linked, "1.2.3".
[[nodiscard]] const char* version();

}  // namespace softkin
