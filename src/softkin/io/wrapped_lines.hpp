#pragma once

#include <functional>
#include <string>
#include <vector>

namespace softkin {

/// Breaks a text into lines that fit, at spaces where it can be. The last of max_lines >= 1 holds all that is left,
/// whether it fits or not.
[[nodiscard]] std::vector<std::string> wrapped_lines(const std::string& text, std::size_t max_lines,
                                                     const std::function<bool(const std::string& line)>& fits);

}  // namespace softkin
