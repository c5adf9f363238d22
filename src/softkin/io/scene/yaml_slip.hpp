#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace softkin::scene {

/// What is probably wrong with a text that is not YAML, and the line in which it begins (from 1).
struct YamlSlip {
  std::size_t line = 0;
  std::string what;
};

/// A bracket or a quote that is not closed, a bracket that closes another one or none, a line indented with a tab. For
/// messages: a text that is YAML may have what looks like one in a block of text.
[[nodiscard]] std::optional<YamlSlip> find_slip(const std::string& text);

}  // namespace softkin::scene
